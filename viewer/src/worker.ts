// The worker behind the page: it reads recordings and replays them, so that the page stays smooth. Which recording is meant is
// told by its place: 0, or 1 for the one it is compared with.
import { bytesOfFile, bytesOfUrl, type Bytes } from "./bytes";
import { compare, type Comparison } from "./difference";
import { loadEngine, Refusal, type Engine, type LabOptions } from "./engine";
import { openLive, type Live } from "./live";
import { toMcap, type Felt } from "./save";
import { openRecording, type Recording } from "./recording";
import { makeReplay } from "./replay";
import { makeColumns, readWindow, scan, type Columns, type Mark, type StateChange } from "./series";

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
  noContacts: string;  // why there are none, but where a frame knows those with objects; empty: there are
  arithmetic?: string;  // by which it is replayed
}

export interface Shown {
  tick: number;
  message: Uint8Array;
  view?: Uint8Array;  // a TickView
  handOnly?: boolean;  // of the view no more than the hand is so
  behindGap?: boolean;  // the state before it is a guess
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
  | { type: "compare" };
export type Answer =
  | { type: "error"; id: number; text: string }
  | { type: "opened"; id: number; opened: Opened }
  | { type: "shown"; id: number; shown?: Shown }
  | { type: "window"; id: number; columns: Columns }
  | { type: "compared"; id: number; comparison: Comparison }
  | { type: "saved"; id: number; file: Blob; leftOut: number }
  | { type: "loaded"; id: number }
  | { type: "newest"; id: number; hands: (Shown | undefined)[] }
  | { type: "scanned"; place: number; columns: Columns; marks: Mark[]; share: number };

interface Place {
  bytes: Bytes;
  recording: Recording;
  other?: Recording;  // that it is compared with
  show?: ReturnType<typeof makeReplay>;
  changes: StateChange[];  // of the device, as far as it was read
}

let wasm: ArrayBuffer;
const kBeforeScan = 200;  // [ms] the first tick comes first
const places: (Place | undefined)[] = [];
const tell = (answer: Answer) => postMessage(answer);
let live: Live | undefined;

// The lab's, whose first ticks are kept for saving, ten minutes at 60 a second.
let lab: (Felt & { engine: Engine; ticks: number }) | undefined;
const kMostFelt = 36000;

/** Of what is open nothing is asked any more. */
function letGo() {
  places.length = 0;
  live?.close();
  live = lab = undefined;
}

async function openLab(options: LabOptions): Promise<Opened> {
  const engine = await loadEngine(wasm);
  const session = engine.makeSession(options);
  engine.open(session, new Uint8Array());
  engine.begin(0, true);
  letGo();
  lab = { engine, session, schema: engine.schema(), rate: options.rate, messages: [], ticks: 0 };
  return { name: "lab", sides: [], bytes: 0n, session, rate: options.rate, first: 0, last: 0, metadata: new Map(), noContacts: "" };
}

function touch(hand: Float64Array, joints?: string): Shown | undefined {
  if (!lab) return undefined;
  const start = performance.now();
  const { message, view, microseconds } = lab.engine.touch(hand, joints);
  if (lab.messages.length < kMostFelt) lab.messages.push(message);
  return { tick: lab.ticks++, message, view, microseconds, milliseconds: performance.now() - start };
}

async function open(place: number, source: Source): Promise<Opened> {
  if ("lab" in source) return openLab(source.lab);
  if ("live" in source) {
    const next = await openLive(source.live, () => loadEngine(wasm));
    letGo();
    live = next;
    return live.opened;
  }
  const bytes = "url" in source ? await bytesOfUrl(source.url) : bytesOfFile(source.file, source.file.name);
  const recording = await openRecording(bytes, source.hand);
  const isOther = place === 1 && source.hand === undefined;  // not the first one's second hand
  const opened: Place = { bytes, recording, other: isOther ? places[0]?.recording : undefined, changes: [] };
  let noContacts = "", arithmetic: string | undefined;
  try {
    const engine = await loadEngine(wasm);
    noContacts = engine.open(recording.session, recording.state, recording.hand);
    arithmetic = engine.arithmetic();
    opened.show = makeReplay(engine, recording);
  } catch (error) {
    if (error instanceof Refusal) throw new Error(`${bytes.name}: ${error.message}`);
    noContacts = (error as Error).message;
  }
  if (place === 0) letGo();
  places[place] = opened;
  const overview = () => scan(recording, opened.other, {
    isThere: () => places[place] === opened,
    tell: (columns, marks, share) => tell({ type: "scanned", place, columns, marks, share }),
    damaged: (text) => tell({ type: "error", id: -1, text }),
    changed: (change) => void opened.changes.push(change),
  });
  setTimeout(overview, kBeforeScan);
  const { name, sides, bytes: size, session, rate, first, last, metadata } = recording;
  return { name, sides, bytes: size, session, rate, first, last, metadata, noContacts, arithmetic };
}

async function show({ recording, show }: Place, tick: number): Promise<Shown | undefined> {
  const start = performance.now();
  if (show === undefined) {
    const message = await recording.message(tick);
    return message && { tick, message: message.slice(), milliseconds: performance.now() - start };
  }
  const shown = await show(tick);
  return shown && { tick, message: shown.bytes.slice(), view: shown.view, behindGap: !shown.settled, milliseconds: performance.now() - start };
}

/** Of every hand. */
const recordingsOf = ({ bytes, recording }: Place) =>
  Promise.all(recording.sides.map((_, hand) => (hand === recording.hand ? recording : openRecording(bytes, hand))));

async function compareBoth(): Promise<Comparison> {
  const [first, second] = places;
  if (!first || !second) throw new Error("no two recordings are open");
  return compare(await recordingsOf(first), await recordingsOf(second));
}

/** What the page asks of a place that was let go meanwhile has an answer without content. */
async function answer(id: number, request: Request): Promise<Answer> {
  const place = "place" in request ? places[request.place] : undefined;
  switch (request.type) {
    case "load":
      wasm = request.wasm;
      return { type: "loaded", id };
    case "open":
      return { type: "opened", id, opened: await open(request.place, request.source) };
    case "show":
      return { type: "shown", id, shown: place && (await show(place, request.tick)) };
    case "window":
      return { type: "window", id, columns: place ? await readWindow(place.recording, place.other, request.first, request.last, place.changes) : makeColumns(0) };
    case "touch":
      return { type: "shown", id, shown: touch(request.hand, request.joints) };
    case "newest":
      return { type: "newest", id, hands: live?.newest() ?? [] };
    case "save":
      return { type: "saved", id, file: await toMcap(lab!), leftOut: lab!.ticks - lab!.messages.length };
    case "compare":
      return { type: "compared", id, comparison: await compareBoth() };
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
