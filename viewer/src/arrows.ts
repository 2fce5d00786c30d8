// Force arrows and torque arcs, to scale, each told apart by its finger's colour.
import {
  ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, TorusGeometry, Vector3, type BufferGeometry,
} from "three";
import { colourOf } from "./words";

const kShaft = new CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0);
const kHead = new ConeGeometry(1, 1, 16).translate(0, 0.5, 0);
const kThickness = 0.0008;  // [m]
const kUp = new Vector3(0, 1, 0);
const kAxis = new Vector3(0, 0, 1);
const kArcRadius = 0.017;  // [m] outside the thickest finger
const kWidestArc = 1.6 * Math.PI;

export interface Arrow {
  group: Group;
  parts: Mesh[];
  material: MeshBasicMaterial;
}

function makePart(material: MeshBasicMaterial, geometry: BufferGeometry, group: Group): Mesh {
  const mesh = new Mesh(geometry, material);
  group.add(mesh);
  return mesh;
}

export function makeArrow(segment: number): Arrow {
  const group = new Group();
  const material = new MeshBasicMaterial({ color: colourOf(segment) });
  return { group, material, parts: [makePart(material, kShaft, group), makePart(material, kHead, group)] };
}

/** From `at` along `vector`, `scale` metres per unit of it. */
export function updateArrow({ group, parts: [shaft, head] }: Arrow, at: Vector3, vector: Vector3, scale: number) {
  const length = vector.length() * scale;
  group.visible = length > 1e-4;
  if (!group.visible) return;
  const tip = Math.min(length, 5 * kThickness);
  group.position.copy(at);
  group.quaternion.setFromUnitVectors(kUp, vector.clone().normalize());
  shaft.scale.set(kThickness, length - tip, kThickness);
  head.scale.set(2.2 * kThickness, tip, 2.2 * kThickness);
  head.position.y = length - tip;
}

export function makeArc(segment: number): Arrow {
  const group = new Group();
  // Not transparent: it would be hidden by the skin round it, whose depth is drawn before all that is.
  const material = new MeshBasicMaterial({ color: colourOf(segment) });
  return { group, material, parts: [makePart(material, new TorusGeometry(), group), makePart(material, kHead, group)] };
}

/** Round `at`, the sense of `torque` by the right hand, `scale` radians per unit of it. */
export function updateArc({ group, parts: [arc, head] }: Arrow, at: Vector3, torque: Vector3, scale: number) {
  const angle = Math.min(torque.length() * scale, kWidestArc);
  group.visible = angle > 0.05;
  if (!group.visible) return;
  group.position.copy(at);
  group.quaternion.copy(new Quaternion().setFromUnitVectors(kAxis, torque.clone().normalize()));
  arc.geometry.dispose();
  arc.geometry = new TorusGeometry(kArcRadius, kThickness, 8, 32, angle);
  head.position.set(kArcRadius * Math.cos(angle), kArcRadius * Math.sin(angle), 0);
  head.rotation.set(0, 0, angle);
  head.scale.set(1.8 * kThickness, 4 * kThickness, 1.8 * kThickness);
}
