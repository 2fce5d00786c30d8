// The viewer with two recordings in a real browser: what it says of them is what was compared. Arguments: browser.mjs.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { before, test } from "node:test";
import { atTick, complaints, details, file, kPatience, message, open, openNew, page, program, scanned, scene, serve, shot, workerWatch } from "./browser.mjs";
import { capture } from "./headset.mjs";

const examples = dirname(scene);
const run = (given, name, ...args) => execFileSync(program, ["run", given, "--record", file(name), ...args]);
/** Where lumbrical diff says that they part. */
const parting = (...names) => {
  try {
    execFileSync(program, ["diff", "--json", ...names.map(file)]);
  } catch (error) {
    return JSON.parse(error.stdout).first_divergence;
  }
};
/** Opens two recordings and waits until what comparing them has found is told. */
const both = async (...names) => {
  await open(await serve("view", ...names.map(file), "--no-browser"));
  await page.waitForFunction(() => /compared\s+(?!not yet|\s)/.test(document.querySelector("#details").innerText), null, kPatience);
};

before(() => {
  run(scene, "first.mcap");
  execFileSync(program, ["replay", file("first.mcap"), "--stiffness", "1.9e7", "--record", file("second.mcap")]);
});

/** The recording as if other arithmetic had made it. */
function asOfOtherArithmetic(name) {
  const bytes = readFileSync(file(name));
  const [, here] = /arithmetic (\S+)/.exec(execFileSync(program, ["--version"]));
  bytes.write("0badbeef", bytes.indexOf(here));
  return { bytes, here };
}

test("Where a recording of other arithmetic parts, it is said that the same bits are not promised", async () => {
  const { bytes, here } = asOfOtherArithmetic("second.mcap");
  writeFileSync(file("elsewhere.mcap"), bytes);
  const why = (where) => `. Recorded by other arithmetic (0badbeef, ${where} ${here}): the same bits are not promised.`;
  await both("first.mcap", "elsewhere.mcap");
  const { tick, stage, field } = parting("first.mcap", "second.mcap");
  await atTick(tick);
  const compared = await details();
  assert.ok(compared.includes(`They part at tick ${tick}, stage "${stage}", ${field}`) && compared.includes(why("the first")), compared);

  // Its session tells of another stiffness than its ticks are of. An attachment ends with its check sum, 0 for none.
  const [name, stiffness] = [Buffer.from("\x07\0\0\0session"), Buffer.alloc(8)];
  stiffness.writeDoubleLE(1.9e7);
  const start = bytes.indexOf(name) - 16;
  const end = start + Number(bytes.readBigUInt64LE(start - 8)) - 4;
  bytes.writeDoubleLE(2e7, bytes.indexOf(stiffness, start));
  bytes.writeUInt32LE(0, end);
  writeFileSync(file("elsewhere.mcap"), bytes);
  await open(`${await serve("view", file("elsewhere.mcap"), "--no-browser")}&tick=${tick}`);
  await atTick(tick);
  const replayed = await details();
  assert.ok(/replayed here\s+parts from the file/.test(replayed) && replayed.includes(why("here")), replayed);
  bytes.write(here, bytes.indexOf("0badbeef"));
  writeFileSync(file("elsewhere.mcap"), bytes);
  await open(`${await serve("view", file("elsewhere.mcap"), "--no-browser")}&tick=${tick}`);
  await atTick(tick);
  assert.match(await details(), /replayed here\s+parts from the file/);
  assert.doesNotMatch(await details(), /arithmetic/);
});

/** [kPa] Side by side, what both recordings tell of one segment that touches something. */
async function pressures() {
  const box = await page.locator("#canvas").boundingBox();
  const told = async (x, y) => {
    await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
    await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    return /highest pressure\s+([1-9]\S*) kPa/.exec(await details())?.[1];
  };
  for (let y = 0.35; y < 0.75; y += 0.05)
    for (let x = 0.1; x < 0.4; x += 0.03) {
      const left = await told(x, y);
      if (left) return [left, await told(0.5 + x, y)];
    }
  assert.fail("no segment touches anything");
}

