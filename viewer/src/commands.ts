// Keys and buttons, and what they do.
import { enterLab } from "./feeling";
import { fillHelp, listenToKeys, type Command } from "./keys";
import { element, first, last, redraw, renew, state, strip, view } from "./page";
import { jump, seek, setPlaying, step } from "./playing";
import { setRange } from "./range";

const kSpeeds = [0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 4];

function turn(around: number, up: number) {
  const offset = view.camera.position.clone().sub(view.controls.target);
  offset.applyAxisAngle(view.camera.up, around);
  offset.applyAxisAngle(offset.clone().cross(view.camera.up).normalize(), up);
  view.camera.position.copy(view.controls.target).add(offset);
  view.controls.update();
}

function toggleTheme() {
  const root = document.documentElement;
  root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
  state.plots?.setTheme();
  renew();
}

function toggleLoop() {
  state.looping = !state.looping;
  element("loop").setAttribute("aria-pressed", String(state.looping));
}

function toggleBeside() {
  state.beside = !state.beside;
  view.setBeside(state.beside);
  element("beside").setAttribute("aria-pressed", String(state.beside));
  renew();
}

function changeSpeed(by: number) {
  state.speed = kSpeeds[Math.min(Math.max(kSpeeds.indexOf(state.speed) + by, 0), kSpeeds.length - 1)];
  element<HTMLSelectElement>("speed").value = String(state.speed);
}

const help = element<HTMLDialogElement>("help");
const commands: Command[] = [
  { keys: [" "], text: "play or pause", run: () => setPlaying(!state.playing) },
  { keys: ["ArrowLeft"], text: "one tick back; with shift a hundred", run: (event) => step(event.shiftKey ? -100 : -1) },
  { keys: ["ArrowRight"], text: "one tick on; with shift a hundred", run: (event) => step(event.shiftKey ? 100 : 1) },
  { keys: ["Home"], text: "to the start", run: () => seek(first()) },
  { keys: ["End"], text: "to the end", run: () => seek(last()) },
  { keys: ["["], text: "the mark before", run: () => jump(-1) },
  { keys: ["]"], text: "the next mark", run: () => jump(1) },
  { keys: ["-"], text: "slower", run: () => changeSpeed(-1) },
  { keys: ["+", "="], text: "faster", run: () => changeSpeed(1) },
  { keys: ["l"], text: "play what the plots show again and again", run: toggleLoop },
  { keys: ["Escape"], text: "plots show everything again, nothing is selected", run: () => { state.pick = undefined; view.select(undefined); setRange(first(), last()); renew(); } },
  { keys: ["a"], text: "camera to the left", run: () => turn(-0.1, 0) },
  { keys: ["d"], text: "camera to the right", run: () => turn(0.1, 0) },
  { keys: ["w"], text: "camera up", run: () => turn(0, -0.1) },
  { keys: ["s"], text: "camera down", run: () => turn(0, 0.1) },
  { keys: ["f"], text: "camera to the hand and what is near it", run: () => view.frameAll() },
  { keys: ["c"], text: "two recordings side by side, or one over the other", run: toggleBeside },
  { keys: ["o"], text: "open a recording", run: () => element("open").click() },
  { keys: ["t"], text: "light or dark", run: toggleTheme },
  { keys: ["?"], text: "this help", run: () => (help.open ? help.close() : help.showModal()) },
];
listenToKeys(commands);
fillHelp(help, commands);
const press = (id: string, run: () => void) => element(id).addEventListener("click", run);
press("lab-button", enterLab);
press("play", () => setPlaying(!state.playing));
press("to-start", () => seek(first()));
press("back", () => step(-1));
press("forward", () => step(1));
press("mark-back", () => jump(-1));
press("mark-forward", () => jump(1));
press("loop", toggleLoop);
press("whole", () => setRange(first(), last()));
press("theme", toggleTheme);
press("beside", toggleBeside);
press("help-button", () => help.showModal());
const speed = element<HTMLSelectElement>("speed");
speed.append(...kSpeeds.map((value) => new Option(`${value} ×`, String(value), value === 1, value === 1)));
speed.addEventListener("change", () => { state.speed = Number(speed.value); });
new ResizeObserver(redraw).observe(element("scene"));
new ResizeObserver(redraw).observe(strip);
