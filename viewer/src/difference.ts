// Where two recordings part: the first tick, the first stage of it, and the field, as `lumbrical diff` names them.
import { ByteBuffer } from "flatbuffers";
import type { SegmentOutput } from "../generated/lumbrical/fb/segment-output";
import { Tick } from "../generated/lumbrical/fb/tick";
import type { Recording } from "./recording";
import { kSegmentCount } from "./words";

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

const kJointCount = 26;
const kAngleCount = 20;
const kKinds = ["joint_poses", "joint_angles"];

type Parting = Omit<Divergence, "hand">;
type Field = [name: string, value: number | bigint | string];
type Point = { x(): number; y(): number; z(): number };

// What a message leaves out is 0, but for rotations.
const xyz = (name: string, v?: Point | null): Field[] => [[`${name}.x`, v?.x() ?? 0], [`${name}.y`, v?.y() ?? 0], [`${name}.z`, v?.z() ?? 0]];
const row = (name: string, values: number[]): Field[] => values.map((value, i) => [`${name}[${i}]`, value]);
const numbered = <T>(count: number, make: (i: number) => T) => Array.from({ length: count }, (_, i) => make(i));

function jointFields(tick: Tick, j: number): Field[] {
  const pose = tick.joints(j);
  const [p, q] = [pose?.position(), pose?.orientation()];
  return [
    ...row(`joint[${j}].position`, p ? [p.x(), p.y(), p.z()] : [0, 0, 0]),
    ...row(`joint[${j}].orientation`, q ? [q.x(), q.y(), q.z(), q.w()] : [0, 0, 0, 1]),
  ];
}

function inputFields(tick: Tick): Field[] {
  const base = tick.base();
  const turn = base?.orientation();
  return [
    ...xyz("base.position", base?.position()),
    ["base.orientation.w", turn?.w() ?? 1], ...xyz("base.orientation", turn),
    ["kind", kKinds[tick.kind()]], ["flags", tick.deviceFlags()], ["valid", tick.valid()],
    ...numbered(kJointCount, (j) => jointFields(tick, j)).flat(),
    ...row("angle", numbered(kAngleCount, (i) => tick.angles(i) ?? 0)),
  ];
}

function forceFields(tick: Tick): Field[] {
  const segments: SegmentOutput[] = [];
  for (let i = 0; i < Math.min(tick.segmentsLength(), kSegmentCount); ++i) segments[tick.segments(i)!.segment()] = tick.segments(i)!;
  const ofEach = (fields: (name: string, segment?: SegmentOutput) => Field[], name: string) =>
    numbered(kSegmentCount, (s) => fields(`${name}[${s}]`, segments[s])).flat();
  return [
    ...ofEach((name, segment) => [...xyz(`${name}.force`, segment?.force()), ...xyz(`${name}.torque`, segment?.torque())], "segment"),
    ...ofEach((name, segment) => xyz(name, segment?.jointTorque()), "joint_torque"),
    ...ofEach((name, segment) => [[name, segment?.flexionTorque() ?? 0]], "flexion_torque"),
  ];
}

function outputFields(tick: Tick): Field[] {
  return [
    ["flags", tick.flags()], ["contact_count", tick.contactCount()], ["evaluations", tick.evaluations()],
    ["error_estimate", tick.errorEstimate() ?? 0], ["force_error", tick.forceError()],
  ];
}

type Values = Omit<Parting, "tick" | "stage">;

/** `otherwise`: what differs where no field does. */
function firstField(a: Field[], b: Field[], otherwise: string): Values {
  const at = a.findIndex(([, value], i) => !Object.is(value, b[i][1]));
  return at < 0 ? { field: otherwise, a: "", b: "" } : { field: a[at][0], a: String(a[at][1]), b: String(b[at][1]) };
}

function firstOutput(a: Tick, b: Tick): Values {
  // Of forces left out there is the hash alone.
  const forces = (tick: Tick) => (a.forcesLeftOut() || b.forcesLeftOut() ? [] : forceFields(tick));
  return firstField([...outputFields(a), ...forces(a)], [...outputFields(b), ...forces(b)], "hash");
}

const kStages = {
  input: "input", handPose: "hand_pose", broadphase: "broadphase", narrowphase: "narrowphase", contactForce: "contact_force", limits: "limits",
} as const;

function partingOf(tick: number, bytesA: Uint8Array, bytesB: Uint8Array): Parting | undefined {
  const a = Tick.getRootAsTick(new ByteBuffer(bytesA));
  const b = Tick.getRootAsTick(new ByteBuffer(bytesB));
  const [hashesA, hashesB] = [a.stageHashes(), b.stageHashes()];
  if (!hashesA || !hashesB) throw new Error(`tick ${tick} has no hashes to compare by`);
  for (const [hash, stage] of Object.entries(kStages) as [keyof typeof kStages, string][]) {
    if (hashesA[hash]() === hashesB[hash]()) continue;
    return { tick, stage, ...(stage === "input" ? firstField(inputFields(a), inputFields(b), "given") : firstOutput(a, b)) };
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
