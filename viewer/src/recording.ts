// A recording through its MCAP index: a tick is found by its time, and only the chunk it lies in is read.
import { McapIndexedReader } from "@mcap/core";
import { ByteBuffer } from "flatbuffers";
import type { Bytes } from "./bytes";
import { messagesOf } from "./chunk";
import { Session } from "../generated/lumbrical/fb/session";
import { Side } from "../generated/lumbrical/fb/side";

export interface Recording {
  name: string;
  sides: string[];  // of the session's hands, "left" or "right", one or two
  hand: number;  // which of them the ticks are of
  bytes: bigint;
  session: Uint8Array;  // the message, as it stands in the file
  state: Uint8Array;  // empty where the file begins with its session
  rate: number;  // [Hz]
  first: number;  // tick
  last: number;
  metadata: ReadonlyMap<string, string>;
  chunkCount: number;
  chunk(index: number): Promise<Chunk>;
  /** Nothing where the tick is missing. */
  message(tick: number): Promise<Uint8Array | undefined>;
  /** The first tick from this one on that is not missing; behind the last one none. */
  next(tick: number): Promise<number>;
}

/** Messages of ticks by their numbers, ascending. They lie in the memory of their chunk: who keeps one or posts it takes a copy. */
export type Chunk = ReadonlyMap<number, Uint8Array>;

const kStates = ["state", "state of the second hand"];
const kMagic = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
const kChunksKept = 24;
const kBytesKept = 1 << 25;  // of their contents; what a recorder writes has a megabyte each
const kLargestRecord = 17n << 20n;  // of a chunk: what cannot be compressed grows a little

async function openMcap(bytes: Bytes) {
  const size = await bytes.size();
  const start = size >= 8n ? await bytes.read(0n, 8n) : new Uint8Array();
  if (!kMagic.every((byte, i) => start[i] === byte))
    throw new Error(`${bytes.name}: byte 0: not a recording; an MCAP file begins with "MCAP0", this one does not`);
  const end = await bytes.read(size - 8n, 8n);
  if (!kMagic.every((byte, i) => end[i] === byte))
    throw new Error(`${bytes.name}: byte ${size}: the file is torn, its index is missing. ` +
      `What is whole comes back by\n  lumbrical recover ${bytes.name} --output whole.mcap`);
  try {
    return await McapIndexedReader.Initialize({ readable: bytes });
  } catch (error) {
    throw new Error(`${bytes.name}: the index near byte ${size} is damaged (${(error as Error).message}). ` +
      `What is whole comes back by\n  lumbrical recover ${bytes.name} --output whole.mcap`);
  }
}

/** A small file could otherwise be read without end. */
function refuseOverlaps(chunks: { chunkStartOffset: bigint; chunkLength: bigint }[], name: string) {
  let end = 0n;
  for (const { chunkStartOffset: start, chunkLength } of [...chunks].sort((a, b) => Number(a.chunkStartOffset - b.chunkStartOffset))) {
    if (start < end) throw new Error(`${name}: byte ${start}: the index points to a chunk twice. What is whole comes back by\n  lumbrical recover ${name} --output whole.mcap`);
    end = start + chunkLength;
  }
}

/** "left" or "right", of each hand of a session. */
export function sidesOf(session: Uint8Array): string[] {
  const message = Session.getRootAsSession(new ByteBuffer(session));
  return [message.hand(), message.secondHand()].flatMap((one) => (one ? [one.side() === Side.left ? "left" : "right"] : []));
}

