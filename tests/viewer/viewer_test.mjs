// The viewer in a real browser: what a person does with a recording, and that nothing leaves the page's origin. Arguments: browser.mjs.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { join, dirname, resolve } from "node:path";
import { before, test } from "node:test";
import { atTick, complaints, details, file, kPatience, message, open, openNew, page, program, requests, scanned, scene, serve, settled, shot, started, tick, tips, workerWatch } from "./browser.mjs";
import { capture } from "./headset.mjs";

/** As a link says it. */
const at = (address, wanted) => `${address}&tick=${wanted}`;

before(async () => {
  const run = (name, ...args) => execFileSync(program, ["run", scene, "--record", file(name), ...args]);
  run("grasp.mcap", "--threads", "1");
  execFileSync(program, ["run", join(dirname(scene), "mug.json"), "--record", file("lift.mcap")]);
  run("tenths.mcap", "--threads", "1", "--record-forces", "10");
  run("hashes only.mcap", "--threads", "1", "--ticks", "4200", "--record-forces", "none");
  const whole = readFileSync(file("grasp.mcap"));
  writeFileSync(file("torn.mcap"), whole.subarray(0, whole.length >> 1));
  const damaged = Buffer.from(whole);
  damaged.fill(0x55, whole.length >> 1, (whole.length >> 1) + 2000);
  writeFileSync(file("damaged.mcap"), damaged);
});

let one;

test("A recording opens, and every tick replays in the page to the same bits", async () => {
  one = await serve("view", file("grasp.mcap"), "--no-browser");
  for (const wanted of [1700, 9999, 0]) {
    await open(at(one, wanted));
    await atTick(wanted);
    assert.match(await details(), /replayed here\s+the same bits/);
  }
  await open(at(one, 3980));
  await scanned();
  assert.match(await details(), /contacts\s+[1-9]\d+/);
  await shot("grasp");
});

test("Ticks whose forces the file leaves out are computed in the page", async () => {
  await open(at(await serve("view", file("hashes only.mcap"), "--no-browser"), 3980));
  await atTick(3980);
  assert.match(await details(), /forces\s+not in the file; computed here/);
  assert.match(await details(), /force of the hand\s+[1-9]/);
});

test("An object that moves is drawn where it is felt, and tells where that is when clicked", async () => {
  await open(await serve("view", file("lift.mcap"), "--no-browser"));
  await atTick(0);
  assert.ok(await clickUntil(/stands at/), "no pixel of the mug");
  assert.match(await details(), /object\s+mug\s+stands at\s+0, 0, 0 mm/);
  const line = await page.locator("#timeline").boundingBox();
  await page.mouse.click(line.x + 0.55 * line.width, line.y + 30);
  await page.waitForFunction(() => {
    const height = /stands at\s+\S+ \S+ (\S+) mm/.exec(document.querySelector("#details").innerText);
    return Number(height?.[1]) > 60;
  }, null, kPatience);
  assert.match(await details(), /force of the hand on it\s+[1-9]/);
  assert.match(await details(), /contacted triangles\s+[1-9]\d/);
  assert.match(await details(), /triangle\s+\d+\s+(touched by|contact\s+none)/);
  assert.match(await details(), /replayed here\s+the same bits/);
  await shot("lifted");
});

/** In what share of each tenth of the session the plot of forces has a line. */
async function linesIn(name) {
  await open(await serve("view", file(name), "--no-browser"));
  await scanned();
  return page.locator('.plot:has(h2:text-is("Force per segment [N]")) canvas').evaluate((canvas) => {
    const over = canvas.parentElement.querySelector(".u-over"), scale = canvas.width / canvas.clientWidth;
    const left = Math.round(scale * over.offsetLeft), width = Math.round(scale * over.clientWidth);
    const { data } = canvas.getContext("2d").getImageData(left, 0, width, canvas.height);
    const drawn = new Array(10).fill(0);
    for (let x = 0; x < width; ++x) {
      const isLine = (y) => { const [r, g, b, a] = data.slice(4 * (y * width + x)); return a > 100 && Math.max(r, g, b) - Math.min(r, g, b) > 40; };
      const rows = Array.from({ length: canvas.height }, (_, y) => y);
      drawn[Math.floor((10 * x) / width)] += rows.some(isLine) ? 10 / width : 0;
    }
    return drawn;
  });
}

