// All that is known of what was clicked, or of the tick, in words.
import { Vector3 } from "three";
import type { Frame, World } from "./frame";
import { largest } from "./largest";
import { pressureOf } from "./pressure";
import type { Pick } from "./scene";
import type { Opened } from "./worker";
import { arithmeticText, brief, jointOf, kDeviceStates, kSegments, kTickFlags } from "./words";

type Rows = [term: string, text: string][];

/** A frame that tells of what is picked. */
export interface Told {
  frame: Frame;
  world: World;
  hand: string;  // "right " or "left ", empty where there is one
  noContacts: string;  // as Opened has it
}

const millimetres = (v: Vector3) => `${brief(1e3 * v.x)}, ${brief(1e3 * v.y)}, ${brief(1e3 * v.z)} mm`;
const ifKnown = (v: Vector3, text: string) => (Number.isNaN(v.x) ? "not known" : text);
const newtons = (v: Vector3) => ifKnown(v, `${brief(v.length())} N  (${brief(v.x)}, ${brief(v.y)}, ${brief(v.z)})`);
const torque = (v: Vector3) => ifKnown(v, `${brief(1e3 * v.length())} N mm  (${brief(1e3 * v.x)}, ${brief(1e3 * v.y)}, ${brief(1e3 * v.z)})`);

export function flagsText(flags: number): string {
  return kTickFlags.filter((_, bit) => (flags >> bit) & 1).join(", ") || "none";
}

/** [m] How far the proxy's joints are from the tracked ones. */
const lag = ({ joints, tracked }: Frame) => largest(tracked.map((joint, j) => joint?.distanceTo(joints[j]!) ?? 0));

const kBehindGap = "not known: behind a gap";

/** Why contacts are not known, but those that a frame knows; empty: they are. Where a proxy is depends on the ticks before. */
const whyNone = ({ behindGap, tracked }: Frame, noContacts: string) => noContacts || (behindGap && tracked.length > 0 ? kBehindGap : "");

/** Why contacts with what stands still (0) or with World.apart[object - 1] are not known; empty: they are. */
const whyUnknown = (object: number, { frame, noContacts }: Told) => (object > 0 && frame.knowsObjects ? "" : whyNone(frame, noContacts));

function countText({ contacts, knowsObjects }: Frame, why: string): string {
  if (!why) return `${contacts.length} triangles; `;
  return knowsObjects ? `${contacts.length} triangles of objects that move or rub; ` : "";
}

function replayedText({ differs, behindGap }: Frame, { metadata, arithmetic }: Opened): string {
  if (behindGap) return kBehindGap;
  return differs ? `parts from the file at stage "${differs}"${arithmeticText(metadata.get("arithmetic"), "here", arithmetic)}` : "the same bits";
}

function leftOutText({ behindGap }: Frame, noContacts: string): string {
  if (noContacts) return "not in the file";
  return behindGap ? `not in the file, and ${kBehindGap}` : "not in the file; computed here";
}

export function tickRows(frame: Frame, milliseconds: number, world: World, opened: Opened, live: boolean): Rows {
  const why = whyNone(frame, opened.noContacts);
  const total = frame.forces.reduce((sum, force) => sum.add(force), new Vector3());
  const rows: Rows = [
    ["tick", `${frame.tick} at ${(frame.tick / world.rate).toFixed(3)} s`],
    ["force of the hand", newtons(total)],
    ["off by at most", `${brief(frame.forceError)} N by integrals; about ${brief(frame.errorEstimate)} N by samples`],
    ["contacts", `${countText(frame, why)}the tick counted ${frame.contactCount} patches`],
    ["flags", flagsText(frame.flags)],
    ["tick took", `${brief(frame.duration)} us; here ${brief(milliseconds)} ms${why ? "" : " with contacts"}`],
  ];
  const known = frame.joints.filter((joint) => joint).length;
  if (known < frame.joints.length) rows.push(["joints tracked", `${known || "none"} of ${frame.joints.length}; what hangs on the others is not drawn`]);
  if (frame.tracked.length > 0 && !why) rows.push(["proxy", `up to ${brief(1e3 * lag(frame))} mm from the tracked joints, which are the lines`]);
  if (frame.sent.length > 0) {
    const sent = frame.sent[frame.sent.length - 1];
    rows.push(["device", `${kDeviceStates[sent.state]}: ${sent.values.map(brief).join(", ")}`]);
  }
  if (frame.leftOut) rows.push(["forces", leftOutText(frame, opened.noContacts)]);
  if (why) rows.push(["contacts", why]);
  if (!opened.noContacts && frame.differs !== undefined && !live) rows.push(["replayed here", replayedText(frame, opened)]);
  return rows;
}

export function segmentRows(segment: number, { frame, world, noContacts }: Told): Rows {
  const rows: Rows = [
    ["force", newtons(frame.forces[segment])],
    [`torque about ${jointOf(segment)} joint`, torque(frame.jointTorques[segment])],
    ["of it, opening", ifKnown(frame.jointTorques[segment], `${brief(1e3 * frame.flexionTorques[segment])} N mm`)],
  ];
  if (whyNone(frame, noContacts)) return rows;
  const own = frame.contacts.filter((contact) => contact.segment === segment);
  const sum = (value: (contact: (typeof own)[number]) => number) => own.reduce((all, contact) => all + value(contact), 0);
  return [
    ...rows,
    ["contacted triangles", `${own.length}`],
    ["contacted area", `${brief(1e6 * sum((contact) => contact.area))} mm²`],
    ["deepest", `${brief(1e3 * largest(own.map((contact) => contact.depth)))} mm`],
    ["highest pressure", `${brief(largest(own.map((contact) => pressureOf(contact, world))) / 1e3)} kPa, mean over a triangle`],
  ];
}

