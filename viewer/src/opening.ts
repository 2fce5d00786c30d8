// Opens recordings and sessions: one, a second beside it, both hands of one, a live one, the lab's.
import type { Divergence } from "./difference";
import { leaveLab } from "./feeling";
import { readWorld } from "./frame";
import { client, element, redraw, say, state, view } from "./page";
import { seek, show } from "./playing";
import { makePlots } from "./plots";
import { fillPlots, setRange, showsWindow } from "./range";
import { notice, scales, whole } from "./scales";
import { kForce, kTorque } from "./series";
import type { Opened, Source } from "./worker";

/** False: what is wrong was told. */
export async function open(place: number, source: Source, link: string): Promise<boolean> {
  say("");
  try {
    const opened = await client.open(place, source);
    if (place === 0) state.sides = [];
    state.sides[place] = { opened, link, marks: [], milliseconds: 0 };
    state.running = "live" in source;
    state.live = state.running || "lab" in source;
    document.body.classList.toggle("live", state.live);
    if (!("lab" in source)) leaveLab();
    together(false);
    if (place === 0) beginWith(opened);
    else await compareWith();
    if (place === 0 && opened.sides.length > 1) await openSecondHand(source, opened);
    document.body.classList.remove("empty");
    element("name").textContent = state.together ? opened.name : state.sides.map((side) => side.opened.name).join("  and  ");
    element("beside").hidden = state.sides.length < 2;
    if (!state.live) await show(state.wanted);
    return true;
  } catch (error) {
    say((error as Error).message, true);
    return false;
  }
}

export async function openFiles(files: File[]) {
  for (const [place, file] of files.entries()) await open(place, { file }, "");
}

function together(hands: boolean) {
  state.together = hands;
  state.plotted = 0;
  view.setTogether(hands);
}

/** Of a session of two hands the other one stands where a second recording would. */
async function openSecondHand(source: Source, one: Opened) {
  const opened = "live" in source ? { ...one } : await client.open(1, { ...source, hand: 1 } as Source);
  state.sides[1] = { opened, link: "", marks: [], milliseconds: 0 };
  together(true);
}

function beginWith(opened: Opened) {
  state.world = readWorld(opened.session);
  state.divergence = undefined;
  state.pick = undefined;
  view.setWorld(state.world);
  view.setFrame(1, undefined, scales(), 1);
  state.most = { force: 1, torque: 0.1, pressure: 1000 };
  view.frameAll();
  state.tick = state.wanted = opened.first;
  state.plots = makePlots(element("plots"), opened.rate, (from, to) => setRange(from * opened.rate, to * opened.rate), (time) => seek(time * opened.rate));
  setRange(opened.first, opened.last);
}

async function compareWith() {
  state.divergence = await client.diverge();
  const found = state.divergence;
  if (!found) return say("The two recordings are the same to the last bit.");
  state.sides[0].marks.push({ tick: found.tick, kind: "divergence", text: divergenceText(found) });
  say(divergenceText(found));
  seek(found.tick);
}

export function divergenceText({ tick, stage, field, a, b }: Divergence): string {
  return `They part at tick ${tick}, stage "${stage}", ${field}${a || b ? `: ${a} and ${b}` : ""}`;
}

client.onScanned = (place, columns, marks, share) => {
  const side = state.sides[place];
  if (!side) return;
  side.whole = columns;
  side.marks = [...marks, ...side.marks.filter((mark) => mark.kind === "divergence")].sort((a, b) => a.tick - b.tick);
  notice("force", ...whole(columns, kForce));
  notice("torque", ...whole(columns, kTorque).map((value) => 1e-3 * value));
  if (share === 1 || !showsWindow()) fillPlots();
  document.body.dataset.scanned = String(share);
  redraw();
};