test("Two recordings part where lumbrical diff says", async () => {
  await both("first.mcap", "second.mcap");
  const told = parting("first.mcap", "second.mcap");
  await atTick(told.tick);
  const text = await details();
  assert.ok(text.includes(`They part at tick ${told.tick}, stage "${told.stage}", ${told.field}: `), text);
  await scanned();
  await page.keyboard.press("c");
  const box = await page.locator("#timeline").boundingBox();
  await page.mouse.click(box.x + 0.4 * box.width, box.y + 30);
  await page.waitForFunction(() => Math.abs(Number(document.body.dataset.tick) - 4000) < 30, null, kPatience);
  assert.ok(await page.getByText("Difference of force per segment").isVisible());
  await shot("compared");
  const [left, right] = await pressures();
  assert.ok(Math.abs(right / left - 1.9e7 / 2e7) < 0.01, `each by its own stiffness: ${left} and ${right} kPa`);
  await page.keyboard.press("c");
  await page.waitForTimeout(300);
  await shot("overlaid");
});

/** How far down the pointer finds an object in one half of the scene, whose height is 1. */
async function bottomOf(object, half) {
  const box = await page.locator("#canvas").boundingBox();
  for (let y = 0.8; y > 0; y -= 0.04)
    for (let x = 0.15; x < 0.35; x += 0.04) {
      await page.mouse.move(box.x + (x + half / 2) * box.width, box.y + y * box.height);
      const tip = await page.locator("#tip").evaluate((tip) => (tip.hidden ? "" : tip.innerText));
      if (tip.startsWith(`${object}: `)) return y;
    }
  assert.fail(`no ${object} in half ${half}`);
}

test("Side by side each recording has its objects where they are in it", async () => {
  run(join(examples, "mug.json"), "lifted.mcap", "--ticks", "6501");
  execFileSync(program, ["replay", file("lifted.mcap"), "--stiffness", "5e5", "--record", file("left standing.mcap")]);
  await open(`${await serve("view", file("lifted.mcap"), file("left standing.mcap"), "--no-browser")}&tick=6500`);
  await atTick(6500);
  await page.keyboard.press("c");
  await page.waitForTimeout(300);
  await shot("lifted beside");
  const [left, right] = [await bottomOf("mug", 0), await bottomOf("mug", 1)];
  assert.ok(left < right - 0.1, `${left} and ${right}`);
});

test("Of a second recording in other objects it is said that these are not drawn", async () => {
  await open(`${await serve("view", file("first.mcap"), file("lifted.mcap"), "--no-browser")}&tick=4500`);
  await atTick(4500);
  assert.match(await details(), /the second\s+has other objects/);
  await page.keyboard.press("c");
  await page.waitForTimeout(300);
  await shot("other objects");
});

test("Where only one goes on, or begins, they part as lumbrical diff says", async () => {
  const cut = (name, from, to) => execFileSync(program, ["trim", file("first.mcap"), "--from-tick", `${from}`, "--to-tick", `${to}`, "-o", file(name)]);
  cut("begun.mcap", 0, 300);
  cut("shorter.mcap", 0, 200);
  cut("begun later.mcap", 50, 300);
  for (const other of ["shorter.mcap", "begun later.mcap"]) {
    await both("begun.mcap", other);
    const told = parting("begun.mcap", other);
    assert.match(await details(), new RegExp(`They part at tick ${told.tick}, stage "input", tick`), other);
  }
  await both("shorter.mcap", "begun.mcap");  // what only the second has is reached
  await page.keyboard.press("End");
  await atTick(299);
  assert.match(await details(), /recording\s+begun\.mcap: the first has no such tick/);
  await page.keyboard.press("]");
  assert.equal(await message(), "No further mark.");
});

test("Nothing is said to be the same before all of it was compared", async () => {
  copyFileSync(file("first.mcap"), file("copy.mcap"));
  await openNew(await serve("view", file("first.mcap"), "--no-browser"), {}, workerWatch);
  await page.evaluate(() => { heldBack = "compare"; });
  await page.setInputFiles("#open-other", file("copy.mcap"));
  await page.waitForFunction(() => /compared\s+not yet/.test(document.querySelector("#details").innerText), null, kPatience);
  await page.evaluate(() => letThrough());
  await page.waitForFunction(() => /compared\s+the same to the last bit in all 10000 ticks$/im.test(document.querySelector("#details").innerText), null, kPatience);
});

