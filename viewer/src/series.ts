// Numbers of ticks as columns, for plots and marks: exact for a stretch, or the largest of many ticks each for a whole session.
import { ByteBuffer } from "flatbuffers";
import { countOf, kTableSize } from "./counts";
import { Tick } from "../generated/lumbrical/fb/tick";
import { SegmentOutput } from "../generated/lumbrical/fb/segment-output";
import { Vec3 } from "../generated/lumbrical/fb/vec3";
import { Sent } from "../generated/lumbrical/fb/sent";
import type { Chunk, Recording } from "./recording";
import { kDeviceStates, kDisconnected, kFault, kSegmentCount, kTickFlags } from "./words";

// Columns: force of each segment [N], torque at each segment's joint [N mm], then these.
export const kForce = 0;
export const kTorque = kSegmentCount;
export const kContacts = 2 * kSegmentCount;
export const kDuration = kContacts + 1;  // [us]
export const kDeviceState = kContacts + 2;
export const kDifference = kContacts + 3;  // of each segment's force [N] from that of the recording it is compared with
export const kColumnCount = kDifference + kSegmentCount;

export interface Columns {
  tick: Float64Array;
  values: Float32Array[];  // of every column, NaN: not known
}

export type MarkKind = "flag" | "fault" | "deadline" | "gap" | "divergence";
export interface Mark {
  tick: number;
  kind: MarkKind;
  text: string;
}

export function makeColumns(length: number): Columns {
  const column = () => new Float32Array(length).fill(NaN);
  return { tick: new Float64Array(length), values: Array.from({ length: kColumnCount }, column) };
}

const norm = (v: Vec3 | null) => (v ? Math.hypot(v.x(), v.y(), v.z()) : 0);
const segment = new SegmentOutput();
const vector = new Vec3();

const segmentsOf = (tick: Tick) => countOf(tick.segmentsLength(), SegmentOutput.sizeOf(), tick);

/** [N] three numbers for each segment; NaN: the file leaves them out. */
function forcesOf(tick: Tick): Float64Array {
  const forces = new Float64Array(3 * kSegmentCount).fill(tick.forcesLeftOut() ? NaN : 0);
  for (let i = 0, count = segmentsOf(tick); i < count; ++i) {
    tick.segments(i, segment);
    const force = segment.force(vector)!;
    if (segment.segment() < kSegmentCount) forces.set([force.x(), force.y(), force.z()], 3 * segment.segment());
  }
  return forces;
}

function readDifferences(tick: Tick, other: Uint8Array, row: Float32Array) {
  const [own, its] = [forcesOf(tick), forcesOf(Tick.getRootAsTick(new ByteBuffer(other)))];
  for (let s = 0, i = 0; s < kSegmentCount; ++s, i += 3)
    row[kDifference + s] = Math.hypot(own[i] - its[i], own[i + 1] - its[i + 1], own[i + 2] - its[i + 2]);
}

/** What a tick tells beside its numbers in columns. */
export interface Circumstances {
  flags: number;
  late: boolean;
  state: number;  // of the device, NaN: none
}

/** A tick from which on a device is in a state; NaN: it is not known. */
export type StateChange = readonly [tick: number, state: number];

const stateAt = (changes: readonly StateChange[], tick: number) => changes.findLast(([from]) => from <= tick)?.[1] ?? NaN;

/** One tick's numbers into `row`; `other`: the same tick of the recording it is compared with; `state`: of the device until then,
 *  which goes on in a tick that tells of none. */
export function readRow(bytes: Uint8Array, rate: number, row: Float32Array, other?: Uint8Array, state = NaN): Circumstances {
  const tick = Tick.getRootAsTick(new ByteBuffer(bytes));
  row.fill(tick.forcesLeftOut() ? NaN : 0, 0, kContacts);
  for (let i = 0, count = segmentsOf(tick); i < count; ++i) {
    tick.segments(i, segment);
    const s = segment.segment();
    if (s >= kSegmentCount) continue;
    row[kForce + s] = norm(segment.force(vector));
    row[kTorque + s] = 1e3 * norm(segment.jointTorque(vector));
  }
  row[kContacts] = tick.contactCount();
  row[kDuration] = tick.durationNs() / 1e3;
  for (let i = 0, count = countOf(tick.sentLength(), kTableSize, tick); i < count; ++i) state = tick.sent(i, new Sent())!.state();
  row[kDeviceState] = state;
  row.fill(NaN, kDifference);
  if (other) readDifferences(tick, other, row);
  return { flags: tick.flags(), late: tick.durationNs() > 1e9 / rate, state };
}

/** The newest tick at the end, the oldest falls out. */
export function pushRow(columns: Columns, shown: { tick: number; message: Uint8Array }, rate: number) {
  const row = new Float32Array(kColumnCount);
  readRow(shown.message, rate, row, undefined, columns.values[kDeviceState].at(-1));
  for (const column of [columns.tick, ...columns.values]) column.copyWithin(0, 1);
  columns.tick[columns.tick.length - 1] = shown.tick;
  columns.values.forEach((column, k) => (column[column.length - 1] = row[k]));
}

/** A tick of the recording another one is compared with, whose own scan tells what is damaged in it. */
const messageOf = (other: Recording, tick: number) => other.message(tick).catch(() => undefined);

/** Every tick of first .. last, for plots that show single ticks; `other`: what it is compared with; `changes`: of the device's state,
 *  as far as they are known. */
