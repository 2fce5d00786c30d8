// What a tick looks like, by replaying: ticks in order carry their state on; anywhere else some ticks before are computed first,
// as many as forces take to fade, since a state depends on no more but where objects or a proxy are felt.
import { ByteBuffer } from "flatbuffers";
import { countOf, kTableSize } from "./counts";
import type { Engine } from "./engine";
import type { Recording } from "./recording";
import { Session } from "../generated/lumbrical/fb/session";

const kFarBack = 1000;  // ticks, of which some keep their state where it reaches farther back than a fade

/** Objects felt apart, and the proxy, are where all ticks before have brought them. */
function reachesBack(session: Session): boolean {
  const objects = Array.from({ length: countOf(session.objectsLength(), kTableSize, session) }, (_, i) => session.objects(i)!);
  return (session.settings()?.proxyStiffness() ?? 0) > 0 || objects.some((object) => object.pose() !== null);
}

export function makeReplay(engine: Engine, recording: Recording) {
  const session = Session.getRootAsSession(new ByteBuffer(recording.session));
  const least = Math.ceil(2 * (session.settings()?.fadeTime() ?? 0) * recording.rate) + 1;
  const enough = reachesBack(session) ? kFarBack : least;
  let next = -1;  // the tick whose state the engine holds
  let settled = false;  // what it holds is what comes of the ticks before, not a guess behind a gap

  /** Nothing where the tick is missing, or its chunk damaged. */
  const messageOf = (tick: number) => recording.message(tick).catch(() => undefined);

  /** Computes what lies before the tick, farther and farther back until the state before it is the recorded one. */
  async function lead(tick: number) {
    for (let back = least; ; back *= 8) {
      const before: Uint8Array[] = [];
      let from = tick;
      for (const end = Math.max(recording.first, tick - back); from > end; --from) {
        const bytes = await messageOf(from - 1);
        if (bytes === undefined) break;  // behind a gap
        before.push(bytes);
      }
      engine.begin(from, from === recording.first);
      let known = from === recording.first;
      settled = known;
      for (const bytes of before.reverse()) {
        known = engine.pass(bytes);
        settled ||= known;
      }
      settled ||= before.length >= enough;
      if (known || from !== tick - back || back > kFarBack) return;
    }
  }

  /** Computes the few ticks from one to another, as when playing; false in a gap. */
  async function pass(from: number, to: number) {
    for (let tick = from; tick < to; ++tick) {
      const bytes = await messageOf(tick);
      if (bytes === undefined) return false;
      settled = engine.pass(bytes) || settled;
    }
    return true;
  }

  /** A TickView, the message it is of, and whether the state before it is known; nothing in a gap. */
  return async (tick: number) => {
    const bytes = await recording.message(tick);
    if (bytes === undefined) return undefined;
    const from = next;
    next = -1;
    if (from < 0 || tick < from || tick - from > least || !(await pass(from, tick))) await lead(tick);
    const view = engine.show(bytes);
    const shown = { bytes, view, settled };
    settled ||= engine.isRecorded();
    next = tick + 1;
    return shown;
  };
}
