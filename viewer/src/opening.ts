// Opens recordings and sessions: one, a second beside it, both hands of one, a live one, the lab's.
import type { Comparison, Divergence } from "./difference";
import { leaveLab } from "./feeling";
import { hasSameObjects, readWorld } from "./frame";
import { client, element, first, last, redraw, renew, say, state, view, type Side } from "./page";
import { seek, setPlaying, show } from "./playing";
import { makePlots } from "./plots";
import { fillPlots, setRange, showsWindow } from "./range";
import { kArcCount, notice, scales, whole } from "./scales";
import { kForce, kTorque } from "./series";
import { arithmeticText, kSegmentCount } from "./words";
import type { Opened, Source } from "./worker";

let openings: Promise<unknown> = Promise.resolve();

/** One after the other, however fast they are asked for. False: what is wrong was told. */
export async function open(place: number, source: Source, link: string): Promise<boolean> {
  const opening = openings.then(() => openNow(place, source, link));
  openings = opening;
  const side = await opening;
  if (side && place === 1) await compareWith(side);
  return side !== undefined;
}

async function openNow(place: number, source: Source, link: string): Promise<Side | undefined> {
  if ("lab" in source && !state.lab) return undefined;  // it was left before its turn came
  say("");
  try {
    const opened = await client.open(place, source);
    const side = sideOf(opened, link);
    const staysInLab = "lab" in source && state.sides[0]?.opened.name === "lab" && hasSameObjects(state.sides[0].world, side.world);
    if (place === 0) setPlaying(false);
    const showsAll = state.from <= first() && state.to >= last();
    state.sides = place === 0 ? [side] : [state.sides[0], side];
    state.compared = "not yet";
    state.running = "live" in source;
    state.live = state.running || "lab" in source;
    document.body.classList.toggle("live", state.live);
    if (!("lab" in source)) leaveLab();
    together(false);
    state.pick = undefined;
    view.select(undefined);
    view.setWorld(place, side.world);
    if (place === 0) beginWith(side, !staysInLab);
    else if (showsAll) setRange(first(), last());
    if (place === 0 && opened.sides.length > 1) await openSecondHand(source, opened);
    document.body.classList.remove("empty");
    element("name").textContent = state.together ? opened.name : state.sides.map((side) => side.opened.name).join("  and  ");
    element("beside").hidden = state.sides.length < 2;
    if (!state.live) await show(state.wanted);
    return side;
  } catch (error) {
    say((error as Error).message, true);
    return undefined;
  }
}

export async function openFiles(files: File[]) {
  for (const [place, file] of files.entries()) if (!(await open(place, { file }, ""))) return;
}

const sideOf = (opened: Opened, link: string): Side => ({ opened, world: readWorld(opened.session), link, missing: false, marks: [], milliseconds: 0 });

function together(hands: boolean) {
  state.together = hands;
  state.plotted = 0;
  view.setTogether(hands);
}

/** Of a session of two hands the other one stands where a second recording would. */
async function openSecondHand(source: Source, one: Opened) {
  const opened = "live" in source ? { ...one } : await client.open(1, { ...source, hand: 1 } as Source);
  state.sides = [state.sides[0], sideOf(opened, "")];
  view.setWorld(1, state.sides[1].world);
  together(true);
}

function beginWith({ opened }: Side, anew: boolean) {
  for (const place of anew ? [0, 1] : [1]) view.setFrame(place, undefined, scales(), 1);
  state.most = { force: 1, torque: 0.1, pressure: 1000 };
  if (anew) view.frameAll();
  state.unframed = !state.lab;
  state.tick = state.wanted = opened.first;
  state.plots?.destroy();
  state.plots = makePlots(element("plots"), opened.rate, (from, to) => setRange(from * opened.rate, to * opened.rate), (time) => seek(time * opened.rate));
  setRange(opened.first, opened.last);
}

async function compareWith(side: Side) {
  const comparison = await client.compare().catch((error: Error) => error);
  if (state.sides[1] !== side) return;  // another one was opened meanwhile
  renew();
  if (comparison instanceof Error) {
    state.compared = `not to the end: ${comparison.message}`;
    return say(comparison.message, true);
  }
  const found = comparison.divergence;
  state.compared = found ? divergenceText(found) : samenessText(comparison);
  say(state.compared);
  if (!found) return;
  side.marks.push({ tick: found.tick, kind: "divergence", text: state.compared });
  seek(found.tick);
}

function divergenceText({ hand, tick, stage, field, a, b }: Divergence): string {
  const [first, second] = state.sides.map(({ opened }) => opened.metadata.get("arithmetic"));
  const why = stage === "input" ? "" : arithmeticText(second, "the first", first);
  return `They part at tick ${tick}${hand && ` of the ${hand} hand`}, stage "${stage}", ${field}${a || b ? `: ${a} and ${b}` : ""}${why}`;
}

function samenessText({ hands, ticks, missing }: Comparison): string {
  if (ticks === 0) return "Nothing: they have no ticks";
  const whose = hands.length > 1 ? ` of the ${hands.join(" and the ")} hand` : "";
  return `The same to the last bit in all ${ticks} ticks${whose}${missing > 0 ? `; ${missing} more are missing in both` : ""}`;
}

client.onScanned = (place, columns, marks, share) => {
  const side = state.sides[place];
  if (!side) return;
  side.whole = columns;
  side.marks = [...marks, ...side.marks.filter((mark) => mark.kind === "divergence")];
  notice("force", whole(columns, kForce, kSegmentCount));
  notice("torque", whole(columns, kTorque, kArcCount).map((value) => 1e-3 * value));
  if (share === 1 || !showsWindow()) fillPlots();
  document.body.dataset.scanned = String(share);
  redraw();
};
