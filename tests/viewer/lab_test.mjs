// The viewer's lab in a real browser: a hand moved by pointer, sliders, motion files and a headset, and that what was felt replays
// natively. Arguments: browser.mjs.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { before, test } from "node:test";
import { complaints, details, file, kPatience, message, open, openNew, page, program, scene, serve, settled, shot, workerWatch } from "./browser.mjs";
import { capture, headset, wristAt } from "./headset.mjs";

let lab;
before(async () => { lab = `${new URL(await serve("view", "--no-browser")).origin}/`; });

const contacts = () => page.waitForFunction(() => /contacts\s*[1-9]/.test(document.getElementById("details").innerText), null, kPatience);
const felt = (ticks) => page.waitForFunction((most) => Number(document.body.dataset.tick) > most, ticks, kPatience);
const slide = (label, value) => page.locator("#lab label", { hasText: label }).locator("input").evaluate((input, to) => {
  input.value = to;
  input.dispatchEvent(new Event("input"));
}, value);
const choose = (label, text) => page.locator("#lab label", { hasText: label }).locator("select").selectOption({ label: text });
const drop = (name, text) => page.evaluate(([name, text]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([text], name));
  dispatchEvent(new DragEvent("drop", { dataTransfer }));
}, [name, text]);

/** The ticks of a recording, with all that it holds. */
const exported = (name) =>
  execFileSync(program, ["export", "--format", "json", file(name)], { maxBuffer: 1 << 28 }).toString().trim().split("\n").map((line) => JSON.parse(line));

/** Saves what was felt, and answers its ticks. */
async function replays(name) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("Save what was felt").click()]);
  await download.saveAs(file(name));
  const result = JSON.parse(execFileSync(program, ["replay", "--json", file(name)]));
  assert.ok(result.identical && result.ticks > 5, JSON.stringify(result));
  return exported(name);
}

