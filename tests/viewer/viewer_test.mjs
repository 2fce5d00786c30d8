// The viewer in a real browser, Chromium without a screen: what a person does with it, and that nothing leaves the page's origin.
//   node viewer_test.mjs PROGRAM PACKAGES CHROMIUM SCENE FOLDER
// PACKAGES has node_modules with playwright-core; recordings and screenshots of the main views go to FOLDER.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { join, dirname, resolve } from "node:path";
import { after, before, test } from "node:test";

const [program, packages, chromiumPath, scene, folder] = process.argv.slice(2);
const { chromium } = createRequire(join(packages, "package.json"))("playwright-core");
const kPatience = { timeout: 30000 };
const file = (name) => join(folder, name);
const started = [];
let browser, page;
const requests = [];
const complaints = [];

/** Starts the program and answers the address it prints. */
function serve(...args) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "pipe"] });
  started.push(child);
  return new Promise((found, failed) => {
    let text = "";
    const read = (data) => {
      text += data;
      const address = /http:\/\/127\.0\.0\.1:\d+\/\S*/.exec(text);
      if (address) found(address[0]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    child.on("exit", () => failed(new Error(`${args.join(" ")} ended: ${text}`)));
  });
}

async function open(address, options = {}) {
  await page?.context().close();
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light", ...options });
  page = await context.newPage();
  page.on("request", (request) => requests.push(request.url()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await page.goto(address);
  await page.waitForSelector("body[data-ready]", kPatience);
}

const scanned = () => page.waitForSelector('body[data-scanned="1"]', kPatience);
const tick = async () => Number(await page.getAttribute("body", "data-tick"));
const atTick = (wanted) => page.waitForSelector(`body[data-tick="${wanted}"]`, kPatience);
const details = () => page.locator("#details").innerText();
const shot = (name) => page.screenshot({ path: file(`${name}.png`) });
const message = () => page.locator("#message").innerText();

/** As a link says it. */
const at = (address, wanted) => `${address}&tick=${wanted}`;

before(async () => {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const run = (name, ...args) => execFileSync(program, ["run", scene, "--record", file(name), ...args]);
  run("grasp.mcap", "--threads", "1");
  run("softer.mcap", "--threads", "1", "--stiffness", "1.9e7");
  execFileSync(program, ["run", join(dirname(scene), "mug.json"), "--record", file("lift.mcap")]);
  run("hashes only.mcap", "--threads", "1", "--ticks", "4200", "--record-forces", "none");
  const whole = readFileSync(file("grasp.mcap"));
  writeFileSync(file("torn.mcap"), whole.subarray(0, whole.length >> 1));
  const damaged = Buffer.from(whole);
  damaged.fill(0x55, whole.length >> 1, (whole.length >> 1) + 2000);
  writeFileSync(file("damaged.mcap"), damaged);
  writeFileSync(file("foreign.mcap"), "solid cube\n".repeat(100));
  browser = await chromium.launch({ executablePath: chromiumPath, args: ["--no-sandbox"] });
});

after(async () => {
  await browser?.close();
  for (const child of started) child.kill("SIGTERM");
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
  const picture = await page.locator("#scene").boundingBox();
  await page.mouse.click(picture.x + picture.width / 2, picture.y + picture.height / 2);
  await page.waitForFunction(() => /stands at/.test(document.querySelector("#details").innerText), null, kPatience);
  assert.match(await details(), /object\s+mug\s+stands at\s+0, 0, 0 mm/);
  const line = await page.locator("#timeline").boundingBox();
  await page.mouse.click(line.x + 0.55 * line.width, line.y + 30);
  await page.waitForFunction(() => {
    const height = /stands at\s+\S+ \S+ (\S+) mm/.exec(document.querySelector("#details").innerText);
    return Number(height?.[1]) > 60;
  }, null, kPatience);
  assert.match(await details(), /force of the hand on it\s+[1-9]/);
  assert.match(await details(), /contacted triangles\s+[1-9]\d/);
  assert.match(await details(), /replayed here\s+the same bits/);
  await shot("lifted");
});

test("It plays, pauses, steps, loops and goes where the timeline is pressed", async () => {
  await open(at(one, 3000));
  await page.keyboard.press("Space");
  await page.waitForFunction(() => Number(document.body.dataset.tick) > 3050, null, kPatience);
  await page.keyboard.press("Space");
  await page.waitForTimeout(300);
  const paused = await tick();
  await page.keyboard.press("ArrowRight");
  await atTick(paused + 1);
  await page.keyboard.press("ArrowLeft");
  await atTick(paused);
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

test("Two recordings part where lumbrical diff says", async () => {
  await open(await serve("view", file("grasp.mcap"), file("softer.mcap"), "--no-browser"));
  let told;
  try {
    execFileSync(program, ["diff", "--json", file("grasp.mcap"), file("softer.mcap")]);
  } catch (error) {
    told = JSON.parse(error.stdout).first_divergence;
  }
  await atTick(told.tick);
  const text = await details();
  assert.match(text, new RegExp(`They part at tick ${told.tick}, stage "${told.stage.replace("_", " ")}"`));
  await scanned();
  await page.keyboard.press("c");
  const box = await page.locator("#timeline").boundingBox();
  await page.mouse.click(box.x + 0.4 * box.width, box.y + 30);
  await page.waitForFunction(() => Math.abs(Number(document.body.dataset.tick) - 4000) < 30, null, kPatience);
  assert.ok(await page.getByText("Difference of force per segment").isVisible());
  await shot("compared");
  await page.keyboard.press("c");
  await page.waitForTimeout(300);
  await shot("overlaid");
});

test("A recording of a single tick, far from the first one, is shown like any other", async () => {
  execFileSync(program, ["trim", file("grasp.mcap"), "--from-tick", "3000", "--to-tick", "3001", "-o", file("one tick.mcap")]);
  await open(await serve("view", file("one tick.mcap"), "--no-browser"));
  await atTick(3000);
  await scanned();
  assert.equal(await message(), "");
  assert.match(await details(), /the same bits/);
});

async function clickOnLeftHand() {
  const box = await page.locator("#canvas").boundingBox();
  for (let x = 0.1; x < 0.95; x += 0.05)
    for (let y = 0.2; y < 0.9; y += 0.1) {
      await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
      if (/hand\s*left/.test(await details())) return true;
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
  assert.ok(await clickOnLeftHand(), "no pixel of the left hand");
  assert.match(await details(), /the same bits/);
  await shot("two_hands");
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
  await open(await serve("run", file("both.json"), "--rate", "500", "--view"));
  await page.waitForFunction(() => /contacts\s*[1-9]/.test(document.getElementById("details").innerText), null, kPatience);
  assert.match(await details(), /hand\s*right/);
  assert.match(await page.locator("#legend").innerText(), /orange the right hand, blue the left one/);
  await page.waitForTimeout(1000);
  await shot("live_two_hands");
  assert.ok(await clickOnLeftHand(), "no pixel of the left hand");
  assert.equal(await message(), "");
});

test("A torn, damaged or foreign file is told what is wrong and where", async () => {
  const expect = { torn: /byte \d+: the file is torn.*lumbrical recover/s, damaged: /byte \d+ is damaged/, foreign: /byte 0: not a recording/ };
  for (const [name, text] of Object.entries(expect)) {
    await open(await serve("view", file(`${name}.mcap`), "--no-browser"));
    if (name === "damaged") {
      await scanned();
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
    await open(at(one, 3980), options);
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
  await page.waitForTimeout(700);
  const link = page.url();
  await open(link);
  await atTick(4200);
  await page.waitForTimeout(700);
  assert.equal(page.url(), link);
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
  for (const path of ["/etc/passwd", "/a/../../etc/passwd", "/a/", "/a/softer.mcap", "/%2e%2e/grasp.mcap"])
    assert.equal((await fetch(origin + path)).status, 404, path);
  const strange = requests.filter((url) => !/^(blob:)?http:\/\/127\.0\.0\.1:\d+\/|^(data|blob):/.test(url));
  assert.deepEqual(strange, []);
});

test("The page works from disk, with a file that is picked", async () => {
  const folderOfProgram = dirname(resolve(program));
  await open(`file://${join(folderOfProgram, "../viewer/viewer.html")}`);
  await page.setInputFiles("#open", file("grasp.mcap"));
  await page.waitForSelector("body:not(.empty)", kPatience);
  await page.keyboard.press("End");
  await atTick(9999);
  assert.match(await details(), /replayed here\s+the same bits/);
});

test("Without a recording the page is a lab, and what was felt in it replays natively, bit for bit", async () => {
  await open(`${new URL(await serve("view", "--no-browser")).origin}/`);
  const contacts = () => page.waitForFunction(() => /contacts\s*[1-9]/.test(document.getElementById("details").innerText), null, kPatience);
  const slide = (label, value) => page.locator("#lab label", { hasText: label }).locator("input").evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event("input"));
  }, value);
  const replays = async (name) => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("Save what was felt").click()]);
    await download.saveAs(file(name));
    const result = JSON.parse(execFileSync(program, ["replay", "--json", file(name)]));
    assert.ok(result.identical && result.ticks > 5, JSON.stringify(result));
  };
  for (const bend of [0.3, 0.6, 0.9]) {
    await slide("All fingers", bend);
    await page.waitForTimeout(200);
  }
  await contacts();
  await shot("lab");
  await replays("felt.mcap");

  const corner = (i) => `v ${i & 1} ${(i >> 1) & 1} ${i >> 2}\n`;
  const cube = [0, 1, 2, 3, 4, 5, 6, 7].map(corner).join("") + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  await page.evaluate((text) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], "cube.obj"));
    dispatchEvent(new DragEvent("drop", { dataTransfer }));
  }, cube);
  await page.waitForTimeout(500);
  const box = await page.locator("#canvas").boundingBox();
  await page.waitForFunction(() => Number(document.body.dataset.tick) > 5, null, kPatience);
  const pointer = { x: 0.1 * box.width, y: 0.2 * box.height };
  const move = () => page.mouse.move(box.x + pointer.x, box.y + pointer.y);
  for (let i = 0; i < 200 && !/proximal|palm|metacarpal/.test(await page.locator("#tip").innerText()); ++i) {
    pointer.x += 20;
    if (pointer.x > 0.7 * box.width) Object.assign(pointer, { x: 0.1 * box.width, y: pointer.y + 30 });
    await move();
  }
  await page.mouse.down();
  for (let i = 0; i < 30 && !/contacts\s*[1-9]/.test(await details()); ++i) {
    pointer.x += 8;
    pointer.y += 6;
    await move();
    await page.waitForTimeout(150);
  }
  await page.mouse.up();
  await shot("lab mesh");
  await contacts();
  await replays("felt mesh.mcap");
});

test("The page had nothing to complain of but what was meant to fail", () => {
  assert.deepEqual(complaints.filter((text) => !/Content Security Policy|violates/.test(text)), []);
});
