// The worker behind the page: it reads recordings and replays them, so that the page stays smooth. Which recording is meant is
// told by its place: 0, or 1 for the one it is compared with.
import { bytesOfFile, bytesOfUrl } from "./bytes";
import { findDivergence, type Divergence } from "./difference";
import { loadEngine, type Engine, type LabOptions } from "./engine";
import { openLive, type Live } from "./live";
import { toMcap, type Felt } from "./save";
import { openRecording, type Recording } from "./recording";
import { makeReplay } from "./replay";
import { readWindow, scan, type Columns, type Mark } from "./series";

/** `hand`: of a recording of two, which one; the first. */
export type Source = (({ url: string } | { file: File }) & { hand?: number }) | { live: string } | { lab: LabOptions };

export interface Opened {
  name: string;
  sides: string[];  // of the hands there are; none: the lab's
  bytes: bigint;
  session: Uint8Array;
  rate: number;
  first: number;
  last: number;
  metadata: ReadonlyMap<string, string>;
  noContacts: string;  // why there are none; empty: there are
}

export interface Shown {
  tick: number;
  message: Uint8Array;
  view?: Uint8Array;  // a TickView
  milliseconds: number;
  microseconds?: number;  // that the tick alone took here, where the message can't know
}

export type Request =
  | { type: "load"; wasm: ArrayBuffer }
  | { type: "open"; place: number; source: Source }
  | { type: "show"; place: number; tick: number }
  | { type: "window"; place: number; first: number; last: number }
  | { type: "touch"; hand: Float64Array; joints?: string }
  | { type: "newest" }
  | { type: "save" }
  | { type: "diverge" };
export type Answer =
  | { type: "error"; id: number; text: string }
  | { type: "opened"; id: number; opened: Opened }
  | { type: "shown"; id: number; shown?: Shown }
  | { type: "window"; id: number; columns: Columns }
  | { type: "diverged"; id: number; divergence?: Divergence }
  | { type: "saved"; id: number; file: Blob }
  | { type: "loaded"; id: number }
  | { type: "newest"; id: number; hands: (Shown | undefined)[] }
  | { type: "scanned"; place: number; columns: Columns; marks: Mark[]; share: number };

interface Place {
  recording: Recording;
  show?: ReturnType<typeof makeReplay>;
}

let wasm: ArrayBuffer;
const kBeforeScan = 200;  // [ms] the first tick comes first
const places: (Place | undefined)[] = [];
const tell = (answer: Answer) => postMessage(answer);
let live: Live | undefined;

// The lab's, whose ticks are kept for saving, ten minutes of them.
let lab: (Felt & { engine: Engine }) | undefined;
const kMostFelt = 36000;

async function openLab(options: LabOptions): Promise<Opened> {
  const engine = await loadEngine(wasm);
  const session = engine.makeSession(options);
  engine.open(session, new Uint8Array());
  engine.begin(0, true);
  lab = { engine, session, schema: engine.schema(), rate: options.rate, messages: [] };
  return { name: "lab", sides: [], bytes: 0n, session, rate: options.rate, first: 0, last: 0, metadata: new Map(), noContacts: "" };
}

function touch(hand: Float64Array, joints?: string): Shown {
  const start = performance.now();
  const { message, view, microseconds } = lab!.engine.touch(hand, joints);
  if (lab!.messages.length < kMostFelt) lab!.messages.push(message);
  return { tick: lab!.messages.length - 1, message, view, microseconds, milliseconds: performance.now() - start };
}

async function open(place: number, source: Source): Promise<Opened> {
  if ("lab" in source) return openLab(source.lab);
  if ("live" in source) {
    live = await openLive(source.live, () => loadEngine(wasm));
    return live.opened;
  }
  const bytes = "url" in source ? await bytesOfUrl(source.url) : bytesOfFile(source.file, source.file.name);
  const recording = await openRecording(bytes, source.hand);
  const opened: Place = { recording };
  let noContacts = "";
  try {
    const engine = await loadEngine(wasm);
    engine.open(recording.session, recording.state, recording.hand);
    opened.show = makeReplay(engine, recording);
  } catch (error) {
    noContacts = (error as Error).message;
  }
  places[place] = opened;
  const overview = () => scan(recording, (columns, marks, share) => {
    if (places[place] === opened) tell({ type: "scanned", place, columns, marks, share });
  }, (text) => tell({ type: "error", id: -1, text }));
  setTimeout(overview, kBeforeScan);
  const { name, sides, bytes: size, session, rate, first, last, metadata } = recording;
  return { name, sides, bytes: size, session, rate, first, last, metadata, noContacts };
}

async function show(place: number, tick: number): Promise<Shown | undefined> {
  const { recording, show } = places[place]!;
  const start = performance.now();
  if (show === undefined) {
    const message = (await recording.chunk(recording.chunkOf(tick))).get(tick);
    return message && { tick, message: message.slice(), milliseconds: performance.now() - start };
  }
  const shown = await show(tick);
  return shown && { tick, message: shown.bytes.slice(), view: shown.view, milliseconds: performance.now() - start };
}

async function answer(id: number, request: Request): Promise<Answer> {
  switch (request.type) {
    case "load":
      wasm = request.wasm;
      return { type: "loaded", id };
    case "open":
      return { type: "opened", id, opened: await open(request.place, request.source) };
    case "show":
      return { type: "shown", id, shown: await show(request.place, request.tick) };
    case "window":
      return { type: "window", id, columns: await readWindow(places[request.place]!.recording, request.first, request.last) };
    case "touch":
      return { type: "shown", id, shown: touch(request.hand, request.joints) };
    case "newest":
      return { type: "newest", id, hands: live!.newest() };
    case "save":
      return { type: "saved", id, file: await toMcap(lab!) };
    case "diverge":
      return { type: "diverged", id, divergence: await findDivergence(places[0]!.recording, places[1]!.recording) };
  }
}

// Ticks of one engine come one after the other; everything else may overlap.
const turns = new Map<string, Promise<unknown>>();

onmessage = ({ data: { id, request } }: MessageEvent<{ id: number; request: Request }>) => {
  const line = request.type === "show" ? `show ${request.place}` : request.type;
  const run = () => answer(id, request).catch((error: Error): Answer => ({ type: "error", id, text: error.message }));
  const turn = (turns.get(line) ?? Promise.resolve()).then(run).then(tell);
  turns.set(line, turn);
};
