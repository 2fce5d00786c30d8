// The lab: without a recording one's own hand, in a scene that is made in the page. Pointer and sliders move the hand, or a motion
// file, or a headset that sees it.
import { Quaternion, Euler, Vector3 } from "three";
import type { LabOptions, NamedFile } from "./engine";
import { isHandTrackingThere, trackHand, type Tracking } from "./tracking";
import { kFingers } from "./words";

const kObjects = ["mug", "sphere", "box", "bumpy field"];
const kLaws = ["field", "column", "max-depth (the paper's)", "centroid", "point"];
const kPrecisions = [0, 1e-5, 1e-4, 1e-3, 1e-2];
const kUnits = { "the file's own": 0, metres: 1, centimetres: 0.01, millimetres: 0.001, inches: 0.0254 };
const kHands = ["told by the file", "right", "left"];
const kByPointer = "pointer and sliders";
const kRate = 60;  // [Hz] a tick for every picture
const kMeshSize = 0.1;  // [m] largest extent of a mesh that is dropped
const kMeshes = [".obj", ".stl", ".ply", ".off"];
const kMotions = [".json", ".csv", ".bvh"];

// Sixty degrees of abduction are nobody's, so that sliders only bend: the joints of a finger in these shares [rad].
const kBend = [1.2, 1.5, 1.0];
const kThumbBend = [0.7, 0.7, 0.8];

export interface Lab {
  position: Vector3;  // [m] of the wrist
  /** Base pose and angles, as the engine takes them. */
  hand(): Float64Array;
  /** What a headset sees of the hand in this picture; "": nothing yet; undefined: there is no headset. */
  tracked(frame: XRFrame | undefined): string | undefined;
  take(file: File): Promise<void>;
  leave(): void;
}

export interface LabHost {
  /** Starts a session anew; false: what is wrong was told, and the one before goes on. */
  begin(options: LabOptions): Promise<boolean>;
  /** Offers what was felt as a file. */
  save(): void;
  /** Draws in the headset, until its session ends. */
  enter(tracking: Tracking): Promise<void>;
  say(text: string): void;
}

const isOf = (file: File, endings: string[]) => endings.some((ending) => file.name.toLowerCase().endsWith(ending));
export const isForLab = (file: File) => isOf(file, kMeshes) || isOf(file, kMotions);

function row(parent: HTMLElement, label: string, control: HTMLElement): HTMLElement {
  const line = document.createElement("label");
  const text = document.createElement("span");
  text.textContent = label;
  line.append(text, control);
  parent.append(line);
  return line;
}

function slider(parent: HTMLElement, label: string, low: number, high: number, value: number): HTMLInputElement {
  const input = document.createElement("input");
  Object.assign(input, { type: "range", min: String(low), max: String(high), step: "any", value: String(value) });
  row(parent, label, input);
  return input;
}

function choice(parent: HTMLElement, label: string, texts: string[], chosen = 0): HTMLSelectElement {
  const select = document.createElement("select");
  select.append(...texts.map((text, i) => new Option(text, String(i), i === chosen, i === chosen)));
  row(parent, label, select);
  return select;
}

function button(parent: HTMLElement, text: string, press: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.textContent = text;
  made.addEventListener("click", press);
  parent.append(made);
  return made;
}

function filePicker(parent: HTMLElement, text: string, endings: string[], pick: (file: File) => void) {
  const label = document.createElement("label");
  const input = document.createElement("input");
  label.className = "button";
  Object.assign(input, { type: "file", accept: endings.join(","), id: "lab-file" });
  input.addEventListener("change", () => {
    if (input.files?.[0]) pick(input.files[0]);
    input.value = "";
  });
  label.append(text, input);
  parent.append(label);
}

const read = async (file: File): Promise<NamedFile> => ({ name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) });

/** The last entry of a list is a file's, where there is one. */
function offer(select: HTMLSelectElement, name: string | undefined, count: number) {
  if (name === undefined) select.options.length = count;
  else select.options[count] = new Option(name, "", true, true);
}

