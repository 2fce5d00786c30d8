// The page: draws what is shown, follows the link it was opened by, and begins.
import "./commands";
import { showDetails, tickRows } from "./details";
import { enterLab, follow, touch } from "./feeling";
import { drawLegend } from "./legend";
import { readLink, writeLink, type Link } from "./link";
import { open } from "./opening";
import { element, first, last, marks, rate, state, strip, toldOf, view } from "./page";
import { advance, seek } from "./playing";
import "./pointer";
import { scales } from "./scales";
import { drawTimeline } from "./timeline";
import { timeText } from "./words";

function skinsText(): string {
  if (state.sides.length < 2 || state.beside) return "";
  const [one, two] = state.sides[0].opened.sides;
  return state.together ? `orange the ${one} hand, blue the ${two} one` : "orange the first, blue the second, grey both";
}

function drawTick() {
  const side = state.sides[0];
  if (!side) return;
  const time = `${timeText(state.tick / rate())} of ${timeText(last() / rate())}   tick ${state.tick}`;
  element("time").textContent = time;
  for (const [name, value] of Object.entries({ min: first(), max: last(), now: state.tick, text: time })) strip.setAttribute(`aria-value${name}`, String(value));
  const details = element("details");
  const pick = state.pick;
  const place = state.together ? pick?.place ?? 0 : Math.max(0, state.sides.findIndex(({ frame }) => frame));  // of two recordings the first that has the tick
  const { frame, missing, world, milliseconds, opened } = state.sides[place] ?? side;
  if (frame) {
    const rows = tickRows(frame, milliseconds, world, opened, state.live);
    if (state.together) rows.unshift(["hand", opened.sides[place]]);
    else if (state.sides.length > 1) rows.push(["compared", state.compared]);
    if (place > 0 && !state.together) rows.unshift(["recording", `${opened.name}: the first has no such tick`]);
    if (view.hasOtherObjects(1) && state.sides.length > 1) rows.push(["the second", "has other objects: these and contacts with them are not drawn"]);
    showDetails(details, pick, pick ? toldOf(pick) : [], rows);
  } else {
    details.textContent = missing ? `Tick ${state.tick} is missing in the file.` : "";
  }
  drawLegend(element("legend"), state.most.pressure, scales(), skinsText());
  state.plots?.setTime(state.tick / rate());
}

let before = performance.now();
function loop(now: number, frame?: XRFrame) {
  if (state.lab) void touch(state.lab, frame);
  else if (state.running) void follow();
  if (state.playing) advance(Math.min(0.1, (now - before) / 1000));
  before = now;
  if (state.dirty || view.inHeadset()) {
    state.dirty = false;
    view.draw();
    drawTimeline(strip, {
      first: first(), last: last(), now: state.tick, from: state.from, to: state.to,
      columns: state.sides[0]?.whole, marks: marks(),
    });
    if (state.told !== state.tick) drawTick();
    state.told = state.tick;
    document.body.dataset.tick = String(state.tick);
  }
}

const link = () => writeLink({
  recordings: state.sides.map((side) => side.link).filter(Boolean),
  tick: state.live ? undefined : state.tick,
  camera: [...view.camera.position.toArray(), ...view.controls.target.toArray()],
});
/** No link leads to a file from disk, or to the lab. */
const hasLink = () => !state.lab && state.sides.every((side, place) => side.link || (state.together && place === 1));
setInterval(() => {
  if (state.sides.length === 0 || (state.live && !state.lab)) return;
  const to = hasLink() ? link() : "";
  if (location.hash !== to) history.replaceState(null, "", to || location.pathname + location.search);
}, 500);

/** False: the first of what a link names can't be opened, so that nothing of it is shown. */
async function openNamed({ live, recordings }: Link): Promise<boolean> {
  if (live && !(await open(0, { live: new URL(live, location.href).href }, live))) return false;
  for (const [place, url] of recordings.entries()) {
    const whole = new URL(url.split("/").map(encodeURIComponent).join("/"), location.href).href;
    if (!(await open(place, { url: whole }, url))) return place > 0;
  }
  return true;
}

async function openLink(hash: string) {
  const given = readLink(hash);
  if (await openNamed(given)) goWhere(given);
  document.body.dataset.ready = "true";
}

function goWhere(given: Link) {
  if (given.camera && state.sides.length > 0) {
    view.camera.position.fromArray(given.camera);
    view.controls.target.fromArray(given.camera, 3);
    view.controls.update();
    state.unframed = false;
  } else if (!state.live) {
    state.unframed = true;
  }
  seek(given.tick ?? state.wanted);
}

document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
document.body.classList.add("empty");
view.animate(loop);
addEventListener("hashchange", ({ newURL }) => void openLink(new URL(newURL).hash));
await openLink(location.hash);
if (state.sides.length === 0 && element("message").hidden) enterLab();