test("Plots go on over ticks whose forces the file leaves out, and not over ticks that are missing", async () => {
  const held = (stretches) => stretches.slice(2, 8);
  const tenths = held(await linesIn("tenths.mcap"));
  const box = await page.locator('.plot:has(h2:text-is("Force per segment [N]")) .u-over').boundingBox();
  for (const share of [0.5, 0.501, 0.502]) {  // a line tells of its numbers wherever it is pointed at
    await page.mouse.move(box.x + share * box.width, box.y + 20);
    assert.match(await page.locator('.plot:has(h2:text-is("Force per segment [N]")) .values').innerText(), / N .* N/);
  }
  const damaged = held(await linesIn("damaged.mcap"));
  assert.ok(tenths.every((share) => share > 0.95), `${tenths}`);
  assert.ok(damaged.some((share) => share > 0.95) && damaged.some((share) => share < 0.9), `${damaged}`);
});

/** Whether the pointer finds such a thing about the middle of the scene. */
async function isInTheMiddle(thing) {
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  const box = await page.locator("#canvas").boundingBox();
  for (const x of [0.42, 0.5, 0.58])
    for (const y of [0.4, 0.5, 0.6]) {
      await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
      if (thing.test(await page.locator("#tip").evaluate((tip) => (tip.hidden ? "" : tip.innerText)))) return true;
    }
  return false;
}
const kHeld = /^(mug|thumb|index|middle|ring|little|palm)/;

test("The camera begins, and by its key comes back, before the hand and what it holds, wherever these are in a large world", async () => {
  const lift = JSON.parse(readFileSync(join(dirname(scene), "mug.json"), "utf8"));
  lift.objects.push({ name: "table", plane: { extent: 1.6, cells: 8 }, position: [0.7, 0, -0.001] });
  writeFileSync(file("large.json"), JSON.stringify(lift));
  execFileSync(program, ["run", file("large.json"), "--ticks", "5600", "--record", file("large.mcap")]);
  for (const [name, wanted] of [["lift", 5500], ["large", 2500]]) {
    const address = await serve("view", file(`${name}.mcap`), "--no-browser");
    await open(at(address, wanted));
    await atTick(wanted);
    assert.ok(await isInTheMiddle(kHeld), `${name}, tick ${wanted}`);
    if (name === "lift") continue;
    await open(`${at(address, wanted)}&camera=0.5,-0.9,0.5,0,0,0`);
    await atTick(wanted);
    assert.equal(await isInTheMiddle(kHeld), false, "a link's own camera");
    await page.keyboard.press("f");
    assert.ok(await isInTheMiddle(kHeld), `by the key, tick ${wanted}`);
  }
});

