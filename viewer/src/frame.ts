// One tick as the page draws it: what the file holds, and what the replay has found.
import { ByteBuffer } from "flatbuffers";
import { Quaternion, Vector3 } from "three";
import { countOf, kTableSize } from "./counts";
import type { Object_ as SessionObject } from "../generated/lumbrical/fb/object";
import type { Pose as FilePose } from "../generated/lumbrical/fb/pose";
import { ObjectOutput } from "../generated/lumbrical/fb/object-output";
import { SegmentOutput } from "../generated/lumbrical/fb/segment-output";
import { Session } from "../generated/lumbrical/fb/session";
import { Tick } from "../generated/lumbrical/fb/tick";
import { TickView } from "../generated/lumbrical/fb/tick-view";
import { Triangle } from "../generated/lumbrical/fb/triangle";
import type { Shown } from "./worker";
import { kSegmentCount } from "./words";

export interface Hull {
  segment: number;
  points: Vector3[];  // everything within its radius of these points' hull
  radii: number[];
}

export interface ContactRecord {
  segment: number;
  object: number;  // 0: of what stands still, else World.apart[object - 1], whose triangle it is
  triangle: number;
  depth: number;
  area: number;
  volume: number;
  error: number;
  centroid: Vector3;
  centre: Vector3;
  normal: Vector3;
}

export interface Pose {
  position: Vector3;
  orientation: Quaternion;
}

/** Undefined: it is not tracked. */
export type Joint = Vector3 | undefined;

/** What is felt of an object that moves or rubs. */
export interface ObjectRecord {
  pose: Pose;
  force: Vector3;  // [N] of the hand on it
  torque: Vector3;  // [N m]
  coordinate: number;  // [rad], [m] of a hinge or slider
}

export interface Frame {
  tick: number;
  flags: number;
  contactCount: number;
  duration: number;  // [us]
  forces: Vector3[];  // [N] by segment; NaN: neither in the file nor computed
  jointTorques: Vector3[];  // [N m]
  flexionTorques: number[];
  forceError: number;
  errorEstimate: number;
  sent: { state: number; values: number[] }[];
  leftOut: boolean;  // forces are not the file's but computed here
  behindGap: boolean;  // what the replay has found of forces, and of a proxy, is a guess
  joints: Joint[];  // felt with
  tracked: Joint[];  // as the device told them, where a proxy is felt with; else none
  hulls: Hull[];  // of segments whose joints are tracked
  contacts: ContactRecord[];
  knowsObjects: boolean;  // contacts with World.apart are among them, where those with what stands still may not be
  baseJoints: Vector3[];
  objects: ObjectRecord[];  // in the order of World.apart
  differs?: string;  // the stage where the replay parts from the file; empty: nowhere; none: there was no replay
}

/** An object that moves or rubs, in its own frame. */
export interface Apart {
  name: string;
  positions: Float64Array;  // [m] nine numbers per triangle
  pose: Pose;  // at the start
}

/** What neither moves nor rubs, as one; and the rest. */
export interface World {
  names: string[];
  firstTriangle: number[];  // of every object
  positions: Float64Array;  // [m] nine numbers per triangle
  apart: Apart[];
  ground?: { normal: Vector3; offset: number };  // [m] along the normal from the origin
  stiffness: number;
  rate: number;
}

type Point = { x(): number; y(): number; z(): number };
const toVector = (v: Point | null) => (v ? new Vector3(v.x(), v.y(), v.z()) : new Vector3());
function vectors(count: number, at: (i: number) => Point | null): Vector3[] {
  return Array.from({ length: count }, (_, i) => toVector(at(i)));
}

const toPose = (pose: FilePose): Pose => {
  const q = pose.orientation()!;
  return { position: toVector(pose.position()), orientation: new Quaternion(q.x(), q.y(), q.z(), q.w()) };
};

const trianglesOf = (object: SessionObject) => countOf(object.trianglesLength(), Triangle.sizeOf(), object);

function readTriangles(object: SessionObject, positions: Float64Array, at = 0) {
  for (let t = 0; t < trianglesOf(object); ++t) {
    const triangle = object.triangles(t)!;
    for (const corner of [triangle.a(), triangle.b(), triangle.c()]) {
      const vertex = object.vertices(corner)!;
      positions[at++] = vertex.x();
      positions[at++] = vertex.y();
      positions[at++] = vertex.z();
    }
  }
  return positions;
}

export function readWorld(bytes: Uint8Array): World {
  const session = Session.getRootAsSession(new ByteBuffer(bytes));
  const objects = Array.from({ length: countOf(session.objectsLength(), kTableSize, session) }, (_, i) => session.objects(i)!);
  const name = (object: SessionObject) => object.name() ?? `object ${objects.indexOf(object)}`;
  const still = objects.filter((object) => !object.pose());
  let count = 0;
  const firstTriangle = still.map((object) => (count += trianglesOf(object)) - trianglesOf(object));
  const positions = new Float64Array(9 * count);
  still.forEach((object, i) => readTriangles(object, positions, 9 * firstTriangle[i]));
  const apart = objects.filter((object) => object.pose()).map((object) => ({
    name: name(object),
    positions: readTriangles(object, new Float64Array(9 * trianglesOf(object))),
    pose: toPose(object.pose()!),
  }));
  const settings = session.settings()!;
  const plane = session.ground();
  const ground = plane ? { normal: toVector(plane.normal()).normalize(), offset: plane.offset() } : undefined;
  return { names: still.map(name), firstTriangle, positions, apart, ground, stiffness: settings.stiffness(), rate: settings.rate() };
}

