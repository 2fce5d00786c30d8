// Where two recordings part: the first tick, the first stage of it, and the field, as `lumbrical diff` names them.
import { ByteBuffer } from "flatbuffers";
import { countOf } from "./counts";
import { JointPose } from "../generated/lumbrical/fb/joint-pose";
import { SegmentOutput } from "../generated/lumbrical/fb/segment-output";
import { Tick } from "../generated/lumbrical/fb/tick";
import type { Recording } from "./recording";
import { kSegments } from "./words";

export interface Divergence {
  hand: string;  // of two hands, whose ticks part
  tick: number;
  stage: string;
  field: string;
  a: string;
  b: string;
}

/** What was compared of two recordings, up to where they part. */
export interface Comparison {
  hands: string[];
  ticks: number;
  missing: number;  // in both
  divergence?: Divergence;
}

const kAngleSize = 4;  // [bytes]

type Parting = Omit<Divergence, "hand">;
type Field = [name: string, value: number | bigint | string];

const xyz = (name: string, v: { x(): number; y(): number; z(): number } | null): Field[] =>
  v ? [[`${name}.x`, v.x()], [`${name}.y`, v.y()], [`${name}.z`, v.z()]] : [];

function inputFields(tick: Tick): Field[] {
  const base = tick.base();
  const q = base?.orientation();
  const fields: Field[] = [
    ...xyz("base.position", base?.position() ?? null),
    ...(q ? [["base.orientation.w", q.w()] as Field, ...xyz("base.orientation", q)] : []),
    ["kind", tick.kind()], ["flags", tick.deviceFlags()], ["valid", tick.valid()],
  ];
  for (let j = 0, count = countOf(tick.jointsLength(), JointPose.sizeOf(), tick); j < count; ++j) {
    const pose = tick.joints(j)!;
    fields.push(...xyz(`joint[${j}].position`, pose.position()), ...xyz(`joint[${j}].orientation`, pose.orientation()));
    fields.push([`joint[${j}].orientation.w`, pose.orientation()!.w()]);
  }
  for (let i = 0, count = countOf(tick.anglesLength(), kAngleSize, tick); i < count; ++i) fields.push([`angle[${i}]`, tick.angles(i)!]);
  return fields;
}

function outputFields(tick: Tick): Field[] {
  const fields: Field[] = [["flags", tick.flags()], ["contact_count", tick.contactCount()]];
  for (let i = 0, count = countOf(tick.segmentsLength(), SegmentOutput.sizeOf(), tick); i < count; ++i) {
    const s = tick.segments(i)!;
    const name = kSegments[s.segment()];
    fields.push(...xyz(`force of ${name}`, s.force()), ...xyz(`torque of ${name}`, s.torque()),
      ...xyz(`joint torque of ${name}`, s.jointTorque()), [`flexion torque of ${name}`, s.flexionTorque()]);
  }
  return fields;
}

function firstField(a: Field[], b: Field[]): Omit<Parting, "tick" | "stage"> {
  const others = new Map(b);
  for (const [name, value] of a) {
    const other = others.get(name) ?? "none";
    others.delete(name);
    if (!Object.is(value, other)) return { field: name, a: String(value), b: String(other) };
  }
  for (const [name, value] of others) return { field: name, a: "none", b: String(value) };
  return { field: "hash", a: "", b: "" };
}

const kStages = ["input", "handPose", "broadphase", "narrowphase", "contactForce", "limits"] as const;
const kStageNames = ["input", "hand pose", "broadphase", "narrowphase", "contact force", "limits"];

function partingOf(tick: number, bytesA: Uint8Array, bytesB: Uint8Array): Parting | undefined {
  const a = Tick.getRootAsTick(new ByteBuffer(bytesA));
  const b = Tick.getRootAsTick(new ByteBuffer(bytesB));
  const [hashesA, hashesB] = [a.stageHashes(), b.stageHashes()];
  if (!hashesA || !hashesB) throw new Error(`tick ${tick} has no hashes to compare by`);
  for (const [i, stage] of kStages.entries()) {
    if (hashesA[stage]() === hashesB[stage]()) continue;
    const fields = stage === "input" ? inputFields : outputFields;
    return { tick, stage: kStageNames[i], ...firstField(fields(a), fields(b)) };
  }
  return a.stateHash() === b.stateHash() ? undefined : { tick, stage: "state", field: "hash", a: "", b: "" };
}

const kPauseAfter = 50;  // [ms]

/** Of one hand's ticks; counts them in `counts`. */
async function findParting(a: Recording, b: Recording, counts: Comparison): Promise<Parting | undefined> {
  const ends = (of: Recording) => `ticks ${of.first} to ${of.last}`;
  const end = Math.min(a.last, b.last) + 1;
  let paused = performance.now();
  for (let tick = Math.max(a.first, b.first); tick < end; ++tick) {
    if (performance.now() - paused > kPauseAfter) {
      await new Promise((resolve) => setTimeout(resolve));  // requests of the page come first
      paused = performance.now();
    }
    const [bytesA, bytesB] = [await a.message(tick), await b.message(tick)];
    if (!bytesA && !bytesB) {
      const next = Math.min(await a.next(tick), await b.next(tick), end);
      counts.missing += next - tick;
      tick = next - 1;
      continue;
    }
    ++counts.ticks;
    if (!bytesA || !bytesB)
      return { tick, stage: "input", field: "tick", a: bytesA ? "there" : "missing", b: bytesB ? "there" : "missing" };
    const found = partingOf(tick, bytesA, bytesB);
    if (found) return found;
  }
  if (a.first !== b.first || a.last !== b.last)
    return { tick: a.first === b.first ? end : Math.min(a.first, b.first), stage: "input", field: "tick", a: ends(a), b: ends(b) };
  return undefined;
}

/** Of recordings by hand, one hand after the other, until one parts. */
export async function compare(a: Recording[], b: Recording[]): Promise<Comparison> {
  if (a.length !== b.length) throw new Error(`${(a.length > 1 ? a : b)[0].name} is of two hands and the other of one`);
  const comparison: Comparison = { hands: a[0].sides, ticks: 0, missing: 0 };
  for (const [hand, own] of a.entries()) {
    const found = await findParting(own, b[hand], comparison);
    if (found) return { ...comparison, divergence: { ...found, hand: a.length > 1 ? own.sides[hand] : "" } };
  }
  return comparison;
}
