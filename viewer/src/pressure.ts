// Contacted area, coloured by pressure: of every contacted triangle what lies inside the segment that touches it, decided pixel by
// pixel by the same shapes the engine computes with.
import { BufferAttribute, BufferGeometry, DoubleSide, GLSL3, Mesh, ShaderMaterial, Vector3, Vector4 } from "three";
import type { Frame, World } from "./frame";

const kRoom = 20000;  // triangles, more than most ticks touch
const kPhalanges = 15;
const kCorners = 16;

// Cividis, which looks the same to the colour-blind, by a polynomial (least squares to its table, three digits).
export const kColourMap = `
vec3 pressureColour(float t) {
  t = clamp(t, 0.0, 1.0);
  return clamp(vec3(-0.01 + t * (1.55 + t * (-1.15 + t * 0.60)),
                    0.13 + t * (0.62 + t * (0.06 + t * 0.10)),
                    0.32 + t * (0.80 + t * (-1.25 + t * 0.32))), 0.0, 1.0);
}`;

const kVertex = `
in float pressure;
in float segment;
out vec3 place;
out float share;
flat out int toucher;
uniform float top;
void main() {
  place = position;
  share = pressure / top;
  toucher = int(segment + 0.5);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= 2e-5 * gl_Position.w;  // just above the surface it lies on
}`;

const kFragment = `
precision highp float;
in vec3 place;
in float share;
flat in int toucher;
out vec4 colour;
uniform vec4 end1[${kPhalanges}];
uniform vec4 end2[${kPhalanges}];
uniform vec3 corner[${kCorners}];
uniform int corners;
uniform float palmRadius;
${kColourMap}
// Depth below the skin of the hull of two spheres.
float inRound(vec4 a, vec4 b) {
  vec3 axis = b.xyz - a.xyz, from = place - a.xyz;
  float length2 = dot(axis, axis), dr = a.w - b.w;
  if (length2 < 1e-12) return max(a.w, b.w) - length(from);
  float along = dot(from, axis);
  float aside = sqrt(max(dot(from, from) - along * along / length2, 0.0));
  float slope = dr / sqrt(max(length2 - dr * dr, 1e-12));
  float t = clamp((along - slope * aside * sqrt(length2)) / length2, 0.0, 1.0);
  return mix(a.w, b.w, t) - length(from - t * axis);
}
float inPalm() {
  if (corners < 3) return -1.0;
  vec3 n = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
  float nearest = 1e9;
  bool inside = true;
  for (int i = 0; i < corners; ++i) {
    vec3 a = corner[i], edge = corner[i + 1 < corners ? i + 1 : 0] - a, from = place - a;
    inside = inside && dot(cross(n, edge), from) >= 0.0;
    nearest = min(nearest, length(from - clamp(dot(from, edge) / dot(edge, edge), 0.0, 1.0) * edge));
  }
  return palmRadius - (inside ? abs(dot(place - corner[0], n)) : nearest);
}
void main() {
  float depth = toucher < ${kPhalanges} ? inRound(end1[toucher], end2[toucher]) : inPalm();
  if (depth < 0.0) discard;
  colour = vec4(pressureColour(share), 1.0);
}`;

const repeated = <T>(count: number, make: () => T) => Array.from({ length: count }, make);

export function makePressure() {
  const geometry = new BufferGeometry();
  let room = 0;
  const makeRoom = (triangles: number) => {
    room = triangles;
    geometry.dispose();  // its buffers go with the attributes it has until now
    for (const [name, size] of [["position", 3], ["pressure", 1], ["segment", 1]] as const)
      geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * size * triangles), size));
  };
  makeRoom(kRoom);
  const uniforms = {
    end1: { value: repeated(kPhalanges, () => new Vector4()) },
    end2: { value: repeated(kPhalanges, () => new Vector4()) },
    corner: { value: repeated(kCorners, () => new Vector3()) },
    corners: { value: 0 },
    palmRadius: { value: 0 },
    top: { value: 1 },
  };
  const material = new ShaderMaterial({
    glslVersion: GLSL3, vertexShader: kVertex, fragmentShader: kFragment, uniforms, side: DoubleSide,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;

  /** `top` [Pa] is the pressure of the scale's end. */
  function update(frame: Frame, world: World, origin: Vector3, top: number) {
    const count = frame.contacts.length;
    if (count > room) makeRoom(2 * count);
    const [position, pressure, segment] = ["position", "pressure", "segment"].map(
      (name) => geometry.getAttribute(name) as BufferAttribute);
    const place = new Vector3();
    for (let i = 0; i < count; ++i) {
      const contact = frame.contacts[i];
      const pose = frame.objects[contact.object - 1]?.pose;
      const positions = contact.object > 0 ? world.apart[contact.object - 1].positions : world.positions;
      for (let corner = 0; corner < 3; ++corner) {
        place.fromArray(positions, 9 * contact.triangle + 3 * corner);
        if (pose) place.applyQuaternion(pose.orientation).add(pose.position);
        place.sub(origin).toArray(position.array, 9 * i + 3 * corner);
      }
      for (let corner = 0; corner < 3; ++corner) {
        pressure.array[3 * i + corner] = pressureOf(contact, world);
        segment.array[3 * i + corner] = contact.segment;
      }
    }
    for (const attribute of [position, pressure, segment]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 3 * attribute.itemSize * count);
      attribute.needsUpdate = count > 0;
    }
    geometry.setDrawRange(0, 3 * count);
    uniforms.corners.value = 0;
    for (const { segment: s, points, radii } of frame.hulls) {
      const at = points.map((point) => point.clone().sub(origin));
      if (s < kPhalanges) {
        uniforms.end1.value[s].set(at[0].x, at[0].y, at[0].z, radii[0]);
        uniforms.end2.value[s].set(at[1].x, at[1].y, at[1].z, radii[1]);
      } else {
        at.forEach((point, i) => uniforms.corner.value[i].copy(point));
        uniforms.corners.value = at.length;
        uniforms.palmRadius.value = radii[0];
      }
    }
    uniforms.top.value = top;
  }
  return { mesh, update };
}

/** [Pa] mean over the contacted part of a triangle; of slivers, whose area is rounding, no more than the deepest point's. */
export function pressureOf(contact: { area: number; volume: number; depth: number }, world: World): number {
  return contact.area > 0 ? world.stiffness * Math.min(contact.volume / contact.area, contact.depth) : 0;
}
