// The page: what is open, what tick it shows, and what happens on a click or key.
import { startClient } from "./client";
import { showDetails, tickRows, tipText } from "./details";
import type { Divergence } from "./difference";
import { readFrame, readWorld, type Frame, type World } from "./frame";
import { fillHelp, listenToKeys, type Command } from "./keys";
import { isForLab, makeLab, type Lab } from "./lab";
import { drawLegend, niceAbove } from "./legend";
import { readLink, writeLink } from "./link";
import { makePlots, type Plots } from "./plots";
import { pressureOf } from "./pressure";
import { makeView, placeOf, type Pick } from "./scene";
import { kForce, kTorque, makeColumns, pushRow, type Columns, type Mark } from "./series";
import { drawTimeline, kMarks } from "./timeline";
import { kSegmentCount, timeText } from "./words";
import type { Opened, Shown, Source } from "./worker";

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const canvas = element<HTMLCanvasElement>("canvas");
const strip = element<HTMLCanvasElement>("timeline");
const kSpeeds = [0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 4];
const kMostWindow = 6000;  // ticks that plots show one by one

interface Side {
  opened: Opened;
  link: string;  // empty: a file from disk
  frame?: Frame;
  whole?: Columns;
  marks: Mark[];
  milliseconds: number;
}

const state = {
  sides: [] as Side[],
  world: undefined as World | undefined,
  tick: 0,
  wanted: 0,  // what is asked for next, with fractions while playing
  playing: false,
  looping: false,
  speed: 1,
  from: 0,  // ticks that the plots show
  to: 1,
  beside: false,
  plotted: 0,  // of two hands, the one in the plots
  together: false,  // the two sides are two hands of one recording, not two recordings
  live: false,  // ticks come by themselves: from a session that runs, or from the lab
  lab: undefined as Lab | undefined,
  pick: undefined as Pick | undefined,
  most: { force: 1, torque: 0.1, pressure: 1000 },  // seen so far [N], [N m], [Pa]; what is drawn to scale keeps within it
  divergence: undefined as Divergence | undefined,
};
let plots: Plots | undefined;
let dirty = true;
const redraw = () => { dirty = true; };
const view = makeView(canvas, redraw);
const client = await startClient();

// ---- Messages ------------------------------------------------------------------------------------------------------

function say(text: string, lasts = false) {
  const message = element("message");
  message.textContent = text;
  message.hidden = text === "";
  if (!lasts && text) setTimeout(() => { if (message.textContent === text) message.hidden = true; }, 6000);
}
client.onError = (text) => say(text, true);

// ---- Opening -------------------------------------------------------------------------------------------------------

/** False: what is wrong was told. */
async function open(place: number, source: Source, link: string): Promise<boolean> {
  say("");
  try {
    const opened = await client.open(place, source);
    if (place === 0) state.sides = [];
    state.sides[place] = { opened, link, marks: [], milliseconds: 0 };
    state.live = "live" in source || "lab" in source;
    document.body.classList.toggle("live", state.live);
    if (!("lab" in source)) leaveLab();
    together(false);
    if (place === 0) beginWith(opened);
    else await compareWith();
    if (place === 0 && opened.sides.length > 1) await openSecondHand(source, opened);
    document.body.classList.remove("empty");
    element("name").textContent = state.together ? opened.name : state.sides.map((side) => side.opened.name).join("  and  ");
    element("beside").hidden = state.sides.length < 2;
    if (!state.live) await show(state.wanted);
    return true;
  } catch (error) {
    say((error as Error).message, true);
    return false;
  }
}

async function openFiles(files: File[]) {
  for (const [place, file] of files.entries()) await open(place, { file }, "");
}

function together(hands: boolean) {
  state.together = hands;
  state.plotted = 0;
  view.setTogether(hands);
}

/** Of a session of two hands the other one stands where a second recording would. */
async function openSecondHand(source: Source, one: Opened) {
  const opened = "live" in source ? { ...one } : await client.open(1, { ...source, hand: 1 } as Source);
  state.sides[1] = { opened, link: "", marks: [], milliseconds: 0 };
  together(true);
}

function beginWith(opened: Opened) {
  state.world = readWorld(opened.session);
  state.divergence = undefined;
  state.pick = undefined;
  view.setWorld(state.world);
  view.setFrame(1, undefined, scales(), 1);
  state.most = { force: 1, torque: 0.1, pressure: 1000 };
  view.frameAll();
  state.tick = state.wanted = opened.first;
  plots = makePlots(element("plots"), opened.rate, (from, to) => setRange(from * opened.rate, to * opened.rate), (time) => seek(time * opened.rate));
  setRange(opened.first, opened.last);
}