test("A world that is a file of its own is not drawn, but hand and forces are, where they were", async () => {
  execFileSync(program, ["world", scene, "-o", file("mug.world")]);
  const { objects, ...rest } = JSON.parse(readFileSync(scene, "utf8"));
  writeFileSync(file("of a world.json"), JSON.stringify({ ...rest, world: "mug.world" }));
  execFileSync(program, ["run", file("of a world.json"), "--ticks", "4200", "--record", file("of a world.mcap")]);
  await open(at(await serve("view", file("of a world.mcap"), "--no-browser"), 3980));
  await atTick(3980);
  const text = await details();
  assert.match(text, /contacts\s+the recording's world is a file of its own/);
  assert.match(text, /force of the hand\s+[1-9]/);
  assert.doesNotMatch(text, /replayed here|triangles/);
  await shot("world");
  const told = await tips();
  assert.ok(told.includes("palm") && told.some((tip) => /: \S+ N$/.test(tip)), `${told}`);
  execFileSync(program, ["run", file("of a world.json"), "--ticks", "300", "--record-forces", "none", "--record", file("unknown.mcap")]);
  await open(await serve("view", file("unknown.mcap"), "--no-browser"));
  await atTick(0);
  assert.match(await details(), /force of the hand\s+not known/);
});

test("Beside a world that is a file of its own an object that moves is drawn, and what touches it is told", async () => {
  const lift = JSON.parse(readFileSync(join(dirname(scene), "mug.json"), "utf8"));
  const { motion } = lift;
  const table = { name: "table", plane: { extent: 0.6, cells: 8 }, position: [0, 0, -0.001] };
  writeFileSync(file("table.json"), JSON.stringify({ objects: [table], motion }));
  execFileSync(program, ["world", file("table.json"), "-o", file("table.world")]);
  for (const [name, proxy_stiffness, known] of [["mug beside a world", 0, true], ["proxy beside a world", 1000, false]]) {
    writeFileSync(file(`${name}.json`), JSON.stringify({ ...lift, settings: { ...lift.settings, proxy_stiffness }, world: "table.world" }));
    execFileSync(program, ["run", file(`${name}.json`), "--ticks", "5600", "--record", file(`${name}.mcap`)]);
    await open(at(await serve("view", file(`${name}.mcap`), "--no-browser"), 5500));
    await atTick(5500);
    assert.match(await details(), /the recording's world is a file of its own/);
    if (known) assert.match(await details(), /contacts\s+[1-9]\d* triangles of objects that move/);
    else assert.doesNotMatch(await details(), /triangles/);
    assert.ok(await clickUntil(/object\s+mug/), "no pixel of the mug");
    assert.match(await details(), /force of the hand on it\s+[1-9]/);
    if (known) assert.match(await details(), /contacted triangles\s+[1-9]\d/);
    else assert.doesNotMatch(await details(), /contacted triangles/);
    await shot(name);
  }
});

test("A hand, or a finger, that is not tracked is not drawn", async () => {
  const frames = JSON.parse(capture(3));
  for (const frame of frames) {
    if (frame.time > 0.5 && frame.time < 1) frame.joints = null;
    if (frame.time > 1.5 && frame.time < 2) for (const name of Object.keys(frame.joints).filter((one) => /index/.test(one))) delete frame.joints[name];
  }
  writeFileSync(file("lost.json"), JSON.stringify(frames));
  execFileSync(program, ["run", scene, "--motion", file("lost.json"), "--align", "centre", "--ticks", "2500", "--record", file("lost.mcap")]);
  const address = await serve("view", file("lost.mcap"), "--no-browser");
  const isDrawn = { 400: ["index", "middle"], 700: [], 1700: ["middle"] };
  for (const [wanted, drawn] of Object.entries(isDrawn)) {
    await open(at(address, wanted));
    await atTick(wanted);
    assert.match(await details(), /replayed here\s+the same bits/);
    const joints = /joints tracked\s+(\S+) of 26/.exec(await details())?.[1];
    assert.equal(joints, { 700: "none", 1700: "21" }[wanted]);
    await shot(`tracked ${wanted}`);
    const told = await tips();
    for (const finger of ["index", "middle"])
      assert.equal(told.some((tip) => tip.startsWith(finger)), drawn.includes(finger), `tick ${wanted}: ${told}`);
  }
});

test("A proxy is told apart from the tracked hand", async () => {
  execFileSync(program, ["run", join(dirname(scene), "sheet.json"), "--record", file("proxy.mcap")]);
  await open(await serve("view", file("proxy.mcap"), "--no-browser"));
  await atTick(0);
  const line = await page.locator("#timeline").boundingBox();
  const lag = async () => Number(/proxy\s+up to (\S+) mm/.exec(await details())[1]);
  const lags = [];
  for (let share = 0.05; share < 1; share += 0.1) {
    const before = await tick();
    await page.mouse.click(line.x + share * line.width, line.y + 30);
    await page.waitForFunction((from) => Number(document.body.dataset.tick) !== from, before, kPatience);
    lags.push(await lag());
    if (lags.at(-1) > 1) await shot("proxy");
  }
  assert.ok(Math.min(...lags) < 0.1 && Math.max(...lags) > 1, `${lags}`);
  assert.match(await details(), /replayed here\s+the same bits/);
});

test("It plays, pauses, steps, loops and goes where the timeline is pressed", async () => {
  await open(at(one, 3000));
  await page.keyboard.press("Space");
  await page.waitForFunction(() => Number(document.body.dataset.tick) > 3050, null, kPatience);
  await page.keyboard.press("Space");
  const paused = await settled(tick);
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await atTick(paused + 2);
  await page.keyboard.press("ArrowLeft");
  await atTick(paused + 1);
  const box = await page.locator("#timeline").boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + 30);
  await page.waitForFunction(() => Math.abs(Number(document.body.dataset.tick) - 5000) < 30, null, kPatience);
  await page.keyboard.press("End");
  await atTick(9999);
});

test("Plots show values where the pointer is, zoom by a drag and seek by a click", async () => {
  await open(one);
  await scanned();
  const plot = page.locator(".plot:not([hidden]) .u-over").first();
  const box = await plot.boundingBox();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 20);
  await page.waitForFunction(() => /N/.test(document.querySelector(".plot:not([hidden]) .values").textContent), null, kPatience);
  await page.mouse.click(box.x + 0.4 * box.width, box.y + 20);
  await page.waitForFunction(() => Math.abs(Number(document.body.dataset.tick) - 4000) < 60, null, kPatience);
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 20, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(() => {
    const [from, to] = (document.body.dataset.range ?? "").split(" ").map(Number);
    return Math.abs(from - 3000) < 60 && Math.abs(to - 5000) < 60;
  }, null, kPatience);
  await page.waitForTimeout(500);
  await shot("zoomed");
  await page.keyboard.press("l");
  await page.keyboard.press("Space");
  await page.waitForTimeout(500);
  const now = await tick();
  assert.ok(now >= 2940 && now <= 5060, `${now} is outside the loop`);
});