export function objectOf(triangle: number, world: World): string {
  const at = world.firstTriangle.findLastIndex((first) => first <= triangle);
  return at < 0 ? "" : world.names[at];
}

const contactsOf = (told: Told[], object: number) =>
  told.flatMap(({ frame, world, hand }) => frame.contacts.filter((contact) => contact.object === object).map((contact) => ({ contact, world, hand })));

/** Of a triangle of what stands still (0), or of World.apart[object - 1]. */
function contactRows(object: number, triangle: number, told: Told[]): Rows {
  const rows: Rows = [];
  const touched = contactsOf(told, object).filter(({ contact }) => contact.triangle === triangle);
  if (touched.length === 0) rows.push(["contact", whyUnknown(object, told[0]) || "none in this tick"]);
  for (const { contact, world, hand } of touched) {
    rows.push(
      ["touched by", hand + kSegments[contact.segment]],
      ["area", `${brief(1e6 * contact.area)} mm²`],
      ["pressure", `${brief(pressureOf(contact, world))} Pa, mean`],
      ["force", `${brief(world.stiffness * contact.volume)} N along the normal, within ${brief(world.stiffness * contact.error)} N`],
      ["depth", `${brief(1e3 * contact.depth)} mm`],
      ["centre of pressure", millimetres(contact.centre)],
      ["normal", contact.normal.toArray().map((value) => value.toFixed(3)).join(", ")],
    );
  }
  return rows;
}

export function triangleRows(triangle: number, told: Told[]): Rows {
  const [{ world }] = told;
  const rows: Rows = [["object", objectOf(triangle, world)], ["triangle", `${triangle}`]];
  for (let corner = 0; corner < 3; ++corner)
    rows.push([`corner ${"abc"[corner]}`, millimetres(new Vector3().fromArray(world.positions, 9 * triangle + 3 * corner))]);
  rows.push(...contactRows(0, triangle, told));
  return rows;
}

export function objectRows(object: number, triangle: number, told: Told[]): Rows {
  const rows: Rows = [["object", told[0].world.apart[object].name]];
  const felt = told.flatMap(({ frame, hand }) => (frame.objects[object] ? [{ ...frame.objects[object], hand }] : []));
  if (felt.length === 0) return rows;
  const [{ pose, coordinate }] = felt;  // the same for both hands
  const { x, y, z, w } = pose.orientation;
  rows.push(
    ["stands at", millimetres(pose.position)],
    ["turned by", `${brief((360 / Math.PI) * Math.atan2(Math.hypot(x, y, z), Math.abs(w)))}°`],
  );
  for (const one of felt)
    rows.push([`force of the ${one.hand}hand on it`, newtons(one.force)], [`torque of the ${one.hand}hand about its origin`, torque(one.torque)]);
  if (!whyUnknown(object + 1, told[0])) rows.push(["contacted triangles", `${contactsOf(told, object + 1).length}`]);
  if (coordinate !== 0) rows.push(["joint at", `${brief(coordinate)} rad or m`]);
  rows.push(["triangle", `${triangle}`], ...contactRows(object + 1, triangle, told));
  return rows;
}

export function showRows(parent: HTMLElement, title: string, rows: Rows) {
  const heading = document.createElement("h2");
  heading.textContent = title;
  const list = document.createElement("dl");
  for (const [term, text] of rows) {
    const dt = document.createElement("dt");
    const dd = document.createElement("dd");
    dt.textContent = term;
    dd.textContent = text;
    if (text.startsWith("parts from")) dd.className = "warn";
    list.append(dt, dd);
  }
  parent.append(heading, list);
}

/** `told` of what is picked: nothing where its tick is missing. */
export function showDetails(parent: HTMLElement, pick: Pick | undefined, told: Told[], general: Rows) {
  parent.replaceChildren();
  if (pick && told.length > 0) {
    if (pick.kind === "triangle") showRows(parent, "Triangle", triangleRows(pick.triangle, told));
    else if (pick.kind === "object") showRows(parent, "Object", objectRows(pick.object, pick.triangle, told));
    else showRows(parent, kSegments[pick.segment], segmentRows(pick.segment, told[0]));
  }
  showRows(parent, "Tick", general);
}

function triangleTip(triangle: number, told: Told[]): string {
  const pressures = contactsOf(told, 0).filter(({ contact }) => contact.triangle === triangle)
    .map(({ contact, world, hand }) => `${hand}${brief(pressureOf(contact, world) / 1e3)} kPa`);
  return pressures.length > 0 ? `${objectOf(triangle, told[0].world)}, triangle ${triangle}: ${pressures.join(", ")}` : "";
}

export function tipText(pick: Pick, told: Told[]): string {
  if (told.length === 0) return "";
  const [{ frame, world }] = told;
  if (pick.kind === "triangle") return triangleTip(pick.triangle, told);
  if (pick.kind === "force") return `${kSegments[pick.segment]}: ${brief(frame.forces[pick.segment].length())} N`;
  if (pick.kind === "torque") return `${jointOf(pick.segment)} joint: ${brief(1e3 * frame.jointTorques[pick.segment].length())} N mm`;
  if (pick.kind !== "object") return kSegments[pick.segment];
  const forces = told.map((one) => `${one.hand}${brief(one.frame.objects[pick.object]?.force.length() ?? 0)} N`);
  return `${world.apart[pick.object].name}: ${forces.join(", ")}`;
}
