// A session while it runs: `lumbrical run --view` sends messages, each behind its length in four bytes and the number of its hand
// in one: the session first, then every hand's newest tick sixty times a second. Contacts are computed here, of as many ticks as the
// page asks for: one that is slower than the session shows fewer, and never old ones.
import { ByteBuffer } from "flatbuffers";
import type { Engine } from "./engine";
import { sidesOf } from "./recording";
import type { Opened, Shown } from "./worker";
import { Session } from "../generated/lumbrical/fb/session";
import { Tick } from "../generated/lumbrical/fb/tick";

const kMostBytes = 2 ** 31;
const kHead = 5;

interface Sent {
  hand: number;
  message: Uint8Array;
}

/** Answers the stream's next so many bytes, once all of them have come; nothing where it ends before. */
function takerOf(body: ReadableStream<Uint8Array>) {
  const reader = body.getReader();
  let rest: Uint8Array = new Uint8Array();
  return async (count: number): Promise<Uint8Array | undefined> => {
    const pieces = [rest];
    for (let have = rest.length; have < count; have += pieces.at(-1)!.length) {
      const { value, done } = await reader.read().catch(() => { throw new Error("the session was cut off"); });
      if (done) return undefined;
      pieces.push(value);
    }
    const taken = new Uint8Array(count);
    let at = 0;
    for (const piece of pieces) {
      const part = piece.subarray(0, count - at);
      taken.set(part, at);
      at += part.length;
      rest = piece.subarray(part.length);
    }
    return taken;
  };
}

async function* messages(body: ReadableStream<Uint8Array>): AsyncGenerator<Sent> {
  const take = takerOf(body);
  for (let head = await take(kHead); head; head = await take(kHead)) {
    const length = new DataView(head.buffer).getUint32(0, true);
    if (length > kMostBytes) throw new Error("live: the stream is damaged");
    const message = await take(length);
    if (!message) return;
    yield { hand: head[4], message };
  }
}

// Where a proxy stands depends on the ticks before, of which few come here.
const kNoProxy = "the proxy is not known while the session runs, nor what it touches: the hand is drawn where it is tracked";
const kProxyStiffness = 22;  // the field's place in Settings

/** The same session with a hand that has none; nothing where it has none anyway. */
function withoutProxy(session: Uint8Array): Uint8Array | undefined {
  const settings = Session.getRootAsSession(new ByteBuffer(session.slice())).settings();
  if (!settings || settings.proxyStiffness() === 0) return undefined;
  const { bb, bb_pos: at } = settings;
  bb!.writeFloat64(at + bb!.__offset(at, kProxyStiffness), 0);
  if (settings.proxyStiffness() !== 0) throw new Error("live: the schema's settings have moved");
  return bb!.bytes();
}

export interface Live {
  opened: Opened;
  /** Of every hand the newest tick that was not shown yet, where there is one. Throws when the session has ended. */
  newest(): (Shown | undefined)[];
  close(): void;
}

export async function openLive(url: string, load: () => Promise<Engine>): Promise<Live> {
  const closing = new AbortController();
  const response = await fetch(url, { cache: "no-store", signal: closing.signal });
  if (!response.ok || response.body === null) throw new Error(`live: the program answers ${response.status}`);
  const stream = messages(response.body);
  const { value: began } = await stream.next();
  if (!began) throw new Error("live: the session ended before it began");
  const session = began.message;
  const sides = sidesOf(session);
  const engines = await Promise.all(sides.map(load));
  const placed = withoutProxy(session);
  let noContacts = "";
  try {
    for (const [hand, engine] of engines.entries()) noContacts = engine.open(placed ?? session, new Uint8Array(), hand);
  } catch (error) {
    noContacts = (error as Error).message;
    engines.length = 0;  // none of them is of use
  }
  if (placed) noContacts ||= kNoProxy;
  const waiting: (Uint8Array | undefined)[] = sides.map(() => undefined);
  let end = "";
  const receive = async () => {
    for await (const { hand, message } of stream) {
      if (hand >= sides.length) throw new Error("live: the stream is damaged");
      waiting[hand] = message;
    }
    throw new Error("the session has ended");
  };
  receive().catch((error: Error) => { end = error.message; });
  const showNewest = (message: Uint8Array | undefined, hand: number): Shown | undefined => {
    if (!message) return undefined;
    waiting[hand] = undefined;
    const start = performance.now();
    const tick = Number(Tick.getRootAsTick(new ByteBuffer(message)).tick());
    engines[hand]?.begin(tick, false);
    const view = engines[hand]?.show(message);
    return { tick, message, view, handOnly: placed !== undefined, milliseconds: performance.now() - start };
  };
  const rate = Session.getRootAsSession(new ByteBuffer(session)).settings()?.rate() ?? 1000;
  return {
    opened: { name: "live", sides, bytes: 0n, session, rate, first: 0, last: 0, metadata: new Map(), noContacts },
    newest() {
      if (end && waiting.every((message) => !message)) throw new Error(end);
      return waiting.map(showNewest);
    },
    close: () => closing.abort(),
  };
}
