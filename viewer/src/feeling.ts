// Ticks that come by themselves: from a session that runs, or from the lab.
import { makeLab, type Lab } from "./lab";
import { open } from "./opening";
import { client, element, rate, say, state, view } from "./page";
import { frameOpened, take } from "./playing";
import { setRange } from "./range";
import { makeColumns, pushRow } from "./series";
import type { Shown } from "./worker";

const kLiveKept = 1200;  // ticks, twenty seconds of what comes
let plotted = 0;

function feel(hand: number, shown: Shown | undefined) {
  const side = state.sides[hand];
  if (!shown || !side || !state.live) return;
  take(hand, shown, shown.tick);
  side.whole ??= makeColumns(kLiveKept);
  pushRow(side.whole, shown, rate());
  const [oldest, newest] = [side.whole.tick.find((tick) => tick > 0) ?? 0, shown.tick];
  [side.opened.first, side.opened.last] = [oldest, newest];
  if (hand !== state.plotted || performance.now() - plotted < 250) return;
  plotted = performance.now();
  setRange(oldest, newest);
  state.plots?.setData(side.whole, undefined);
}

let following = false;

/** The newest ticks of a session that runs, for every picture. */
export async function follow() {
  if (following) return;
  following = true;
  try {
    (await client.newest()).forEach((shown, hand) => feel(hand, shown));
    if (state.sides.every((side) => side.frame)) frameOpened();
  } catch (error) {
    state.running = false;
    say((error as Error).message, true);
  } finally {
    following = false;
  }
}

export function enterLab() {
  element("lab").hidden = false;
  state.lab = makeLab(element("lab"), {
    begin: (options) => open(0, { lab: options }, ""),
    save: () => void saveFelt(),
    enter: (tracking) => view.enter(tracking),
    say: (text) => say(text, true),
  });
  state.lab.position.set(-0.02, -0.115, 0.14);
}

export function leaveLab() {
  element("lab").hidden = true;
  state.lab?.leave();
  state.lab = undefined;
}

async function saveFelt() {
  const { file, leftOut } = await client.save();
  const link = document.createElement("a");
  link.href = URL.createObjectURL(file);
  link.download = "felt.mcap";
  link.click();
  if (leftOut > 0) say(`The last ${leftOut} ticks are not in it: ten minutes are kept.`);
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

let touching = false;

const kMostTicks = 4;  // for a picture; of a page that is slower than this the lab is slower too
let touched = 0;  // when [ms]
let due = 0;

/** How many ticks belong to the time since the picture before, whatever the screen's rate is. */
function ticksDue(): number {
  const now = performance.now();
  due = Math.min(due + ((now - touched) / 1000) * rate(), kMostTicks);
  touched = now;
  const ticks = Math.round(due);
  due -= ticks;
  return ticks;
}

/** The ticks until now; of a headset one for every picture, at whose rate its session is. */
export async function touch(lab: Lab, frame?: XRFrame) {
  if (touching || state.sides[0]?.opened.name !== "lab") return;
  const joints = lab.tracked(frame);
  if (joints === "") return;
  touching = true;
  try {
    for (let ticks = joints === undefined ? ticksDue() : 1; ticks > 0 && state.lab === lab; --ticks) {
      const shown = await client.touch(lab.hand(), joints);
      if (state.lab === lab) feel(0, shown);
    }
  } catch (error) {
    leaveLab();
    say((error as Error).message, true);
  } finally {
    touching = false;
  }
}