test("A click tells all that is known of a segment and of a triangle; an arrow tells its number", async () => {
  await open(at(one, 3980));
  await atTick(3980);
  const box = await page.locator("#canvas").boundingBox();
  const found = new Set();
  for (let y = 0.3; y < 0.75; y += 0.05) {
    for (let x = 0.25; x < 0.65; x += 0.04) {
      await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
      const tip = await page.locator("#tip").innerText();
      if (/ N$/.test(tip)) found.add("force");
      await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
      const text = await details();
      if (/^Triangle/.test(text) && /corner a/.test(text)) found.add("triangle");
      if (/contacted area/.test(text)) found.add("segment");
      if (found.size === 3) return;
    }
  }
  assert.fail(`found only ${[...found].join(", ")}`);
});

test("The longest arrow, the palm's too, keeps within its bound", async () => {
  const held = JSON.parse(readFileSync(scene, "utf8"));
  held.objects = [{ name: "block", box: { size: [0.03, 0.03, 0.03], cells: 4 }, position: [-0.022, 0, 0.045] }];
  held.settings.rate = 200;
  writeFileSync(file("in the palm.json"), JSON.stringify(held));
  execFileSync(program, ["run", file("in the palm.json"), "--ticks", "900", "--record", file("in the palm.mcap")]);
  const ticks = execFileSync(program, ["export", "--format", "json", file("in the palm.mcap")], { maxBuffer: 1 << 28 }).toString().trim().split("\n");
  const most = ticks.map((line) => JSON.parse(line).output.segment).map((all) => all.map(({ force }) => Math.hypot(...force)))
    .reduce((highest, forces) => highest.map((value, s) => Math.max(value, forces[s])));
  assert.equal(Math.max(...most), most[15], "the palm feels most");
  await open(await serve("view", file("in the palm.mcap"), "--no-browser"));
  await scanned();
  await page.waitForTimeout(300);
  const [, ofTen] = /10 mm are (\S+) N/.exec(await page.locator("#legend").innerText());
  assert.ok(most[15] / ofTen < 6.01, `${most[15]} N, of which 10 mm are ${ofTen}`);
});

test("A recording of a single tick, far from the first one, is shown like any other", async () => {
  execFileSync(program, ["trim", file("grasp.mcap"), "--from-tick", "3000", "--to-tick", "3001", "-o", file("one tick.mcap")]);
  await open(await serve("view", file("one tick.mcap"), "--no-browser"));
  await atTick(3000);
  await scanned();
  assert.equal(await message(), "");
  assert.match(await details(), /the same bits/);
});

/** Clicks all over the scene until the details say so. */
async function clickUntil(said) {
  const box = await page.locator("#canvas").boundingBox();
  for (let x = 0.1; x < 0.95; x += 0.05)
    for (let y = 0.2; y < 0.9; y += 0.1) {
      await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
      await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(drawn)));  // the details are, in the same frame
      if (said.test(await details())) return true;
    }
  return false;
}