test("Where a file is damaged the comparison says that it did not come to the end", async () => {
  const damaged = readFileSync(file("first.mcap"));
  damaged.fill(0x55, damaged.length >> 1, (damaged.length >> 1) + 2000);
  writeFileSync(file("damaged.mcap"), damaged);
  await both("first.mcap", "damaged.mcap");
  assert.match(await details(), /compared\s+not to the end: damaged\.mcap: the chunk at byte \d+ is damaged/);
});

test("Of recordings of two hands both hands are compared", async () => {
  copyFileSync(join(examples, "cup.obj"), file("cup.obj"));
  copyFileSync(join(examples, "two_hands.json"), file("both.json"));
  const hold = JSON.parse(readFileSync(join(examples, "hold.json"), "utf8"));
  writeFileSync(file("hold.json"), JSON.stringify(hold));
  run(file("both.json"), "both.mcap");
  copyFileSync(file("both.mcap"), file("both again.mcap"));
  const [, ...frames] = hold.frames;
  const left = frames[0][1].find(([, side]) => side === "left")[0];
  for (const [, , fingers] of frames.slice(frames.length >> 1))
    for (const [hand, , ...joints] of fingers) if (hand === left) for (const joint of joints) joint[0] += 0.5;
  writeFileSync(file("hold.json"), JSON.stringify(hold));
  run(file("both.json"), "left otherwise.mcap");

  await both("both.mcap", "both again.mcap");
  assert.match(await details(), /compared\s+the same to the last bit in all \d+ ticks of the right and the left hand$/im);
  await both("both.mcap", "left otherwise.mcap");
  const told = parting("both.mcap", "left otherwise.mcap");
  assert.equal(told.side, "left");
  assert.match(await details(), new RegExp(`They part at tick ${told.tick} of the left hand, stage "${told.stage}"`));
  await both("first.mcap", "both.mcap");
  assert.match(await details(), /compared\s+not to the end: both\.mcap is of two hands and the other of one/);
});

/** Of every segment [N] at a tick. */
const forces = (name, tick) => JSON.parse(execFileSync(program, ["export", "--format", "json", "--ticks", `${tick}:${tick}`, file(name)])).output.segment.map(({ force }) => force);

test("The difference of force is that of the same ticks, however long the recordings are and wherever they begin", async () => {
  execFileSync(program, ["trim", file("second.mcap"), "--from-tick", "100", "--to-tick", "10000", "-o", file("later.mcap")]);
  await both("first.mcap", "later.mcap");
  await scanned();
  const plot = page.locator(".plot", { hasText: "Difference of force per segment" });
  await plot.waitFor({ ...kPatience, state: "visible" });
  const box = await plot.locator(".u-over").boundingBox();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 20);
  const [, segment, told] = /([a-z ]+) (\S+) N/.exec(await plot.locator(".values").innerText());
  const [a, b] = [forces("first.mcap", 4000), forces("later.mcap", 4000)];
  const differences = a.map((force, s) => Math.hypot(...force.map((value, axis) => value - b[s][axis])));
  const most = Math.max(...differences);
  assert.ok(Math.abs(told - most) < 0.1 * most, `${segment} ${told} N, not ${most}`);
  await shot("differences");
});

test("Marks of both recordings are drawn, whichever comes first", async () => {
  const slow = JSON.parse(readFileSync(scene, "utf8"));
  slow.settings.rate = 100;  // a tick is wider than a mark, and never late
  writeFileSync(file("slow.json"), JSON.stringify(slow));
  const lost = (name, ...stretches) => {
    const frames = JSON.parse(capture(3));
    for (const frame of frames) if (stretches.some((from) => frame.time > from && frame.time < from + 0.2)) frame.joints = null;
    writeFileSync(file(`${name}.json`), JSON.stringify(frames));
    run(file("slow.json"), `${name}.mcap`, "--motion", file(`${name}.json`), "--ticks", "290");
  };
  lost("lost late", 2.5);
  lost("lost early", 0.5, 1.2);
  await both("lost late.mcap", "lost early.mcap");
  const markAt = (tick) => page.waitForFunction((tick) => {
    const strip = document.querySelector("#timeline");
    const { data } = strip.getContext("2d").getImageData(Math.round((tick / 289) * strip.width) - 1, 20, 3, 1);
    return [0, 1, 2].some((i) => data[4 * i] - data[4 * i + 2] > 60);  // orange
  }, tick, kPatience);
  for (const tick of [121, 251]) await markAt(tick);
});

test("The page had nothing to complain of", () => {
  assert.deepEqual(complaints, []);
});
