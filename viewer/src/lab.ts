// The lab: without a recording one's own hand, by pointer and sliders, in a scene that is made in the page.
import { Quaternion, Euler, Vector3 } from "three";
import type { LabOptions } from "./engine";
import { kFingers } from "./words";

const kObjects = ["mug", "sphere", "box", "bumpy field"];
const kLaws = ["field", "column", "max-depth (the paper's)", "centroid", "point"];
const kPrecisions = [0, 1e-5, 1e-4, 1e-3, 1e-2];
const kRate = 60;  // [Hz] a tick for every picture
const kMeshSize = 0.1;  // [m] largest extent of a mesh that is dropped

export interface Lab {
  position: Vector3;  // [m] of the wrist
  /** Base pose and angles, as the engine takes them. */
  hand(): Float64Array;
  drop(mesh: File): Promise<void>;
}

// Sixty degrees of abduction are nobody's, so that sliders only bend: the joints of a finger in these shares [rad].
const kBend = [1.2, 1.5, 1.0];
const kThumbBend = [0.7, 0.7, 0.8];

function row(parent: HTMLElement, label: string, control: HTMLElement) {
  const line = document.createElement("label");
  const text = document.createElement("span");
  text.textContent = label;
  line.append(text, control);
  parent.append(line);
}

function slider(parent: HTMLElement, label: string, low: number, high: number, value: number): HTMLInputElement {
  const input = document.createElement("input");
  Object.assign(input, { type: "range", min: String(low), max: String(high), step: "any", value: String(value) });
  row(parent, label, input);
  return input;
}

function choice(parent: HTMLElement, label: string, texts: string[], chosen: number): HTMLSelectElement {
  const select = document.createElement("select");
  select.append(...texts.map((text, i) => new Option(text, String(i), i === chosen, i === chosen)));
  row(parent, label, select);
  return select;
}

/** `begin` starts a session anew; `save` offers what was felt as a file. */
export function makeLab(parent: HTMLElement, begin: (options: LabOptions) => void, save: () => void): Lab {
  parent.replaceChildren();
  const heading = document.createElement("h2");
  heading.textContent = "Lab: drag the hand, bend its fingers";
  const form = document.createElement("div");
  form.className = "lab";
  parent.append(heading, form);
  const object = choice(form, "Object (or drop a mesh)", kObjects, 0);
  const law = choice(form, "Law", kLaws, 0);
  const precision = choice(form, "Precision", kPrecisions.map((value) => (value === 0 ? "exact" : value.toExponential())), 2);
  const stiffness = slider(form, "Stiffness, 1e5 to 1e9 N/m³", 5, 9, Math.log10(2e7));
  const all = slider(form, "All fingers", 0, 1, 0.15);
  const fingers = kFingers.slice(0, 5).map((finger) => slider(form, finger, 0, 1, 0.15));
  const turns = ["Turn", "Nod", "Roll"].map((label) => slider(form, label, -Math.PI, Math.PI, 0));
  const button = document.createElement("button");
  button.textContent = "Save what was felt";
  form.append(button);

  const position = new Vector3();
  let mesh: LabOptions["mesh"];
  const restart = () =>
    begin({
      object: object.selectedIndex,
      mesh,
      law: law.selectedIndex,
      precision: kPrecisions[precision.selectedIndex],
      stiffness: 10 ** Number(stiffness.value),
      rate: kRate,
    });
  for (const control of [object, law, precision, stiffness]) control.addEventListener("change", restart);
  all.addEventListener("input", () => fingers.forEach((finger) => (finger.value = all.value)));
  button.addEventListener("click", save);

  restart();
  return {
    position,
    hand() {
      const out = new Float64Array(27);
      const turn = new Quaternion().setFromEuler(new Euler(Math.PI / 2 + Number(turns[1].value), Number(turns[2].value), Number(turns[0].value), "ZXY"));
      out.set([position.x, position.y, position.z, turn.w, turn.x, turn.y, turn.z]);
      fingers.forEach((finger, f) => (f === 0 ? kThumbBend : kBend).forEach((most, k) => (out[7 + 4 * f + 1 + k] = most * Number(finger.value))));
      return out;
    },
    async drop(file) {
      mesh = { name: file.name, bytes: new Uint8Array(await file.arrayBuffer()), metres: kMeshSize };
      object.options[kObjects.length] = new Option(file.name, "", true, true);
      restart();
    },
  };
}