async function compareWith() {
  state.divergence = await client.diverge();
  const found = state.divergence;
  if (!found) return say("The two recordings are the same to the last bit.");
  state.sides[0].marks.push({ tick: found.tick, kind: "divergence", text: divergenceText(found) });
  say(divergenceText(found));
  seek(found.tick);
}

function divergenceText({ tick, stage, field, a, b }: Divergence): string {
  return `They part at tick ${tick}, stage "${stage}", ${field}${a || b ? `: ${a} and ${b}` : ""}`;
}

client.onScanned = (place, columns, marks, share) => {
  const side = state.sides[place];
  if (!side) return;
  side.whole = columns;
  side.marks = [...marks, ...side.marks.filter((mark) => mark.kind === "divergence")].sort((a, b) => a.tick - b.tick);
  notice("force", ...whole(columns, kForce));
  notice("torque", ...whole(columns, kTorque).map((value) => 1e-3 * value));
  if (share === 1 || !showsWindow()) fillPlots();
  document.body.dataset.scanned = String(share);
  redraw();
};

/** The largest of every segment but the palm, whose joint, the wrist, carries all and has no arc. */
function whole(columns: Columns, first: number): number[] {
  return columns.values.slice(first, first + kSegmentCount - 1).map((column) => column.reduce((most, value) => (value > most ? value : most), 0));
}

function notice(what: keyof typeof state.most, ...values: number[]) {
  const most = niceAbove(Math.max(...values, state.most[what]));
  if (most === state.most[what]) return;
  state.most[what] = most;
  for (const place of state.sides.keys()) setFrame(place);
}

/** Arrows no longer than 60 mm, arcs no wider than three quarters of a turn. */
const scales = () => ({ force: 0.06 / state.most.force, torque: (1.5 * Math.PI) / state.most.torque });

function setFrame(place: number) {
  view.setFrame(place, state.sides[place].frame, scales(), state.most.pressure);
  drawn = NaN;
  redraw();
}

// ---- Time ----------------------------------------------------------------------------------------------------------

let asking = false;

/** Shows the newest tick asked for; those that come too fast are passed over. */
async function show(tick: number) {
  state.wanted = tick;
  if (asking) return;
  asking = true;
  try {
    for (let shown = NaN; shown !== Math.floor(state.wanted); ) {
      shown = Math.floor(state.wanted);
      const ticks = await Promise.all(state.sides.map((_, place) => client.show(place, shown)));
      ticks.forEach((one, place) => take(place, one, shown));
    }
  } catch (error) {
    state.playing = false;
    say((error as Error).message, true);
  } finally {
    asking = false;
  }
}

function take(place: number, shown: Shown | undefined, tick: number) {
  const side = state.sides[place];
  if (!side || !state.world) return;
  state.tick = tick;
  side.frame = shown && readFrame(shown);
  side.milliseconds = shown?.milliseconds ?? 0;
  const { forces, jointTorques, contacts } = side.frame ?? { forces: [], jointTorques: [], contacts: [] };
  notice("force", ...forces.slice(0, kSegmentCount - 1).map((force) => force.length()));
  notice("torque", ...jointTorques.slice(0, kSegmentCount - 1).map((torque) => torque.length()));
  notice("pressure", ...contacts.map((contact) => pressureOf(contact, state.world!)));
  setFrame(place);
}

const rate = () => state.sides[0]?.opened.rate ?? 1000;
const first = () => state.sides[0]?.opened.first ?? 0;
const last = () => state.sides[0]?.opened.last ?? 0;

function seek(tick: number) {
  if (state.live || state.sides.length === 0) return;
  void show(Math.round(Math.min(Math.max(tick, first()), last())));
}

function setPlaying(playing: boolean) {
  if (state.live || state.sides.length === 0) return;
  state.playing = playing;
  if (playing && state.wanted >= last()) state.wanted = first();
  element("play").textContent = playing ? "❚❚ Pause" : "▶ Play";
}

function advance(seconds: number) {
  const [begin, end] = state.looping ? [state.from, state.to] : [first(), last()];
  let next = state.wanted + seconds * state.speed * rate();
  if (state.looping && (next > end || next < begin)) next = begin;
  if (next >= end && !state.looping) {
    next = end;
    setPlaying(false);
  }
  void show(next);
}

const marks = () => state.sides.flatMap((side) => side.marks);