test("Without a recording the page is a lab, and what was felt in it replays natively, bit for bit", async () => {
  await open(lab);
  for (const bend of [0.3, 0.6, 0.9]) {
    await slide("All fingers", bend);
    await page.waitForTimeout(200);
  }
  await contacts();
  await shot("lab");
  await replays("felt.mcap");

  const corner = (i) => `v ${i & 1} ${(i >> 1) & 1} ${i >> 2}\n`;
  const cube = [0, 1, 2, 3, 4, 5, 6, 7].map(corner).join("") + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  await drop("cube.obj", cube);
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

test("The camera stays where it was turned to when a setting is changed", async () => {
  const picture = () => page.locator("#canvas").evaluate((canvas) => canvas.toDataURL());
  const pictureWith = async (...setting) => {
    await felt(50);
    await choose(...setting);
    await page.waitForFunction(() => Number(document.body.dataset.tick) < 50, null, kPatience);
    await felt(5);
    return settled(picture);
  };
  await open(lab);
  for (let i = 0; i < 5; ++i) await page.keyboard.press("d");
  const before = await settled(picture);
  assert.ok((await pictureWith("Precision", "1e-2")) === before);
  assert.ok((await pictureWith("Object", "sphere")) !== before);
});

test("A motion file that is dropped moves the hand, and what was felt replays natively, bit for bit", async () => {
  await open(lab);
  writeFileSync(file("sweep.json"), capture(0.4));
  await drop("sweep.json", capture(0.4));
  await contacts();
  await felt(30);  // more than once
  await shot("lab motion");
  const ticks = await replays("felt motion.mcap");
  const joints = (tick) => JSON.stringify(tick.device.joint);
  assert.equal(joints(ticks[27]), joints(ticks[5]), "22 ticks lie between the first sample and the last");
  execFileSync(program, ["run", scene, "--motion", file("sweep.json"), "--ticks", "60", "--record", file("native motion.mcap")]);
  assert.equal(joints(ticks[3]), joints(exported("native motion.mcap")[50]), "0.05 s on, 60 and 1000 ticks a second");
});

test("Motion files of other formats are read by the engine; one that it can't read is told, and the lab goes on", async () => {
  await open(lab);
  await page.setInputFiles("#lab-file", join(dirname(scene), "stroke.csv"));
  await felt(20);
  assert.equal(await message(), "");
  await replays("felt stroke.mcap");
  await drop("torn.json", capture(1).slice(0, 4000));
  await page.waitForFunction(() => /torn\.json:1:\d+: not valid JSON/.test(document.querySelector("#message").innerText), null, kPatience);
  const lists = () => page.locator("#lab select").evaluateAll((all) => all.map((list) => list.selectedOptions[0].text).join(", "));
  assert.match(await lists(), /^mug, .*, stroke\.csv, /, "what is felt is what the lists say");
  await drop("torn.obj", "v 0 0\n");
  await page.waitForFunction(() => /torn\.obj:1/.test(document.querySelector("#message").innerText), null, kPatience);
  assert.match(await lists(), /^mug, /);
  assert.equal(await page.locator("#lab option", { hasText: "torn" }).count(), 0);
  await choose("Hand moved by", "pointer and sliders");
  await page.waitForFunction(() => document.querySelector("#message").hidden, null, kPatience);
  await felt(5);
});

test("A headset's hand is felt as it comes, is lost openly, and replays natively, bit for bit", async () => {
  await openNew(lab, {}, headset);
  const button = page.getByText("Hand tracking");
  await button.click();
  await contacts();
  await page.waitForFunction(() => told.length > 60, null, kPatience);
  await shot("lab headset");
  const ticks = await replays("felt headset.mcap");
  const told = (await page.evaluate(() => window.told)).map((position) => position.map(Math.fround).join());
  const wrist = ({ device }) => device.joint[1].position.map(Math.fround).join();
  const isLost = ({ device }) => (device.flags & 1) !== 0;
  assert.ok(ticks.some(isLost) && isLost(ticks.find((tick, i) => i > 0 && wrist(tick) === wrist(ticks[i - 1]))));
  const seen = ticks.filter((tick) => !isLost(tick)).map((tick) => told.indexOf(wrist(tick)));
  assert.ok(seen.length > 20 && seen.every((at, i) => at > (seen[i - 1] ?? -1)), `${seen}`);
  // The lab's origin lies 0.45 m before the eyes and 0.35 m below them, z up.
  const placed = [0, 1, 2, 3, 4].map((picture) => wristAt(picture / 72)).map(([x, y, z]) => [x, -z - 0.45, y + 0.35]);
  const first = told[0].split(",");
  assert.ok(placed.some((wrist) => wrist.every((value, i) => Math.abs(value - first[i]) < 1e-6)), `${first}`);

  await button.click();  // and back to the pointer
  await page.waitForFunction(() => document.querySelector("#lab label:nth-of-type(8)").hidden === false, null, kPatience);
  await felt(5);
});

test("A headset's session that fails halfway is ended, and the lab goes on", async () => {
  const failing = {
    "no layer": `window.XRWebGLLayer = class { constructor() { throw new Error("no layer"); } };`,
    "no space": `window.XRRigidTransform = class { constructor() { throw new Error("no space"); } };`,
  };
  for (const [why, script] of Object.entries(failing)) {
    await openNew(lab, {}, headset + script);
    await felt(5);
    for (let turn = 0; turn < 2; ++turn) {
      await page.getByText("Hand tracking").click();
      await page.waitForFunction((text) => document.querySelector("#message").innerText === `hand tracking: ${text}`, why, kPatience);
      assert.equal(await page.evaluate(() => window.worn), 0, why);
      await page.evaluate(() => { document.querySelector("#message").innerText = ""; });
    }
    await felt(Number(await page.getAttribute("body", "data-tick")) + 20);
  }
});

test("Time goes on where there is no more room for what was felt", async () => {
  await openNew(lab, {}, workerWatch);
  await felt(5);
  await page.evaluate(async () => {
    const hand = new Float64Array(27).fill(1, 0, 4);  // far away, where a tick is short
    for (let turn = 0; turn < 37; ++turn) await Promise.all(Array.from({ length: 1000 }, () => ask({ type: "touch", hand })));
  });
  await felt(37000);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("Save what was felt").click()]);
  await download.saveAs(file("felt long.mcap"));
  assert.match(await message(), /last \d+ ticks are not in it/);
  assert.equal(JSON.parse(execFileSync(program, ["replay", "--json", file("felt long.mcap")])).ticks, 36000);
});

test("Without a headset there is no button for it", async () => {
  await open(lab);
  assert.equal(await page.getByText("Hand tracking").isVisible(), false);
});

test("The lab had nothing to complain of", () => {
  assert.deepEqual(complaints, []);
});
