// What tests and measurements of the viewer share: the program that serves its page, and Chromium without a screen.
//   node A_TEST.mjs PROGRAM PACKAGES CHROMIUM SCENE FOLDER
// PACKAGES has node_modules with playwright-core; recordings and screenshots of the main views go to FOLDER, which exists.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { after, before } from "node:test";

export const [program, packages, chromiumPath, scene, folder] = process.argv.slice(2);
const { chromium } = createRequire(resolve(packages, "package.json"))("playwright-core");
export const kPatience = { timeout: 30000 };
export const file = (name) => join(folder, name);
export const started = [];
let browser;
export let page;
let isPlain = false;  // the page: `open` opened it
export const requests = [];
export const complaints = [];

/** Starts the program and answers the address it prints. */
export function serve(...args) {
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

async function visit(address) {
  await page.goto(address);
  await page.waitForSelector("body[data-ready]", kPatience);
}

/** In the page: at most ten pictures a second, since a processor draws them. */
function drawRarely() {
  const soon = window.requestAnimationFrame.bind(window);
  const cancelled = new Set();
  window.requestAnimationFrame = (draw) => {
    const id = setTimeout(() => soon((now) => cancelled.delete(id) || draw(now)), 80);
    return id;
  };
  window.cancelAnimationFrame = (id) => cancelled.add(id);
}

/** Opens `address` in a tab of its own, which runs `script` before the page's. */
export async function openNew(address, options = {}, script) {
  await page?.context().close();
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light", ...options });
  page = await context.newPage();
  isPlain = false;
  await page.addInitScript(`(${drawRarely})();`);
  if (script) await page.addInitScript(script);
  page.on("request", (request) => requests.push(request.url()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await visit(address);
}

/** Opens `address` in one tab for all, since a new one takes a second, with half as many pixels a side, since a processor draws them. */
export async function open(address) {
  if (isPlain) {
    await page.goto("about:blank");  // an address that differs by its hash only would load nothing
    await visit(address);
  } else {
    await openNew(address, { deviceScaleFactor: 0.5 });
    isPlain = true;
  }
}

export const scanned = () => page.waitForSelector('body[data-scanned="1"]', kPatience);
export const tick = async () => Number(await page.getAttribute("body", "data-tick"));
export const atTick = (wanted) => page.waitForSelector(`body[data-tick="${wanted}"]`, kPatience);
/** What `read` answers once that stays the same for a second, however slow the page is. */
export async function settled(read) {
  for (let before; ; await page.waitForTimeout(1000)) {
    const now = await read();
    if (now === before) return now;
    before = now;
  }
}
export const details = () => page.locator("#details").innerText();
export const shot = (name) => page.screenshot({ path: file(`${name}.png`) });
export const message = () => page.locator("#message").innerText();

/** What the pointer is told all over the scene: the page's own answers to moves made in it, hundreds of which would take a driver seconds. */
export async function tips() {
  return page.locator("#canvas").evaluate((canvas) => {
    const box = canvas.getBoundingClientRect();
    const tip = document.getElementById("tip");
    const found = new Set();
    for (let y = 0.1; y < 0.95; y += 0.06) {
      for (let x = 0.1; x < 0.95; x += 0.05) {
        const place = { clientX: box.x + x * box.width, clientY: box.y + y * box.height };
        canvas.dispatchEvent(new PointerEvent("pointermove", { ...place, bubbles: true }));
        if (!tip.hidden) found.add(tip.innerText);
      }
    }
    return [...found];
  });
}

/** In the page, before its own scripts: `ask` asks its worker as the page does; requests of the type `heldBack` wait for `letThrough`. */
function install() {
  const waiting = new Map();
  const kept = [];
  let next = 1e9;
  window.heldBack = "";
  window.Worker = class extends Worker {
    constructor(...given) {
      super(...given);
      this.addEventListener("message", ({ data }) => waiting.get(data.id)?.(data));
      window.ask = (request) => new Promise((answered) => {
        waiting.set(next, answered);
        super.postMessage({ id: next++, request });
      });
      window.letThrough = () => kept.splice(0).forEach((message) => super.postMessage(message));
    }
    postMessage(message, ...rest) {
      if (message.request.type === window.heldBack) kept.push(message);
      else super.postMessage(message, ...rest);
    }
  };
}
export const workerWatch = `(${install})();`;

before(async () => {
  browser = await chromium.launch({ executablePath: chromiumPath, args: ["--no-sandbox"] });
});

after(async () => {
  await browser?.close();
  for (const child of started) child.kill("SIGTERM");
});