test("Two hands of a session are shown together, each computed bit for bit", async () => {
  execFileSync(program, ["run", join(dirname(scene), "two_hands.json"), "--record", file("two hands.mcap")]);
  await open(at(await serve("view", file("two hands.mcap"), "--no-browser"), 1100));
  await atTick(1100);
  await scanned();
  assert.equal(await message(), "");
  const text = await details();
  assert.match(text, /hand\s*right/);
  assert.match(text, /the same bits/);
  assert.doesNotMatch(text, /compared/);
  assert.match(await page.locator("#legend").innerText(), /orange the right hand, blue the left one/);
  assert.equal(await page.getByText("Difference of force per segment").isVisible(), false);
  // The other hand is there too: a click on it tells whose it is.
  assert.ok(await clickUntil(/hand\s*left/), "no pixel of the left hand");
  assert.match(await details(), /the same bits/);
  await shot("two_hands");
});

test("What both hands touch tells of both, wherever it is clicked", async () => {
  copyFileSync(join(dirname(scene), "hold.json"), file("hold.json"));
  const block = { name: "block", box: { size: [0.07, 0.07, 0.12], cells: 2 }, friction: 0.5 };
  writeFileSync(file("block.json"), JSON.stringify({ objects: [block], motion: { file: "hold.json", side: "both" } }));
  execFileSync(program, ["run", file("block.json"), "--record", file("block.mcap")]);
  await open(`${at(await serve("view", file("block.mcap"), "--no-browser"), 1100)}&camera=0.2,-0.27,0.17,0,0,0`);
  await atTick(1100);
  for (let i = 0; i < 15; ++i) await page.keyboard.press("a");  // to the left hand's side
  assert.ok(await clickUntil(/touched by\s+left/), "no triangle that the left hand touches");
  assert.match(await details(), /force of the right hand on it\s+[\d.]*[1-9]/);
  assert.match(await details(), /force of the left hand on it\s+[\d.]*[1-9]/);
  assert.ok((await tips()).some((tip) => /^block: right \S+ N, left \S+ N$/.test(tip)));
  await shot("block");
});

test("A running session is shown, read-only", async () => {
  const slow = JSON.parse(readFileSync(scene, "utf8"));
  slow.motion.grasp.seconds = 60;  // however long the browser takes
  writeFileSync(file("slow.json"), JSON.stringify(slow));
  await open(await serve("run", file("slow.json"), "--rate", "1000", "--view"));
  const first = await tick();
  await page.waitForFunction((from) => Number(document.body.dataset.tick) > from + 500, first, kPatience);
  await page.waitForFunction(() => /contacts\s*[1-9]/.test(document.getElementById("details").innerText), null, kPatience);
  await page.waitForTimeout(1500);
  await shot("live");
  await page.keyboard.press("Space");
  await page.keyboard.press("Home");
  assert.equal(await page.locator("#message").isVisible(), false);
  started.at(-1).kill("SIGTERM");
  await page.waitForFunction(() => /the session has ended/.test(document.getElementById("message").innerText), null, kPatience);
});

test("A running session of two hands is shown with both", async () => {
  const examples = dirname(scene);
  const hold = JSON.parse(readFileSync(join(examples, "hold.json"), "utf8"));
  const [titles, ...frames] = hold.frames;
  const length = frames.at(-1)[0] + frames[1][0] - frames[0][0];
  hold.frames = [titles, ...[...Array(40).keys()].flatMap((turn) => frames.map(([time, ...rest]) => [time + turn * length, ...rest]))];
  writeFileSync(file("hold.json"), JSON.stringify(hold));
  copyFileSync(join(examples, "cup.obj"), file("cup.obj"));
  copyFileSync(join(examples, "two_hands.json"), file("both.json"));
  await open(await serve("run", file("both.json"), "--rate", "100", "--view"));
  await page.waitForFunction(() => /contacts\s*[1-9]/.test(document.getElementById("details").innerText), null, kPatience);
  assert.match(await details(), /hand\s*right/);
  assert.match(await page.locator("#legend").innerText(), /orange the right hand, blue the left one/);
  await page.keyboard.press("Space");
  await page.waitForTimeout(1000);
  await shot("live_two_hands");
  assert.ok(await clickUntil(/hand\s*left/), "no pixel of the left hand");
  assert.equal(await message(), "");
});

