// What a pointer does: turn and pick in the scene, drag the lab's hand, seek in the timeline, drop and pick files.
import { tipText } from "./details";
import { enterLab } from "./feeling";
import { isForLab } from "./lab";
import { open, openFiles } from "./opening";
import { canvas, element, first, last, renew, state, strip, toldOf, view } from "./page";
import { seek } from "./playing";
import { fillPlots } from "./range";
import { isOfHand, type Pick } from "./scene";

function pickAt(event: PointerEvent): Pick | undefined {
  const box = canvas.getBoundingClientRect();
  return view.pick((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
}

let pressed = { x: 0, y: 0 };
let held: PointerEvent | undefined;  // the lab's hand, by it
canvas.addEventListener("pointerdown", (event) => {
  pressed = { x: event.clientX, y: event.clientY };
  const pick = state.lab && event.isPrimary ? pickAt(event) : undefined;
  held = isOfHand(pick) ? event : undefined;
  view.controls.enabled = held === undefined;
}, true);
addEventListener("pointerup", () => {
  held = undefined;
  view.controls.enabled = true;
});
canvas.addEventListener("pointermove", (event) => {
  if (!held || !state.lab) return;
  view.drag(state.lab.position, event.clientX - held.clientX, event.clientY - held.clientY);
  held = event;
});
canvas.addEventListener("pointerup", (event) => {
  if (Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > 4) return;
  state.pick = pickAt(event);
  view.select(state.pick);
  if (isOfHand(state.pick) && state.pick.place !== state.plotted) {
    state.plotted = state.pick.place;
    void fillPlots();
  }
  renew();
});
canvas.addEventListener("pointermove", (event) => {
  const tip = element("tip");
  const pick = event.buttons === 0 ? pickAt(event) : undefined;
  tip.textContent = pick ? tipText(pick, toldOf(pick)) : "";
  tip.hidden = tip.textContent === "";
  const box = canvas.getBoundingClientRect();
  tip.style.left = `${Math.min(event.clientX - box.left + 14, box.width - 200)}px`;
  tip.style.top = `${event.clientY - box.top + 14}px`;
});
canvas.addEventListener("pointerleave", () => { element("tip").hidden = true; });

const seekAt = (event: PointerEvent) => {
  const box = strip.getBoundingClientRect();
  seek(first() + ((event.clientX - box.left) / box.width) * (last() - first()));
};
strip.addEventListener("pointerdown", (event) => { strip.setPointerCapture(event.pointerId); seekAt(event); });
strip.addEventListener("pointermove", (event) => { if (event.buttons) seekAt(event); });

for (const [id, place] of [["open", 0], ["open-other", 1]] as const) {
  const input = element<HTMLInputElement>(id);
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    if (file) void open(state.sides.length === 0 || state.live ? 0 : place, { file }, "");  // nothing is compared with what goes on
    input.value = "";
  });
}
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("drop"); });
addEventListener("dragleave", () => document.body.classList.remove("drop"));
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("drop");
  const touched = [...(event.dataTransfer?.files ?? [])].find(isForLab);
  if (touched) {
    if (!state.lab) enterLab();
    return void state.lab?.take(touched);
  }
  void openFiles([...(event.dataTransfer?.files ?? [])].slice(0, 2));
});