function jump(direction: 1 | -1) {
  const ahead = marks().filter((mark) => (mark.tick - state.tick) * direction > 0);
  const to = ahead.sort((a, b) => (a.tick - b.tick) * direction)[0];
  if (!to) return say("No further mark.");
  seek(to.tick);
  say(`${kMarks[to.kind].sign} tick ${to.tick}: ${to.text}`);
}

// ---- Plots ---------------------------------------------------------------------------------------------------------

const showsWindow = () => state.to - state.from <= kMostWindow;
let windowed = 0;

function setRange(from: number, to: number) {
  state.from = Math.max(first(), Math.floor(from));
  state.to = Math.min(last(), Math.ceil(Math.max(to, from + 10)));
  plots?.setRange(state.from / rate(), state.to / rate());
  document.body.dataset.range = `${state.from} ${state.to}`;
  fillPlots();
  redraw();
}

async function fillPlots() {
  if (state.live) return;
  const turn = ++windowed;
  let columns = state.sides.map((side) => side.whole);
  if (showsWindow()) columns = await Promise.all(state.sides.map((_, place) => client.window(place, state.from, state.to)));
  if (turn === windowed && columns[0]) plotColumns(columns);
}

/** Of two hands that which was picked last; of two recordings both, for their difference. */
function plotColumns(columns: (Columns | undefined)[]) {
  if (state.together) plots?.setData(columns[state.plotted] ?? columns[0]!, undefined);
  else plots?.setData(columns[0]!, columns[1]);
}

// ---- Live ----------------------------------------------------------------------------------------------------------

const kLiveKept = 1200;  // ticks, twenty seconds of what comes
let plotted = 0;

client.onLive = (hand, shown, error) => {
  if (error) say(error, true);
  const side = state.sides[hand];
  if (!shown || !side || !state.live) return;
  take(hand, shown, shown.tick);
  side.whole ??= makeColumns(kLiveKept);
  pushRow(side.whole, shown, rate());
  const [oldest, newest] = [side.whole.tick.find((tick) => tick > 0) ?? 0, shown.tick];
  [side.opened.first, side.opened.last] = [oldest, newest];
  if (hand !== state.plotted || performance.now() - plotted < 250) return;
  plotted = performance.now();
  setRange(oldest, newest);
  plots?.setData(side.whole, undefined);
};

// ---- The lab -------------------------------------------------------------------------------------------------------

function enterLab() {
  element("lab").hidden = false;
  state.lab = makeLab(element("lab"), {
    begin: (options) => open(0, { lab: options }, ""),
    save: () => void saveFelt(),
    enter: (tracking) => view.enter(tracking),
    say: (text) => say(text, true),
  });
  state.lab.position.set(-0.02, -0.115, 0.14);
}

function leaveLab() {
  element("lab").hidden = true;
  state.lab?.leave();
  state.lab = undefined;
}

async function saveFelt() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await client.save());
  link.download = "felt.mcap";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

let touching = false;

/** A tick for every picture. */
async function touch(lab: Lab, frame?: XRFrame) {
  if (touching || state.sides[0]?.opened.name !== "lab") return;
  const joints = lab.tracked(frame);
  if (joints === "") return;
  touching = true;
  try {
    const shown = await client.touch(lab.hand(), joints);
    if (state.lab === lab) client.onLive(0, shown, undefined);
  } catch (error) {
    leaveLab();
    say((error as Error).message, true);
  } finally {
    touching = false;
  }
}

// ---- Drawing -------------------------------------------------------------------------------------------------------

let drawn = NaN;

function skinsText(): string {
  if (state.sides.length < 2 || state.beside) return "";
  const [one, two] = state.sides[0].opened.sides;
  return state.together ? `orange the ${one} hand, blue the ${two} one` : "orange the first, blue the second, grey both";
}

function drawTick() {
  const side = state.sides[0];
  if (!side || !state.world) return;
  element("time").textContent = `${timeText(state.tick / rate())} of ${timeText(last() / rate())}   tick ${state.tick}`;
  strip.setAttribute("aria-valuenow", String(state.tick));
  const details = element("details");
  if (side.frame) {
    const pick = state.pick;
    const place = placeOf(pick) ?? 0;
    const at = state.sides[place] ?? side;
    const told = state.together ? at : side;  // of two recordings the first
    const rows = tickRows(told.frame ?? side.frame, told.milliseconds, state.world, side.opened.noContacts, state.live);
    if (state.together) rows.unshift(["hand", side.opened.sides[place]]);
    else if (state.divergence) rows.push(["compared", divergenceText(state.divergence)]);
    else if (state.sides.length > 1) rows.push(["compared", "the same to the last bit"]);
    showDetails(details, pick, at.frame ?? side.frame, state.world, rows);
  } else {
    details.textContent = `Tick ${state.tick} is missing in the file.`;
  }
  drawLegend(element("legend"), state.most.pressure, scales(), skinsText());
  plots?.setTime(state.tick / rate());
}

