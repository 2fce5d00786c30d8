// A session while it runs: `lumbrical run --view` sends messages, each behind its length in four bytes: the session first, then
// the newest tick sixty times a second. Contacts are computed here.
import { ByteBuffer } from "flatbuffers";
import type { Engine } from "./engine";
import type { Answer, Opened } from "./worker";
import { Session } from "../generated/lumbrical/fb/session";
import { Tick } from "../generated/lumbrical/fb/tick";

const kMostBytes = 2 ** 31;

async function* messages(body: ReadableStream<Uint8Array>): AsyncGenerator<Uint8Array> {
  let have: Uint8Array = new Uint8Array();
  const reader = body.getReader();
  for (;;) {
    while (have.length >= 4) {
      const length = new DataView(have.buffer, have.byteOffset).getUint32(0, true);
      if (length > kMostBytes) throw new Error("live: the stream is damaged");
      if (have.length < 4 + length) break;
      yield have.slice(4, 4 + length);
      have = have.subarray(4 + length);
    }
    const { value, done } = await reader.read();
    if (done) return;
    const more = new Uint8Array(have.length + value.length);
    more.set(have);
    more.set(value, have.length);
    have = more;
  }
}

export async function openLive(url: string, engine: Engine, tell: (answer: Answer) => void): Promise<Opened> {
  const response = await fetch(url, { cache: "no-store" });
  if (!response.ok || response.body === null) throw new Error(`live: the program answers ${response.status}`);
  const stream = messages(response.body);
  const { value: session } = await stream.next();
  if (!session) throw new Error("live: the session ended before it began");
  let noContacts = "";
  try {
    engine.open(session, new Uint8Array());
  } catch (error) {
    noContacts = (error as Error).message;
  }
  const follow = async () => {
    for await (const message of stream) {
      const start = performance.now();
      const tick = Number(Tick.getRootAsTick(new ByteBuffer(message)).tick());
      engine.begin(tick, false);
      const view = noContacts ? undefined : engine.show(message);
      tell({ type: "live", shown: { tick, message, view, milliseconds: performance.now() - start } });
    }
    tell({ type: "live", error: "the session has ended" });
  };
  follow().catch((error: Error) => tell({ type: "live", error: error.message }));
  const rate = Session.getRootAsSession(new ByteBuffer(session)).settings()?.rate() ?? 1000;
  return { name: "live", sides: [], bytes: 0n, session, rate, first: 0, last: 0, metadata: new Map(), noContacts };
}