/** The ticks of one hand of the file. */
export async function openRecording(bytes: Bytes, hand = 0): Promise<Recording> {
  const reader = await openMcap(bytes);
  const attachments = new Map<string, Uint8Array>();
  for await (const attachment of reader.readAttachments()) attachments.set(attachment.name, attachment.data);
  const session = attachments.get("session");
  const sides = session ? sidesOf(session) : [];
  const topic = sides.length > 1 ? `${sides[hand]}/tick` : "tick";
  const topics = [...reader.channelsById.values()].map((channel) => channel.topic);
  const channel = [...reader.channelsById.values()].find((one) => one.topic === topic)?.id;
  if (session === undefined || channel === undefined)
    throw new Error(`${bytes.name}: an MCAP file, but none of Lumbrical's: it has no ` +
      `${session === undefined ? 'attachment "session"' : `channel "${topic}"`}. Its channels: ${topics.join(", ") || "none"}`);
  const statistics = reader.statistics;
  if (statistics === undefined || statistics.messageCount === 0n) throw new Error(`${bytes.name}: holds no ticks`);
  const metadata = new Map<string, string>();
  for await (const record of reader.readMetadata({ name: "lumbrical" }))
    for (const [key, value] of record.metadata) metadata.set(key, value);

  const rate = Session.getRootAsSession(new ByteBuffer(session)).settings()?.rate() ?? 0;
  if (!(rate >= 1 && rate <= 100000)) throw new Error(`${bytes.name}: the session's rate is out of range`);
  const tickAt = (time: bigint) => Math.round((Number(time) * rate) / 1e9);
  const chunks = reader.chunkIndexes.filter((chunk) => chunk.messageEndTime > 0n || chunk.messageIndexLength > 0n);
  refuseOverlaps(chunks, bytes.name);
  const starts = chunks.map((chunk) => tickAt(chunk.messageStartTime));

  const kept = new Map<number, Promise<Chunk>>();
  let largest = 1;  // bytes of a chunk so far
  const room = () => Math.min(kChunksKept, Math.max(2, Math.floor(kBytesKept / largest)));
  const load = async (index: number): Promise<Chunk> => {
    const { chunkStartOffset, chunkLength } = chunks[index];
    const chunk = new Map<number, Uint8Array>();
    const from = starts[index];
    const damaged = (why: string) => new Error(`${bytes.name}: the chunk at byte ${chunkStartOffset} is damaged (${why}). ` +
      `What is whole comes back by\n  lumbrical recover ${bytes.name} --output whole.mcap`);
    if (chunkLength > kLargestRecord) throw damaged(`it has ${chunkLength} bytes, more than any recording needs`);
    const record = await bytes.read(chunkStartOffset, chunkLength);
    try {
      for (const message of messagesOf(record)) {
        largest = Math.max(largest, message.bytes.buffer.byteLength);
        // A sequence number is a tick's lower 32 bits.
        if (message.channel === channel) chunk.set(from + ((message.sequence - from) >>> 0), message.bytes);
      }
    } catch (error) {
      throw damaged((error as Error).message);
    }
    return chunk;
  };
  const chunk = (index: number) => {
    const found = kept.get(index) ?? load(index);
    kept.delete(index);
    kept.set(index, found);  // the youngest is last
    found.catch(() => kept.delete(index));  // a server may be back the next time
    while (kept.size > room()) kept.delete(kept.keys().next().value!);
    return found;
  };
  const chunkOf = (tick: number) => {
    let low = 0;
    for (let high = starts.length; high - low > 1; ) {
      const middle = (low + high) >> 1;
      if (starts[middle] <= tick) low = middle;
      else high = middle;
    }
    return low;
  };
  const next = async (tick: number) => {
    for (let index = chunkOf(tick); index < chunks.length; ++index)
      for (const found of (await chunk(index)).keys()) if (found >= tick) return found;
    return Infinity;
  };
  return {
    name: bytes.name,
    sides,
    hand,
    bytes: await bytes.size(),
    session,
    state: attachments.get(kStates[hand]) ?? new Uint8Array(),
    rate,
    first: tickAt(statistics.messageStartTime),
    last: tickAt(statistics.messageEndTime),
    metadata,
    chunkCount: chunks.length,
    chunk,
    message: async (tick) => (await chunk(chunkOf(tick))).get(tick),
    next,
  };
}