let before = performance.now();
function loop(now: number, frame?: XRFrame) {
  if (state.lab) void touch(state.lab, frame);
  if (state.playing) advance(Math.min(0.1, (now - before) / 1000));
  before = now;
  if (dirty || view.inHeadset()) {
    dirty = false;
    view.draw();
    drawTimeline(strip, {
      first: first(), last: last(), now: state.tick, from: state.from, to: state.to,
      columns: state.sides[0]?.whole, marks: marks(),
    });
    if (drawn !== state.tick) drawTick();
    drawn = state.tick;
    document.body.dataset.tick = String(state.tick);
  }
}

// ---- Pointer -------------------------------------------------------------------------------------------------------

function pickAt(event: PointerEvent): Pick | undefined {
  const box = canvas.getBoundingClientRect();
  return view.pick((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
}

let pressed = { x: 0, y: 0 };
let held: PointerEvent | undefined;  // the lab's hand, by it
canvas.addEventListener("pointerdown", (event) => {
  pressed = { x: event.clientX, y: event.clientY };
  const pick = state.lab && event.isPrimary ? pickAt(event) : undefined;
  held = placeOf(pick) !== undefined ? event : undefined;
  view.controls.enabled = held === undefined;
}, true);
addEventListener("pointerup", () => {
  held = undefined;
  view.controls.enabled = true;
});
canvas.addEventListener("pointermove", (event) => {
  if (!held || !state.lab) return;
  view.drag(state.lab.position, event.clientX - held.clientX, event.clientY - held.clientY);
  held = event;
});
canvas.addEventListener("pointerup", (event) => {
  if (Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > 4) return;
  state.pick = pickAt(event);
  view.select(state.pick);
  const plotted = placeOf(state.pick) ?? state.plotted;
  if (plotted !== state.plotted) {
    state.plotted = plotted;
    void fillPlots();
  }
  drawn = NaN;
  redraw();
});
canvas.addEventListener("pointermove", (event) => {
  const tip = element("tip");
  const pick = event.buttons === 0 ? pickAt(event) : undefined;
  const frame = pick && state.sides[placeOf(pick) ?? 0]?.frame;
  tip.textContent = pick && frame && state.world ? tipText(pick, frame, state.world) : "";
  tip.hidden = tip.textContent === "";
  const box = canvas.getBoundingClientRect();
  tip.style.left = `${Math.min(event.clientX - box.left + 14, box.width - 200)}px`;
  tip.style.top = `${event.clientY - box.top + 14}px`;
});
canvas.addEventListener("pointerleave", () => { element("tip").hidden = true; });

const seekAt = (event: PointerEvent) => {
  const box = strip.getBoundingClientRect();
  seek(first() + ((event.clientX - box.left) / box.width) * (last() - first()));
};
strip.addEventListener("pointerdown", (event) => { strip.setPointerCapture(event.pointerId); seekAt(event); });
strip.addEventListener("pointermove", (event) => { if (event.buttons) seekAt(event); });

for (const [id, place] of [["open", 0], ["open-other", 1]] as const) {
  const input = element<HTMLInputElement>(id);
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    if (file) void open(state.sides.length === 0 ? 0 : place, { file }, "");
    input.value = "";
  });
}
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("drop"); });
addEventListener("dragleave", () => document.body.classList.remove("drop"));
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("drop");
  const touched = [...(event.dataTransfer?.files ?? [])].find(isForLab);
  if (touched) {
    if (!state.lab) enterLab();
    return void state.lab?.take(touched);
  }
  void openFiles([...(event.dataTransfer?.files ?? [])].slice(0, 2));
});

// ---- Commands ------------------------------------------------------------------------------------------------------

function turn(around: number, up: number) {
  const offset = view.camera.position.clone().sub(view.controls.target);
  offset.applyAxisAngle(view.camera.up, around);
  offset.applyAxisAngle(offset.clone().cross(view.camera.up).normalize(), up);
  view.camera.position.copy(view.controls.target).add(offset);
  view.controls.update();
}

function toggleTheme() {
  const root = document.documentElement;
  root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
  plots?.setTheme();
  drawn = NaN;
  redraw();
}

function toggleLoop() {
  state.looping = !state.looping;
  element("loop").setAttribute("aria-pressed", String(state.looping));
}

function toggleBeside() {
  state.beside = !state.beside;
  view.setBeside(state.beside);
  element("beside").setAttribute("aria-pressed", String(state.beside));
  drawn = NaN;
  redraw();
}