export function makeLab(parent: HTMLElement, host: LabHost): Lab {
  parent.replaceChildren();
  const heading = document.createElement("h2");
  heading.textContent = "Lab: drag the hand, bend its fingers";
  const form = document.createElement("div");
  form.className = "lab";
  parent.append(heading, form);
  const object = choice(form, "Object (or drop a mesh)", kObjects);
  const law = choice(form, "Law", kLaws);
  const precision = choice(form, "Precision", kPrecisions.map((value) => (value === 0 ? "exact" : value.toExponential())), 2);
  const stiffness = slider(form, "Stiffness, 1e5 to 1e9 N/m³", 5, 9, Math.log10(2e7));
  const mover = choice(form, "Hand moved by (or drop a motion)", [kByPointer]);
  const unit = choice(form, "Unit of the motion", Object.keys(kUnits));
  const side = choice(form, "Hand of the motion", kHands);
  const all = slider(form, "All fingers", 0, 1, 0.15);
  const fingers = kFingers.slice(0, 5).map((finger) => slider(form, finger, 0, 1, 0.15));
  const turns = ["Turn", "Nod", "Roll"].map((label) => slider(form, label, -Math.PI, Math.PI, 0));
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  form.append(buttons);

  const position = new Vector3();
  let mesh: NamedFile | undefined;
  let file: NamedFile | undefined;  // a motion
  let refused = false;  // the newest motion: it may have been for want of its unit
  let tracking: Tracking | undefined;
  let follows = false;  // the session that is asked for is one of what the headset sees
  let begun = 0, asked = 0;  // sessions
  let left = false;

  const motion = (): LabOptions["motion"] => {
    const seen = tracking?.first();
    if (seen) return { name: "hand tracking", bytes: new TextEncoder().encode(seen), side: kHands.indexOf(tracking!.side()), unit: 0 };
    if (!file || mover.selectedIndex === 0) return undefined;
    return { ...file, side: side.selectedIndex, unit: Object.values(kUnits)[unit.selectedIndex] };
  };
  const showControls = (isMoved: boolean) => {
    const show = (controls: HTMLElement[], shown: boolean) => controls.forEach((control) => (control.parentElement!.hidden = !shown));
    show([unit, side], (isMoved || refused) && !follows);
    show([all, ...fingers], !isMoved);
    show([mover, ...turns], !follows);
  };
  const lists = [object, law, precision, mover, unit, side];
  const settings = () => ({ mesh, file, chosen: lists.map((list) => list.selectedIndex), stiffness: stiffness.value });
  let felt: ReturnType<typeof settings> | undefined;  // those of the session that runs
  const putBack = (to: NonNullable<typeof felt>) => {
    refused = file !== to.file;
    ({ mesh, file } = to);
    offer(object, mesh?.name, kObjects.length);
    offer(mover, file?.name, 1);
    lists.forEach((list, i) => (list.selectedIndex = to.chosen[i]));
    stiffness.value = to.stiffness;
    showControls(motion() !== undefined);
  };
  const restart = async () => {
    const mine = ++asked;
    const moved = motion();
    const wanted = settings();
    follows = moved !== undefined && tracking !== undefined;
    showControls(moved !== undefined);
    const good = await host.begin({
      object: object.selectedIndex,
      mesh: mesh && object.selectedIndex === kObjects.length ? { ...mesh, metres: kMeshSize } : undefined,
      motion: moved,
      law: law.selectedIndex,
      precision: kPrecisions[precision.selectedIndex],
      stiffness: 10 ** Number(stiffness.value),
      rate: follows ? tracking!.rate : kRate,
    });
    begun = Math.max(begun, mine);
    if (good) felt = wanted;
    else if (felt && mine === asked) putBack(felt);
    if (!good && follows) tracking?.end();
  };
  for (const control of [object, law, precision, stiffness, mover, unit, side]) control.addEventListener("change", () => void restart());
  all.addEventListener("input", () => fingers.forEach((finger) => (finger.value = all.value)));

  const take = async (given: File) => {
    const named = await read(given);
    if (isOf(given, kMeshes)) {
      mesh = named;
      offer(object, named.name, kObjects.length);
    } else {
      file = named;
      refused = false;
      offer(mover, named.name, 1);
    }
    await restart();
  };
  const follow = async () => {
    if (tracking) return tracking.end();
    try {
      tracking = await trackHand(() => {
        tracking = undefined;
        if (follows && !left) void restart();
      });
      await host.enter(tracking);
    } catch (error) {
      tracking?.end();
      host.say(`hand tracking: ${(error as Error).message}`);
    }
  };
  filePicker(buttons, "Open a mesh or a motion", [...kMeshes, ...kMotions], (picked) => void take(picked));
  button(buttons, "Save what was felt", host.save);
  const headset = button(buttons, "Hand tracking", () => void follow());
  headset.hidden = true;
  void isHandTrackingThere().then((there) => (headset.hidden = !there));

  void restart();
  return {
    position, take,
    leave() {
      left = true;
      tracking?.end();
    },
    hand() {
      const out = new Float64Array(27);
      const turn = new Quaternion().setFromEuler(new Euler(Math.PI / 2 + Number(turns[1].value), Number(turns[2].value), Number(turns[0].value), "ZXY"));
      out.set([position.x, position.y, position.z, turn.w, turn.x, turn.y, turn.z]);
      fingers.forEach((finger, f) => (f === 0 ? kThumbBend : kBend).forEach((most, k) => (out[7 + 4 * f + 1 + k] = most * Number(finger.value))));
      return out;
    },
    tracked(frame) {
      if (!tracking) return undefined;
      const seen = frame && tracking.joints(frame);
      if (seen && !follows) void restart();  // with this hand's radii
      return (follows && begun === asked && seen) || "";
    },
  };
}