export async function readWindow(recording: Recording, other: Recording | undefined, first: number, last: number, changes: readonly StateChange[]): Promise<Columns> {
  const from = Math.max(first, recording.first);
  const columns = makeColumns(Math.max(0, Math.min(last, recording.last) - from + 1));
  const row = new Float32Array(kColumnCount);
  let state = stateAt(changes, from);
  for (let i = 0; i < columns.tick.length; ++i) {
    columns.tick[i] = from + i;
    const bytes = await recording.message(from + i);
    if (bytes === undefined) {
      state = NaN;
      continue;
    }
    ({ state } = readRow(bytes, recording.rate, row, other && (await messageOf(other, from + i)), state));
    columns.values.forEach((column, k) => (column[i] = row[k]));
  }
  return columns;
}

const kBuckets = 4096;
const kMostMarks = 3000;  // of a kind, and of each flag
const kMostChanges = 100000;

/** Marks in their order, so many of each kind; the last one of a kind that has more says so. */
function makeMarks() {
  const marks: Mark[] = [];
  const ofKind = new Map<string, { count: number; last: Mark }>();
  const add = (mark: Mark) => {
    const kind = mark.kind === "flag" ? mark.text : mark.kind;
    const before = ofKind.get(kind);
    if (before && before.count >= kMostMarks) {
      if (before.count++ === kMostMarks) before.last.text += `; more of these follow, only the first ${kMostMarks} are marked`;
      return;
    }
    marks.push(mark);
    ofKind.set(kind, { count: (before?.count ?? 0) + 1, last: mark });
  };
  return { marks, add };
}

/** A fault, or that a device has gone: not that it has never been there. */
const isBad = (now: number, before: number) => now !== before && (now === kFault || (now === kDisconnected && before > kDisconnected));

/** Of many ticks' states the one that a person must not miss. */
function worst(a: number, b: number): number {
  if (Number.isNaN(a) || Number.isNaN(b)) return Number.isNaN(a) ? b : a;
  return a === kFault || b === kFault ? kFault : Math.min(a, b);
}

/** A bucket of columns takes a tick's row: the largest of each. */
function takeRow({ values }: Columns, bucket: number, row: Float32Array) {
  const state = worst(values[kDeviceState][bucket], row[kDeviceState]);
  values.forEach((column, k) => {
    if (row[k] > column[bucket] || Number.isNaN(column[bucket])) column[bucket] = row[k];
  });
  values[kDeviceState][bucket] = state;
}

export interface Listener {
  /** No more: nobody wants the rest. */
  isThere(): boolean;
  /** Called now and then, and when all is read. */
  tell(columns: Columns, marks: Mark[], share: number): void;
  /** For each chunk that can't be read. */
  damaged(text: string): void;
  /** Of the device's state, as they come. */
  changed(change: StateChange): void;
}

/** Reads the whole recording a chunk at a time; `other`: what it is compared with. */
export async function scan(recording: Recording, other: Recording | undefined, { isThere, tell, damaged, changed }: Listener) {
  const count = recording.last - recording.first + 1;
  const per = Math.max(1, Math.ceil(count / kBuckets));
  const columns = makeColumns(Math.ceil(count / per));
  for (let i = 0; i < columns.tick.length; ++i) columns.tick[i] = recording.first + i * per;
  const { marks, add } = makeMarks();
  const mark = (tick: number, kind: MarkKind, text: string) => add({ tick, kind, text });
  let state = NaN, changes = 0;
  const change = (tick: number, now: number) => {
    if (!Object.is(now, state) && changes <= kMostChanges) changed([tick, changes++ < kMostChanges ? now : NaN]);
    state = now;
  };
  const row = new Float32Array(kColumnCount);
  let before: Circumstances = { flags: 0, late: false, state: NaN };
  let next = recording.first;
  let told = performance.now();
  for (let index = 0; index < recording.chunkCount && isThere(); ++index) {
    let chunk: Chunk;
    try {
      chunk = await recording.chunk(index);
    } catch (error) {
      damaged((error as Error).message);
      continue;  // its ticks are a gap
    }
    for (const [tick, bytes] of chunk) {
      let now: Circumstances;
      if (tick !== next) change(next, NaN);  // behind a gap it is not known
      try {
        now = readRow(bytes, recording.rate, row, other && (await messageOf(other, tick)), state);
      } catch (error) {
        damaged(`${recording.name}: tick ${tick}: ${(error as Error).message}`);
        break;  // what is left of its chunk is a gap
      }
      if (tick !== next) mark(next, "gap", `${tick - next} ticks are missing`);
      next = tick + 1;
      takeRow(columns, Math.floor((tick - recording.first) / per), row);
      const risen = now.flags & ~before.flags;
      kTickFlags.forEach((name, bit) => {
        if ((risen >> bit) & 1) mark(tick, "flag", name);
      });
      if (now.late && !before.late) mark(tick, "deadline", `took ${(row[kDuration] / 1e3).toFixed(2)} ms`);
      if (isBad(now.state, state)) mark(tick, "fault", `device: ${kDeviceStates[now.state]}`);
      change(tick, now.state);
      before = now;
    }
    if (performance.now() - told > 500) {
      tell(columns, marks, (index + 1) / recording.chunkCount);
      await new Promise((resolve) => setTimeout(resolve));  // requests of the page come first
      told = performance.now();
    }
  }
  if (next <= recording.last) mark(next, "gap", `${recording.last - next + 1} ticks are missing`);
  if (isThere()) tell(columns, marks, 1);
}
