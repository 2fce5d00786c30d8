// The skin of a hull of spheres: every point of a sphere moves to the farthest point of the hull in its direction.
import { BufferAttribute, BufferGeometry, Matrix4, Vector3 } from "three";
import type { Hull } from "./frame";

const kRings = 16;
const kSectors = 20;

/** Directions on a sphere, poles first and last; triangles between them. */
function sphere() {
  const directions: Vector3[] = [];
  const index: number[] = [];
  for (let ring = 0; ring <= kRings; ++ring) {
    const polar = (Math.PI * ring) / kRings;
    for (let sector = 0; sector < kSectors; ++sector) {
      const around = (2 * Math.PI * sector) / kSectors;
      directions.push(new Vector3(Math.sin(polar) * Math.cos(around), Math.sin(polar) * Math.sin(around), Math.cos(polar)));
      if (ring === kRings) continue;
      const [a, b] = [ring * kSectors + sector, ring * kSectors + ((sector + 1) % kSectors)];
      index.push(a, a + kSectors, b, b, a + kSectors, b + kSectors);
    }
  }
  return { directions, index };
}
const { directions: kDirections, index: kIndex } = sphere();

export function makeHullGeometry(): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const name of ["position", "normal"])
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * kDirections.length), 3));
  geometry.setIndex(kIndex);
  return geometry;
}

const frame = new Matrix4();
const direction = new Vector3();

/** The sphere's poles lie along a phalanx, and on the flat sides of a palm, where few triangles then do. */
function poles({ points }: Hull): Vector3 {
  const along = points[1].clone().sub(points[0]);
  const pole = points.length === 2 ? along : points[2].clone().sub(points[0]).cross(along);
  return pole.lengthSq() > 0 ? pole.normalize() : new Vector3(0, 0, 1);
}

export function updateHullGeometry(geometry: BufferGeometry, hull: Hull, origin: Vector3) {
  const pole = poles(hull);
  const side = new Vector3(Math.abs(pole.x) < 0.9 ? 1 : 0, Math.abs(pole.x) < 0.9 ? 0 : 1, 0).cross(pole).normalize();
  frame.makeBasis(side, pole.clone().cross(side), pole);
  const position = geometry.getAttribute("position") as BufferAttribute;
  const normal = geometry.getAttribute("normal") as BufferAttribute;
  const { points, radii } = hull;
  kDirections.forEach((unit, i) => {
    direction.copy(unit).applyMatrix4(frame);
    let best = 0;
    let farthest = -Infinity;
    for (let p = 0; p < points.length; ++p) {
      const reach = points[p].dot(direction) + radii[p];
      if (reach > farthest) [farthest, best] = [reach, p];
    }
    const from = points[best];
    const r = radii[best];
    position.setXYZ(i, from.x - origin.x + r * direction.x, from.y - origin.y + r * direction.y,
      from.z - origin.z + r * direction.z);
    normal.setXYZ(i, direction.x, direction.y, direction.z);
  });
  position.needsUpdate = normal.needsUpdate = true;
  geometry.computeBoundingSphere();
}
