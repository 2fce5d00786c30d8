// Time: which tick is shown, and how the page gets to another.
import { readFrame } from "./frame";
import { client, element, first, last, marks, rate, say, state, view, type Side } from "./page";
import { pressureOf } from "./pressure";
import { kArcCount, notice, setFrame } from "./scales";
import { kMarks } from "./timeline";
import type { Shown } from "./worker";

let asking = false;

/** Shows the newest tick asked for, of what is open by then; those that come too fast are passed over. */
export async function show(tick: number) {
  state.wanted = tick;
  if (asking) return;
  asking = true;
  try {
    let shown = NaN, sides: Side[] = [];
    while (!state.live && (shown !== Math.floor(state.wanted) || sides !== state.sides)) {
      [shown, sides] = [Math.floor(state.wanted), state.sides];
      const ticks = await Promise.all(sides.map((_, place) => client.show(place, shown)));
      if (sides !== state.sides) continue;
      ticks.forEach((one, place) => take(place, one, shown));
      frameOpened();
    }
  } catch (error) {
    setPlaying(false);
    say((error as Error).message, true);
  } finally {
    asking = false;
  }
}

export function take(place: number, shown: Shown | undefined, tick: number) {
  const side = state.sides[place];
  if (!side) return;
  side.frame = shown && readFrame(shown);
  state.tick = tick;
  side.missing = shown === undefined;
  side.milliseconds = shown?.milliseconds ?? 0;
  const { forces, jointTorques, contacts } = side.frame ?? { forces: [], jointTorques: [], contacts: [] };
  notice("force", forces.map((force) => force.length()));
  notice("torque", jointTorques.slice(0, kArcCount).map((torque) => torque.length()));
  notice("pressure", contacts.map((contact) => pressureOf(contact, side.world)));
  setFrame(place);
}

/** Of what was opened, once: later the camera is the person's. */
export function frameOpened() {
  if (state.unframed) view.frameAll();
  state.unframed = false;
}

export function seek(tick: number) {
  if (state.live || state.sides.length === 0) return;
  void show(Math.round(Math.min(Math.max(tick, first()), last())));
}

/** From the tick that is asked for, which a slow page may not show yet. */
export const step = (ticks: number) => seek(Math.floor(state.wanted) + ticks);

export function setPlaying(playing: boolean) {
  if (playing && (state.live || state.sides.length === 0)) return;
  state.playing = playing;
  if (playing && state.wanted >= last()) state.wanted = first();
  element("play").textContent = playing ? "❚❚ Pause" : "▶ Play";
}

export function advance(seconds: number) {
  const [begin, end] = state.looping ? [state.from, state.to] : [first(), last()];
  let next = state.wanted + seconds * state.speed * rate();
  if (state.looping && (next > end || next < begin)) next = begin;
  if (next >= end && !state.looping) {
    next = end;
    setPlaying(false);
  }
  void show(next);
}

export function jump(direction: 1 | -1) {
  const ahead = marks().filter((mark) => (mark.tick - Math.floor(state.wanted)) * direction > 0);
  const to = ahead.at(direction > 0 ? 0 : -1);
  if (!to) return say("No further mark.");
  seek(to.tick);
  say(`${kMarks[to.kind].sign} tick ${to.tick}: ${to.text}`);
}
