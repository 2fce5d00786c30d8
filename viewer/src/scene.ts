// The scene: objects, one hand or two, contacts; camera by mouse, touch and keys; what the pointer is on.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, GridHelper, Mesh, MeshStandardMaterial,
  Box3, Group, PerspectiveCamera, Raycaster, Scene, Sphere, Vector2, Vector3, WebGLRenderer, type Object3D,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { hasSameObjects, type Frame, type Pose, type World } from "./frame";
import { makeHand, type HandView, type Scales } from "./hand";
import { makePressure } from "./pressure";
import type { Tracking } from "./tracking";

/** `place`: whose hand it is, or in whose picture the world was picked. */
export type Pick = { place: number } & (HandPick | { kind: "triangle"; triangle: number } | { kind: "object"; object: number; triangle: number });
type HandPick = { kind: "segment" | "force" | "torque"; segment: number };

export const isOfHand = (pick: Pick | undefined): pick is Pick & HandPick => pick !== undefined && "segment" in pick;

export interface View {
  camera: PerspectiveCamera;
  controls: OrbitControls;
  /** What a place is felt in; that of place 0 is drawn. */
  setWorld(place: number, world: World): void;
  /** Whether a place is felt in other objects than those that are drawn. */
  hasOtherObjects(place: number): boolean;
  setFrame(place: number, frame: Frame | undefined, scales: Scales, top: number): void;
  setBeside(beside: boolean): void;
  setTogether(together: boolean): void;
  pick(x: number, y: number): Pick | undefined;
  select(pick: Pick | undefined): void;
  /** The camera before the hands that are shown and what is near them; without hands before the objects. */
  frameAll(): void;
  /** Moves a point in the picture's plane with the pointer [CSS pixels]. */
  drag(point: Vector3, right: number, down: number): void;
  draw(): void;
  /** Calls back before every picture, of the page or of the headset. */
  animate(picture: (time: number, frame?: XRFrame) => void): void;
  /** Draws in a headset as well, until its session ends. */
  enter(tracking: Tracking): Promise<void>;
  inHeadset(): boolean;
}

const kSkins = ["#d9a066", "#4f7cac"];
const kNear = 0.1;  // [m] from a hand

function meshOf(metres: Float64Array, origin: Vector3): Mesh {
  const positions = new Float32Array(metres.length);
  const shift = [origin.x, origin.y, origin.z];
  positions.forEach((_, i) => (positions[i] = metres[i] - shift[i % 3]));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.computeVertexNormals();
  return new Mesh(geometry, new MeshStandardMaterial({ color: "#9aa3ad", roughness: 0.85, flatShading: true, side: 2 }));
}

function meanOf(positions: Float64Array): Vector3 {
  const sum = new Vector3();
  for (let i = 0; i < positions.length; i += 3) sum.x += positions[i], sum.y += positions[i + 1], sum.z += positions[i + 2];
  return sum.multiplyScalar(3 / Math.max(3, positions.length));
}

function middleOf(world: World): Vector3 {
  const sum = new Vector3();
  let count = 0;
  for (let i = 0; i < world.positions.length; i += 3, ++count) sum.x += world.positions[i], sum.y += world.positions[i + 1], sum.z += world.positions[i + 2];
  if (count === 0) world.apart.forEach(({ pose, positions }) => (++count, sum.add(meanOf(positions).applyQuaternion(pose.orientation).add(pose.position))));
  return count > 0 ? sum.divideScalar(count) : sum;
}

