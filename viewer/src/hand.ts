// One hand: the translucent skin it feels with, the joints it was told, forces and torques.
import {
  BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshStandardMaterial, Vector3,
} from "three";
import type { Frame } from "./frame";
import { makeArc, makeArrow, updateArc, updateArrow, type Arrow } from "./arrows";
import { makeHullGeometry, updateHullGeometry } from "./hulls";
import { kPalm, kSegmentCount } from "./words";

export interface Scales {
  force: number;  // [m/N]
  torque: number;  // [rad/(N m)]
}

export interface HandView {
  group: Group;
  skins: Mesh[];  // by segment
  arrows: Arrow[];
  arcs: Arrow[];
  update(frame: Frame, origin: Vector3, scales: Scales): void;
  select(segment: number): void;
}

// Bones between joints, from the wrist out (hand.h).
const kBones = [1, 2, 6, 11, 16, 21].slice(1).flatMap((base, finger) => {
  const length = finger === 0 ? 4 : 5;
  return [[1, base], ...Array.from({ length: length - 1 }, (_, i) => [base + i, base + i + 1])];
});

/** Where a segment's force acts: the centre of its pressure, or the middle of the segment. */
function actsAt(frame: Frame, segment: number): Vector3 {
  const at = new Vector3();
  let sum = 0;
  for (const contact of frame.contacts) {
    if (contact.segment !== segment) continue;
    at.addScaledVector(contact.centre, contact.volume);
    sum += contact.volume;
  }
  if (sum > 0) return at.divideScalar(sum);
  const hull = frame.hulls.find((one) => one.segment === segment);
  if (!hull) return at;
  for (const point of hull.points) at.add(point);
  return at.divideScalar(hull.points.length);
}

export function makeHand(colour: string): HandView {
  const group = new Group();
  // Depth first, so that of all skins only the nearest is seen through.
  const depth = new MeshBasicMaterial({ colorWrite: false });
  const skins = Array.from({ length: kSegmentCount }, (_, segment) => {
    const geometry = makeHullGeometry();
    const hidden = new Mesh(geometry, depth);
    hidden.renderOrder = 10;
    const skin = new Mesh(geometry, new MeshStandardMaterial({ color: colour, transparent: true, opacity: 0.42, roughness: 0.7 }));
    skin.renderOrder = 11;
    skin.userData = { segment };
    skin.add(hidden);
    group.add(skin);
    return skin;
  });
  const bones = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: 0.5 }));
  bones.renderOrder = 12;
  bones.frustumCulled = false;
  const arrows = Array.from({ length: kSegmentCount }, (_, s) => makeArrow(s));
  const arcs = Array.from({ length: kSegmentCount }, (_, s) => makeArc(s));
  group.add(bones, ...arrows.map((arrow) => arrow.group), ...arcs.map((arc) => arc.group));
  for (const [kind, list] of [["force", arrows], ["torque", arcs]] as const)
    list.forEach((arrow, segment) => arrow.parts.forEach((part) => (part.userData = { segment, kind })));

  return {
    group, skins, arrows, arcs,
    update(frame, origin, scales) {
      for (const skin of skins) skin.visible = false;
      for (const hull of frame.hulls) {
        skins[hull.segment].visible = true;
        updateHullGeometry(skins[hull.segment].geometry, hull, origin);
      }
      const real = frame.tracked.length > 0 ? frame.tracked : frame.joints;
      if (real.length > 0) bones.geometry.setFromPoints(kBones.flatMap(([a, b]) => [real[a], real[b]].map((p) => p.clone().sub(origin))));
      for (let s = 0; s < kSegmentCount; ++s) {
        updateArrow(arrows[s], actsAt(frame, s).sub(origin), frame.forces[s], scales.force);
        const joint = frame.baseJoints[s] ?? origin;
        updateArc(arcs[s], joint.clone().sub(origin), frame.jointTorques[s], s === kPalm ? 0 : scales.torque);
      }
    },
    select(segment) {
      skins.forEach((skin, s) => {
        const material = skin.material as MeshStandardMaterial;
        material.emissive = new Color(s === segment ? "#665500" : "#000000");
      });
    },
  };
}
