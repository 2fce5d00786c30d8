// How long the viewer takes in a browser to open ten minutes of a session, to seek and to draw, how much it keeps in memory, and what a
// live page costs the session it looks at. Prints Markdown.
//   node bench/viewer_speed.mjs build/release/tools/lumbrical build/dev/viewer /usr/bin/chromium examples/demo.json FOLDER
// Its recording of 600,000 ticks (500 MB) is kept in FOLDER, and taken from there the next time.
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { before, test } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";
import { chromiumPath, file, folder, kPatience, openNew, page, program, scene, serve, started } from "../tests/viewer/browser.mjs";

const kTicks = 600000, kOpenings = 5, kSeeks = 20, kSeconds = 10;
const kReading = 40;  // [s]
const kLiveFor = 30, kTouchingAfter = 8;  // [s] of a live session, and from when on its hand holds the mug
const long = file("ten_minutes.mcap");
const tell = (what, result) => console.log(`| ${what} | ${result} |`);
const median = (numbers) => numbers.toSorted((a, b) => a - b)[numbers.length >> 1];
const range = (numbers, unit) =>
  `median ${median(numbers).toFixed(0)}, ${Math.min(...numbers).toFixed(0)} to ${Math.max(...numbers).toFixed(0)} ${unit}`;

/** The scene's grasp, stretched to so many seconds. */
function stretched(seconds, name) {
  const slow = JSON.parse(readFileSync(scene, "utf8"));
  slow.motion.grasp.seconds = seconds;
  writeFileSync(file(name), JSON.stringify(slow));
  return file(name);
}

before(() => {
  mkdirSync(folder, { recursive: true });
  if (!existsSync(long)) execFileSync(program, ["run", stretched(kTicks / 1000, "ten_minutes.json"), "--record", long], { stdio: "ignore" });
  console.log(`| ${kTicks} ticks, ${(statSync(long).size / 1e6).toFixed(0)} MB | |\n|---|---|`);
});

/** In the page, before its own code: when its first tick stood on the screen [ms]. */
function watchFirstTick() {
  const watch = new MutationObserver(() => {
    if (!document.body?.dataset.ready || document.body.dataset.tick === undefined) return;
    watch.disconnect();
    requestAnimationFrame(() => requestAnimationFrame(() => { window.firstTick = performance.now(); }));
  });
  watch.observe(document, { subtree: true, attributes: true, attributeFilter: ["data-ready", "data-tick"] });
}

/** In the page: answers the times [ms] from the next press of a button until another tick is known, and until it stands on the screen. */
function timeSeek() {
  window.seekTime = new Promise((done) => {
    addEventListener("pointerdown", () => {
      const start = performance.now();
      const watch = new MutationObserver(() => {
        watch.disconnect();
        const known = performance.now() - start;
        requestAnimationFrame(() => done([known, performance.now() - start]));
      });
      watch.observe(document.body, { attributeFilter: ["data-tick"] });
    }, { capture: true, once: true });
  });
}

/** [bytes] That a process shares with no other. */
function privateMemory(pid) {
  const lines = readFileSync(`/proc/${pid}/smaps_rollup`, "utf8").matchAll(/^Private_\w+:\s+(\d+) kB/gm);
  return 1024 * [...lines].reduce((sum, line) => sum + Number(line[1]), 0);
}

/** Processes that show pages of the browser with that folder. */
function pagesOf(profile) {
  return readdirSync("/proc").filter((pid) => {
    if (!/^\d+$/.test(pid)) return false;
    try {
      const words = readFileSync(`/proc/${pid}/cmdline`, "utf8");
      return words.includes("--type=renderer") && words.includes(profile);
    } catch {
      return false;  // it has ended
    }
  });
}

let address;

test("open", async () => {
  address = await serve("view", long, "--no-browser");
  const times = [];
  for (let i = 0; i < kOpenings; ++i) {
    await openNew(address, {}, watchFirstTick);
    await page.waitForFunction(() => window.firstTick !== undefined, null, kPatience);
    times.push(await page.evaluate(() => window.firstTick));
  }
  tell("open, page and first picture included", range(times, "ms"));
});

test("seek", async () => {
  await page.waitForSelector('body[data-scanned="1"]', { timeout: 120000 });
  tell("the whole file read in the background, since the page began", `${((await page.evaluate(() => performance.now())) / 1000).toFixed(1)} s`);
  const line = await page.locator("#timeline").boundingBox();
  const times = [];
  for (let i = 0; i < kSeeks; ++i) {
    await page.evaluate(timeSeek);
    await page.mouse.click(line.x + line.width * (0.02 + 0.96 * ((i * 0.618) % 1)), line.y + 30);
    times.push(await page.evaluate(() => window.seekTime));
  }
  tell("seek: until the tick and its contacts are computed", range(times.map(([known]) => known), "ms"));
  tell("seek: until they are drawn", range(times.map(([, drawn]) => drawn), "ms"));
});

test("play", async () => {
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const metrics = async () => Object.fromEntries((await session.send("Performance.getMetrics")).metrics.map(({ name, value }) => [name, value]));
  await page.keyboard.press("Space");
  await sleep(1000);
  const from = await metrics();
  const frames = await page.evaluate((time) => new Promise((done) => {
    let count = 0;
    const end = performance.now() + time;
    const next = () => (performance.now() < end ? (++count, requestAnimationFrame(next)) : done(count));
    requestAnimationFrame(next);
  }), 1000 * kSeconds);
  const to = await metrics();
  await page.keyboard.press("Space");
  const spent = (name) => (1000 * (to[name] - from[name])) / frames;
  tell("play: pictures a second here", (frames / kSeconds).toFixed(1));
  tell("play: a picture takes the page's thread", `${spent("TaskDuration").toFixed(1)} ms, of which scripts ${spent("ScriptDuration").toFixed(1)}`);
});

// In a browser of its own: one that is driven keeps whatever the page fetched, 200 MB of it, for who drives it.
test("memory", async () => {
  const profile = file("profile");
  started.push(spawn(chromiumPath, ["--headless", "--no-sandbox", `--user-data-dir=${profile}`, address], { stdio: "ignore" }));
  let most = 0;
  for (let second = 0; second < kReading; ++second) {
    await sleep(1000);
    most = Math.max(most, ...pagesOf(profile).map(privateMemory));
  }
  tell(`memory of the page's process in its first ${kReading} s, in which it reads the whole file: at most`, `${(most / 1e6).toFixed(0)} MB`);
});

/** [s] Of processor time that a process has taken. */
function processorTime(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\) /s, "").split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

/** [%] Of a processor, while the session's hand holds the mug. */
async function shareOf(session, begun) {
  await sleep(1000 * kTouchingAfter - (performance.now() - begun));
  const start = processorTime(session.pid);
  await sleep(1000 * kSeconds);
  return (100 * (processorTime(session.pid) - start)) / kSeconds;
}

test("live", async () => {
  const live = ["run", stretched(kLiveFor, "live.json"), "--rate", "1000"];
  const alone = spawn(program, live, { stdio: "ignore" });
  started.push(alone);
  const without = await shareOf(alone, performance.now());
  alone.kill("SIGTERM");
  const begun = performance.now();
  await openNew(await serve(...live, "--view"));
  const watched = await shareOf(started.at(-1), begun);
  tell("a session at 1 kHz takes of a processor", `${without.toFixed(1)} % alone, ${watched.toFixed(1)} % while a page looks`);
});