export function makeView(canvas: HTMLCanvasElement, redraw: () => void): View {
  const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  const scene = new Scene();
  const camera = new PerspectiveCamera(40, 1, 0.005, 50);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, canvas);
  controls.addEventListener("change", redraw);
  scene.add(new AmbientLight("#ffffff", 1.3));
  const sun = new DirectionalLight("#ffffff", 2.2);
  camera.add(sun);
  sun.position.set(0.4, 0.8, 1);
  const grid = new GridHelper(0.6, 12, "#888888", "#888888");
  grid.material.transparent = true;
  grid.material.opacity = 0.25;
  scene.add(camera, grid);

  // Single precision must hold a hand far from the world's origin: everything is drawn about this point.
  const origin = new Vector3();
  let still: Mesh | undefined;
  let apart: Mesh[] = [];
  let poses: Pose[][] = [];  // of them, by place
  const worlds: World[] = [];  // by place
  const other = [false, false];  // such objects have no picture, nor what touches them
  const things = new Group();  // both
  let beside = false;
  let together = false;  // two hands of one session, not one hand twice: each has its pressures
  const hands: HandView[] = kSkins.map(makeHand);
  const pressures = kSkins.map(makePressure);
  const shown = [false, false];
  hands.forEach((hand, place) => {
    hand.group.visible = pressures[place].mesh.visible = false;
    scene.add(hand.group, pressures[place].mesh);
  });
  const outline = new Mesh(new BufferGeometry(), new MeshStandardMaterial({ color: "#ffffff", emissive: "#665500", side: 2, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }));
  outline.visible = false;
  scene.add(outline);
  scene.add(things);
  const raycaster = new Raycaster();

  /** Of two recordings one over the other, that whose pressures are seen. */
  const front = () => (shown[0] ? 0 : 1);

  /** Objects stand where one place has them: there is one mesh of each. */
  const standAs = (place: number) => {
    apart.forEach((mesh, i) => {
      mesh.position.copy(mesh.userData.centre).applyQuaternion(poses[place][i].orientation).add(poses[place][i].position).sub(origin);
      mesh.quaternion.copy(poses[place][i].orientation);
      mesh.updateMatrixWorld();
    });
  };

  /** In the ground, or just below the objects. */
  const layGrid = (ground: World["ground"]) => {
    const box = new Box3().setFromObject(things);
    const { normal, offset } = ground ?? { normal: camera.up, offset: origin.z + (box.isEmpty() ? 0 : box.min.z - 1e-3) };
    grid.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), normal);
    grid.position.copy(normal).multiplyScalar(offset - normal.dot(origin));
  };

  /** Shows what belongs to a place, or to all. */
  const only = (place: number | undefined) => {
    standAs(place ?? front());
    things.visible = place === undefined || !other[place];
    hands.forEach((hand, i) => {
      hand.group.visible = shown[i] && (place === undefined || place === i);
      pressures[i].mesh.visible = shown[i] && !other[i] && (place === i || (place === undefined && (together || i === front())));
    });
  };

  return {
    camera, controls,
    setWorld(place, next) {
      worlds[place] = next;
      other[place] = place > 0 && !hasSameObjects(worlds[0], next);
      if (place > 0) return;
      origin.copy(middleOf(next));
      still = next.positions.length > 0 ? meshOf(next.positions, origin) : undefined;
      apart = next.apart.map((object, i) => {
        const centre = meanOf(object.positions);
        const mesh = meshOf(object.positions, centre);
        mesh.userData = { object: i, centre };
        return mesh;
      });
      poses = kSkins.map(() => next.apart.map(({ pose }) => pose));
      for (const { geometry, material } of things.children as Mesh[]) {
        geometry.dispose();
        (material as MeshStandardMaterial).dispose();
      }
      things.clear();
      for (const mesh of still ? [still, ...apart] : apart) things.add(mesh);
      standAs(0);
      layGrid(next.ground);
    },
    hasOtherObjects: (place) => other[place],
    setFrame(place, frame, scales, top) {
      shown[place] = frame !== undefined;
      if (!frame) return;
      poses[place] = poses[place].map((pose, i) => frame.objects[i]?.pose ?? pose);
      const joint = frame.joints.find((one) => one);
      if (things.children.length === 0 && place === 0 && joint && origin.lengthSq() === 0) {
        origin.copy(joint);
        layGrid(worlds[0].ground);
      }
      hands[place].update(frame, origin, scales);
      if (!other[place]) pressures[place].update(frame, worlds[place], origin, top);
    },
    setBeside: (next) => { beside = next; },
    setTogether: (next) => { together = next; },
    pick(x, y) {
      const half = beside && shown[1];
      const place = half ? Number(x > 0.5) : front();
      standAs(place);
      const across = half ? (x * 2) % 1 : x;
      raycaster.setFromCamera(new Vector2(2 * across - 1, 1 - 2 * y), camera);
      const seen = hands.flatMap((hand, i) => (shown[i] && (!half || i === place) ? [hand] : []));
      const targets: Object3D[] = seen.flatMap((hand) => [...hand.arrows, ...hand.arcs].filter((arrow) => arrow.group.visible).flatMap((arrow) => arrow.parts));
      const owner = (object: Object3D) => hands.findIndex((hand) => hand.group === object.parent?.parent || hand.group === object.parent);
      const arrow = raycaster.intersectObjects(targets, false)[0];
      if (arrow) return { kind: arrow.object.userData.kind, segment: arrow.object.userData.segment, place: owner(arrow.object) };
      const skins = seen.flatMap((hand) => hand.skins.filter((skin) => skin.visible));
      const skin = raycaster.intersectObjects(skins, false)[0];
      const thing = other[place] ? undefined : raycaster.intersectObjects(things.children, false)[0];
      if (thing && (!skin || thing.distance < skin.distance))
        return thing.object === still ? { place, kind: "triangle", triangle: thing.faceIndex! } : { place, kind: "object", object: thing.object.userData.object, triangle: thing.faceIndex! };
      return skin && { kind: "segment", segment: skin.object.userData.segment, place: owner(skin.object) };
    },
    select(pick) {
      hands.forEach((hand, place) => hand.select(isOfHand(pick) && pick.place === place ? pick.segment : -1));
      apart.forEach((mesh, i) => (mesh.material as MeshStandardMaterial).emissive.set(pick?.kind === "object" && pick.object === i ? "#332b00" : "#000000"));
      outline.visible = pick?.kind === "triangle";
      if (pick?.kind !== "triangle" || !still) return;
      const from = (still.geometry.getAttribute("position") as BufferAttribute).array.slice(9 * pick.triangle, 9 * pick.triangle + 9);
      outline.geometry.dispose();
      outline.geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(from as Float32Array, 3));
      outline.geometry.computeVertexNormals();
    },
    frameAll() {
      const box = new Box3();
      const skins = hands.flatMap((hand, place) => (shown[place] ? hand.skins.filter((skin) => skin.visible) : []));
      for (const { geometry } of skins) box.union(geometry.boundingSphere!.getBoundingBox(new Box3()));
      const room = box.isEmpty() ? 1.15 : 0.8;
      const near = box.clone().expandByScalar(kNear);
      standAs(front());
      if (box.isEmpty()) box.setFromObject(things);
      else for (const thing of things.children) box.union(new Box3().setFromObject(thing).intersect(near));
      const { center, radius } = box.isEmpty() ? new Sphere(new Vector3(), 0.1) : box.getBoundingSphere(new Sphere());
      controls.target.copy(center);
      camera.position.set(2.2, -2.9, 1.9).multiplyScalar(Math.min(Math.max(radius, 0.08), 0.25) * room).add(center);
      controls.update();
    },
    drag(point, right, down) {
      const away = camera.position.distanceTo(point.clone().sub(origin));
      const metres = (2 * away * Math.tan((camera.fov * Math.PI) / 360)) / canvas.clientHeight;
      const { elements: e } = camera.matrixWorld;
      point.addScaledVector(new Vector3(e[0], e[1], e[2]), right * metres).addScaledVector(new Vector3(e[4], e[5], e[6]), -down * metres);
    },
    animate: (picture) => renderer.setAnimationLoop(picture),
    inHeadset: () => renderer.xr.isPresenting,
    async enter({ session, space }) {
      const [position, turned, angle] = [camera.position.clone(), camera.quaternion.clone(), camera.fov];
      session.addEventListener("end", () => {
        renderer.xr.enabled = false;
        camera.position.copy(position);
        camera.quaternion.copy(turned);
        camera.fov = angle;
        controls.update();
        redraw();
      });
      renderer.xr.enabled = true;
      renderer.xr.setReferenceSpaceType("local");
      await renderer.xr.setSession(session);
      renderer.xr.setReferenceSpace(space.getOffsetReferenceSpace(new XRRigidTransform(origin)));
    },
    draw() {
      if (renderer.xr.isPresenting) {
        only(undefined);
        return renderer.render(scene, camera);
      }
      const { clientWidth: width, clientHeight: height } = canvas;
      if (width === 0 || height === 0) return;
      const ratio = Math.min(devicePixelRatio, 2);
      const size = renderer.getSize(new Vector2());
      if (size.x !== width || size.y !== height || renderer.getPixelRatio() !== ratio) {
        renderer.setPixelRatio(ratio);
        renderer.setSize(width, height, false);
      }
      const halves = beside && shown[1] ? [0, 1] : [undefined];
      renderer.setScissorTest(halves.length > 1);
      scene.background = null;
      renderer.setClearColor(new Color("#000000"), 0);
      camera.aspect = width / halves.length / height;
      camera.updateProjectionMatrix();
      halves.forEach((place, i) => {
        only(place);
        const x = (i * width) / halves.length;
        renderer.setViewport(x, 0, width / halves.length, height);
        renderer.setScissor(x, 0, width / halves.length, height);
        renderer.render(scene, camera);
      });
      only(undefined);
    },
  };
}