/** Serves what is a recording, which the program looks at first, until it is served. */
async function serveForeign(...args) {
  writeFileSync(file("foreign.mcap"), Buffer.from("\x89MCAP0\r\n".padEnd(1100), "latin1"));
  const address = await serve(...args);
  writeFileSync(file("foreign.mcap"), "solid cube\n".repeat(100));
  return address;
}

test("A torn, damaged or foreign file is told what is wrong and where", async () => {
  const expect = { torn: /byte \d+: the file is torn.*lumbrical recover/s, damaged: /byte \d+ is damaged/, foreign: /byte 0: not a recording/ };
  for (const [name, text] of Object.entries(expect)) {
    await open(at(await serveForeign("view", file(`${name}.mcap`), "--no-browser"), 4000));
    if (name === "damaged") {
      await scanned();
      await page.keyboard.press("Space");  // it plays as far as it can
      await page.waitForFunction(() => Number(document.body.dataset.tick) > 4000, null, kPatience);
      await page.waitForFunction(() => /Play/.test(document.querySelector("#play").innerText), null, kPatience);
      assert.ok((await tick()) < 9900);
      await page.keyboard.press("End");  // what is whole is shown all the same
      await atTick(9999);
    }
    assert.match(await message(), text);
    assert.match(await message(), new RegExp(`${name}\\.mcap`));
    await shot(name);
  }
});

test("Dark, and on a phone: nothing is cut off and no text is small", async () => {
  for (const [name, options] of Object.entries({ dark: { colorScheme: "dark" }, phone: { viewport: { width: 390, height: 844 } } })) {
    await openNew(at(one, 3980), options);
    await atTick(3980);
    await scanned();
    await page.waitForTimeout(300);
    await shot(name);
    const { wider, small } = await page.evaluate(() => ({
      wider: document.documentElement.scrollWidth - innerWidth,
      small: [...document.querySelectorAll("body *")].filter((one) => one.textContent && parseFloat(getComputedStyle(one).fontSize) < 12).map((one) => one.tagName),
    }));
    assert.ok(wider <= 0, `${name}: ${wider} pixels too wide`);
    assert.deepEqual(small, [], name);
  }
});

test("In a small window the legend leaves the scene to be seen", async () => {
  for (const [width, height] of [[480, 400], [390, 844], [844, 390]]) {
    await openNew(at(one, 3980), { viewport: { width, height } });
    await atTick(3980);
    await shot(`small ${width}`);
    const [scene, legend] = await page.evaluate(() => ["canvas", "legend"].map((id) => document.getElementById(id).getBoundingClientRect().toJSON()));
    const across = Math.max(0, Math.min(scene.right, legend.right) - Math.max(scene.left, legend.left));
    const down = Math.max(0, Math.min(scene.bottom, legend.bottom) - Math.max(scene.top, legend.top));
    const covered = (across * down) / (scene.width * scene.height);
    assert.ok(covered < 0.1, `${width} x ${height}: ${covered} of it is covered`);
    const { bottom } = await page.locator("main").evaluate((main) => main.getBoundingClientRect().toJSON());
    assert.ok(scene.bottom <= bottom, `${width} x ${height}: the scene is cut off`);
    assert.match(await page.locator("#legend").innerText(), /Pa$/m);
  }
});

/** In the page, before its own scripts: counts what has to be given back. */
function countKept() {
  window.kept = { buffers: 0, observed: 0, listeners: 0 };
  const count = (owner, name, what, by) => {
    const real = owner[name];
    owner[name] = function (...given) {
      kept[what] += by;
      return real.apply(this, given);
    };
  };
  count(WebGL2RenderingContext.prototype, "createBuffer", "buffers", 1);
  count(WebGL2RenderingContext.prototype, "deleteBuffer", "buffers", -1);
  count(ResizeObserver.prototype, "observe", "observed", 1);
  count(ResizeObserver.prototype, "disconnect", "observed", -1);
  count(window, "addEventListener", "listeners", 1);
  count(window, "removeEventListener", "listeners", -1);
}

