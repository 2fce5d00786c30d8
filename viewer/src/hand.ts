// One hand: the translucent skin it feels with, the joints it was told, forces and torques.
import {
  BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshStandardMaterial, Vector3,
} from "three";
import type { Frame, Hull } from "./frame";
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
const kBones = [2, 6, 11, 16, 21].flatMap((base, finger) => {
  const length = finger === 0 ? 4 : 5;
  return [[1, base], ...Array.from({ length: length - 1 }, (_, i) => [base + i, base + i + 1])];
});

/** Where a segment's force acts: the centre of its pressure, or the middle of the segment. */
function actsAt(frame: Frame, { segment, points }: Hull): Vector3 {
  const at = new Vector3();
  let sum = 0;
  for (const contact of frame.contacts) {
    if (contact.segment !== segment) continue;
    at.addScaledVector(contact.centre, contact.volume);
    sum += contact.volume;
  }
  if (sum > 0) return at.divideScalar(sum);
  for (const point of points) at.add(point);
  return at.divideScalar(points.length);
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
  const room = kBones.flatMap(() => [new Vector3(), new Vector3()]);
  const bones = new LineSegments(new BufferGeometry().setFromPoints(room), new LineBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: 0.5 }));
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
      const real = frame.tracked.length > 0 ? frame.tracked : frame.joints;
      const ends = kBones.flatMap(([a, b]) => (real[a] && real[b] ? [real[a], real[b]] : []));
      bones.geometry.setFromPoints(ends.map((end) => end.clone().sub(origin)));
      bones.geometry.setDrawRange(0, ends.length);
      // What a segment feels is drawn where it is; of one that is nowhere it is told in numbers.
      for (const part of [...skins, ...arrows.map(({ group }) => group), ...arcs.map(({ group }) => group)]) part.visible = false;
      for (const hull of frame.hulls) {
        const s = hull.segment;
        skins[s].visible = true;
        updateHullGeometry(skins[s].geometry, hull, origin);
        updateArrow(arrows[s], actsAt(frame, hull).sub(origin), frame.forces[s], scales.force);
        updateArc(arcs[s], frame.baseJoints[s].clone().sub(origin), frame.jointTorques[s], s === kPalm ? 0 : scales.torque);
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
