// What a tick looks like, by replaying: ticks in order carry their state on; anywhere else some ticks before are computed first,
// as many as forces take to fade, since a state depends on no more.
import { ByteBuffer } from "flatbuffers";
import type { Engine } from "./engine";
import type { Recording } from "./recording";
import { Session } from "../generated/lumbrical/fb/session";

export function makeReplay(engine: Engine, recording: Recording) {
  const fade = Session.getRootAsSession(new ByteBuffer(recording.session)).settings()?.fadeTime() ?? 0;
  const least = Math.ceil(2 * fade * recording.rate) + 1;
  let next = -1;  // the tick whose state the engine holds

  /** Computes what lies before the tick, farther and farther back until the state before it is the recorded one. */
  async function lead(tick: number) {
    for (let back = least; ; back *= 8) {
      let from = Math.max(recording.first, tick - back);
      const before = [];
      for (let i = from; i < tick; ++i) {
        const bytes = await recording.message(i);
        before.push(bytes);
        if (bytes === undefined) from = i + 1;  // behind a gap
      }
      engine.begin(from, from === recording.first);
      let known = from === recording.first;
      for (const bytes of before.slice(before.length - (tick - from))) known = engine.pass(bytes!);
      if (known || tick - back <= recording.first || back > 1000) return;
    }
  }

  /** Computes the few ticks from one to another, as when playing; false in a gap. */
  async function pass(from: number, to: number) {
    for (let tick = from; tick < to; ++tick) {
      const bytes = await recording.message(tick);
      if (bytes === undefined) return false;
      engine.pass(bytes);
    }
    return true;
  }

  /** A TickView, and the message it is of; none of either in a gap. */
  return async (tick: number) => {
    const bytes = await recording.message(tick);
    if (bytes === undefined) return undefined;
    const from = next;
    next = -1;
    if (from < 0 || tick < from || tick - from > least || !(await pass(from, tick))) await lead(tick);
    const view = engine.show(bytes);
    next = tick + 1;
    return { bytes, view };
  };
}