test("What was open before leaves nothing behind", async () => {
  await openNew(at(await serve("view", file("grasp.mcap"), "--no-browser"), 3980), {}, `(${countKept})(); ${workerWatch}`);
  const openAgain = async () => {
    await page.evaluate(() => { delete document.body.dataset.scanned; });
    await page.setInputFiles("#open", file("grasp.mcap"));
    await scanned();
    await atTick(0);
    await page.waitForTimeout(500);
    return page.evaluate(() => ({ ...kept, plots: document.querySelectorAll(".uplot").length }));
  };
  const once = await openAgain();
  await openAgain();
  assert.deepEqual(await openAgain(), once);
  await page.keyboard.press("Space");
  await page.waitForFunction(() => Number(document.body.dataset.tick) > 50, null, kPatience);
  await page.getByText("Lab", { exact: true }).click();
  await page.waitForFunction(() => /force of the hand/.test(document.querySelector("#details").innerText) && document.querySelector("#name").innerText === "lab", null, kPatience);
  assert.equal(await page.evaluate(async () => (await ask({ type: "show", place: 0, tick: 5000 })).shown), undefined);
  await page.waitForTimeout(500);
  assert.equal(await message(), "");
});

test("A question mark lists the keys", async () => {
  await open(one);
  await page.keyboard.press("?");
  assert.ok(await page.getByText("play or pause").isVisible());
  await shot("help");
});

test("A link brings back tick and camera", async () => {
  await open(at(one, 4200));
  await atTick(4200);
  for (let i = 0; i < 5; ++i) await page.keyboard.press("d");
  await page.waitForFunction(() => /camera=/.test(location.hash), null, kPatience);
  const link = await settled(() => page.url());
  await open(link);
  await atTick(4200);
  assert.equal(await settled(() => page.url()), link);
});

test("A link that comes into an open page is followed", async () => {
  await open(at(one, 4200));
  await atTick(4200);
  await page.evaluate(() => { location.hash = location.hash.replace(/tick=\d+/, "tick=1700"); });
  await atTick(1700);
  assert.match(await settled(() => page.url()), /tick=1700/);
});

test("Of a link whose first recording can't be opened nothing is compared with what was open before", async () => {
  await open((await serveForeign("view", file("grasp.mcap"), file("foreign.mcap"), "--no-browser")).replace(/&.*/, ""));
  await page.evaluate(() => { location.hash = "#recording=b/foreign.mcap&recording=a/grasp.mcap"; });
  await page.waitForFunction(() => /foreign\.mcap: byte 0/.test(document.querySelector("#message").innerText), null, kPatience);
  await settled(message);
  assert.equal(await page.locator("#name").innerText(), "grasp.mcap");
});

test("Nothing leaves the page's origin, and nothing but the named files is reachable", async () => {
  const origin = new URL(one).origin;
  await open(one);
  let reached = 0;
  const other = createServer((_, response) => { ++reached; response.end(); }).listen(0, "127.0.0.1");
  await new Promise((listening) => other.once("listening", listening));
  const blocked = await page.evaluate((to) => fetch(to, { mode: "no-cors" }).then(() => false, () => true), `http://127.0.0.1:${other.address().port}/`);
  other.close();
  assert.ok(blocked && reached === 0, "a request went to another origin");
  for (const path of ["/etc/passwd", "/a/../../etc/passwd", "/a/", "/a/torn.mcap", "/%2e%2e/grasp.mcap"])
    assert.equal((await fetch(origin + path)).status, 404, path);
  const strange = requests.filter((url) => !/^(blob:)?http:\/\/127\.0\.0\.1:\d+\/|^(data|blob):/.test(url));
  assert.deepEqual(strange, []);
});

test("The page works from disk, with a file that is picked", async () => {
  const folderOfProgram = dirname(resolve(program));
  await open(`file://${join(folderOfProgram, "../viewer/viewer.html")}`);
  await page.setInputFiles("#open", file("grasp.mcap"));
  await page.waitForFunction(() => document.querySelector("#name").innerText === "grasp.mcap", null, kPatience);  // the lab was open before
  await page.keyboard.press("End");
  await atTick(9999);
  assert.match(await details(), /replayed here\s+the same bits/);
});

test("The page had nothing to complain of but what was meant to fail", () => {
  assert.deepEqual(complaints.filter((text) => !/Content Security Policy|violates/.test(text)), []);
});