function changeSpeed(by: number) {
  state.speed = kSpeeds[Math.min(Math.max(kSpeeds.indexOf(state.speed) + by, 0), kSpeeds.length - 1)];
  element<HTMLSelectElement>("speed").value = String(state.speed);
}

const step = (direction: number) => (event: KeyboardEvent) => seek(state.tick + direction * (event.shiftKey ? 100 : 1));
const help = element<HTMLDialogElement>("help");
const commands: Command[] = [
  { keys: [" "], text: "play or pause", run: () => setPlaying(!state.playing) },
  { keys: ["ArrowLeft"], text: "one tick back; with shift a hundred", run: step(-1) },
  { keys: ["ArrowRight"], text: "one tick on; with shift a hundred", run: step(1) },
  { keys: ["Home"], text: "to the start", run: () => seek(first()) },
  { keys: ["End"], text: "to the end", run: () => seek(last()) },
  { keys: ["["], text: "the mark before", run: () => jump(-1) },
  { keys: ["]"], text: "the next mark", run: () => jump(1) },
  { keys: ["-"], text: "slower", run: () => changeSpeed(-1) },
  { keys: ["+", "="], text: "faster", run: () => changeSpeed(1) },
  { keys: ["l"], text: "play what the plots show again and again", run: toggleLoop },
  { keys: ["Escape"], text: "plots show everything again, nothing is selected", run: () => { state.pick = undefined; view.select(undefined); setRange(first(), last()); drawn = NaN; redraw(); } },
  { keys: ["a"], text: "camera to the left", run: () => turn(-0.1, 0) },
  { keys: ["d"], text: "camera to the right", run: () => turn(0.1, 0) },
  { keys: ["w"], text: "camera up", run: () => turn(0, -0.1) },
  { keys: ["s"], text: "camera down", run: () => turn(0, 0.1) },
  { keys: ["f"], text: "camera to where it began", run: () => view.frameAll() },
  { keys: ["c"], text: "two recordings side by side, or one over the other", run: toggleBeside },
  { keys: ["o"], text: "open a recording", run: () => element("open").click() },
  { keys: ["t"], text: "light or dark", run: toggleTheme },
  { keys: ["?"], text: "this help", run: () => (help.open ? help.close() : help.showModal()) },
];
listenToKeys(commands);
fillHelp(help, commands);
const press = (id: string, run: () => void) => element(id).addEventListener("click", run);
press("lab-button", enterLab);
press("play", () => setPlaying(!state.playing));
press("to-start", () => seek(first()));
press("back", () => seek(state.tick - 1));
press("forward", () => seek(state.tick + 1));
press("mark-back", () => jump(-1));
press("mark-forward", () => jump(1));
press("loop", toggleLoop);
press("whole", () => setRange(first(), last()));
press("theme", toggleTheme);
press("beside", toggleBeside);
press("help-button", () => help.showModal());
const speed = element<HTMLSelectElement>("speed");
speed.append(...kSpeeds.map((value) => new Option(`${value} ×`, String(value), value === 1, value === 1)));
speed.addEventListener("change", () => { state.speed = Number(speed.value); });
new ResizeObserver(redraw).observe(element("scene"));
new ResizeObserver(redraw).observe(strip);

// ---- The link ------------------------------------------------------------------------------------------------------

const link = () => writeLink({
  recordings: state.sides.map((side) => side.link).filter(Boolean),
  tick: state.live ? undefined : state.tick,
  camera: [...view.camera.position.toArray(), ...view.controls.target.toArray()],
});
setInterval(() => {
  if (state.sides.length === 0 || state.sides.some((side, place) => !side.link && !(state.together && place === 1)) || state.live) return;
  if (location.hash !== link()) history.replaceState(null, "", link());
}, 500);

async function openLink() {
  const given = readLink(location.hash);
  if (given.live) await open(0, { live: new URL(given.live, location.href).href }, given.live);
  for (const [place, url] of given.recordings.entries()) {
    await open(place, { url: new URL(url.split("/").map(encodeURIComponent).join("/"), location.href).href }, url);
    if (state.sides.length <= place) break;
  }
  if (given.camera && state.sides.length > 0) {
    view.camera.position.fromArray(given.camera);
    view.controls.target.fromArray(given.camera, 3);
    view.controls.update();
  }
  if (given.tick !== undefined) seek(given.tick);
  document.body.dataset.ready = "true";
}

document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
document.body.classList.add("empty");
view.animate(loop);
await openLink();
if (state.sides.length === 0 && element("message").hidden) enterLab();