const same = (a: Float64Array, b: Float64Array) => a.length === b.length && a.every((value, i) => value === b[i]);

/** Of the same shapes; where they stand and what they are called is no matter. */
export function hasSameObjects(a: World, b: World): boolean {
  return same(a.positions, b.positions) && a.apart.length === b.apart.length && a.apart.every(({ positions }, i) => same(positions, b.apart[i].positions));
}

const known = (joints: Vector3[], valid: number): Joint[] => joints.map((joint, j) => ((valid >>> j) & 1 ? joint : undefined));

function readHulls(view: TickView): Hull[] {
  const hulls: Hull[] = [];
  for (let i = 0; i < view.phalangesLength(); ++i) {
    const phalanx = view.phalanges(i)!;
    hulls.push({
      segment: phalanx.segment(),
      points: [toVector(phalanx.end1()), toVector(phalanx.end2())],
      radii: [phalanx.radius1(), phalanx.radius2()],
    });
  }
  if (view.palmLength() > 0) {
    const points = vectors(view.palmLength(), (i) => view.palm(i));
    hulls.push({ segment: 15, points, radii: points.map(() => view.palmRadius()) });
  }
  return hulls;
}

function readContacts(view: TickView): ContactRecord[] {
  return Array.from({ length: view.contactsLength() }, (_, i) => {
    const contact = view.contacts(i)!;
    return {
      segment: contact.segment(),
      object: contact.object(),
      triangle: contact.triangle(),
      depth: contact.depth(),
      area: contact.area(),
      volume: contact.volume(),
      error: contact.error(),
      centroid: toVector(contact.centroid()),
      centre: toVector(contact.centre()),
      normal: toVector(contact.normal()),
    };
  });
}

export function readFrame(shown: Shown): Frame {
  const tick = Tick.getRootAsTick(new ByteBuffer(shown.message));
  const view = shown.view && TickView.getRootAsTickView(new ByteBuffer(shown.view));
  const leftOut = tick.forcesLeftOut();
  const behindGap = shown.behindGap === true && !!view?.differs();  // the same bits are right wherever they come from
  const told = leftOut && view && !behindGap ? view : tick;
  const zero = leftOut && told.segmentsLength() === 0 ? NaN : 0;
  const isPlaced = !shown.handOnly && !(behindGap && view!.trackedLength() > 0);  // a proxy that is a guess touches nothing
  const each = () => Array.from({ length: kSegmentCount }, () => new Vector3(zero, zero, zero));
  const frame: Frame = {
    tick: shown.tick,
    flags: tick.flags(),
    contactCount: tick.contactCount(),
    duration: shown.microseconds ?? tick.durationNs() / 1e3,
    forces: each(),
    jointTorques: each(),
    flexionTorques: new Array(kSegmentCount).fill(zero),
    forceError: tick.forceError(),
    errorEstimate: tick.errorEstimate() ?? 0,
    sent: Array.from({ length: countOf(tick.sentLength(), kTableSize, tick) }, (_, i) => {
      const sent = tick.sent(i)!;
      return { state: sent.state(), values: Array.from(sent.valuesArray() ?? []) };
    }),
    leftOut,
    behindGap,
    joints: view ? known(vectors(view.jointsLength(), (i) => view.joints(i)), view.valid()) : [],
    tracked: view ? known(vectors(view.trackedLength(), (i) => view.tracked(i)), view.valid()) : [],
    hulls: view ? readHulls(view) : [],
    contacts: view && isPlaced ? readContacts(view) : [],
    knowsObjects: view !== undefined && isPlaced && view.knowsObjects(),
    baseJoints: view ? vectors(view.baseJointsLength(), (i) => view.baseJoints(i)) : [],
    objects: Array.from({ length: countOf(tick.objectsLength(), ObjectOutput.sizeOf(), tick) }, (_, i) => {
      const object = tick.objects(i)!;
      return { pose: toPose(object.pose()!), force: toVector(object.force()), torque: toVector(object.torque()), coordinate: object.coordinate() };
    }),
    differs: view && (view.differs() ?? ""),
  };
  const outputs = countOf(told.segmentsLength(), SegmentOutput.sizeOf(), told);
  for (let i = 0; i < outputs; ++i) {
    const output = told.segments(i)!;
    const s = output.segment();
    if (s >= kSegmentCount) continue;
    frame.forces[s] = toVector(output.force());
    frame.jointTorques[s] = toVector(output.jointTorque());
    frame.flexionTorques[s] = output.flexionTorque();
  }
  return frame;
}
