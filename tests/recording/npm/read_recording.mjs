// Reads a recording with the MCAP project's own library, by its index and as a stream, checksums validated, and
// prints what it finds as one JSON object. Exit code 1: it could not be read.
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import lz4 from "@foxglove/wasm-lz4";
import { decompress as zstd } from "fzstd";

await lz4.isLoaded;
const decompressHandlers = {
  lz4: (bytes, size) => lz4(bytes, Number(size)),
  zstd: (bytes, size) => zstd(bytes, new Uint8Array(Number(size))),
};

// The first field of the root table, read straight from the FlatBuffer: the tick number.
function tickOf(data) {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const table = view.getUint32(0, true);
  const vtable = table - view.getInt32(table, true);
  const field = view.getUint16(vtable, true) > 4 ? view.getUint16(vtable + 4, true) : 0;
  return field === 0 ? 0n : view.getBigUint64(table + field, true);
}

// Counts messages and notes every one whose tick, sequence number and time do not go together.
class Ticks {
  count = 0;
  wrong = 0;
  first = null;
  last = null;
  add(message) {
    const tick = tickOf(message.data);
    const fits = BigInt(message.sequence) === tick && (this.last === null || tick > this.last);
    if (!fits || message.publishTime !== message.logTime) this.wrong += 1;
    this.first ??= tick;
    this.last = tick;
    this.count += 1;
  }
  summary() {
    return { count: this.count, wrong: this.wrong, first: Number(this.first), last: Number(this.last) };
  }
}

async function readByIndex(file) {
  const size = BigInt((await file.stat()).size);
  const readable = {
    size: async () => size,
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
      if (bytesRead !== bytes.length) throw new Error(`file ends before byte ${offset + length}`);
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const ticks = new Ticks();
  for await (const message of reader.readMessages({ validateCrcs: true })) ticks.add(message);
  const attachments = [];
  for await (const { name, data } of reader.readAttachments({ validateCrcs: true }))
    attachments.push({ name, size: data.length });
  const metadata = {};
  for await (const record of reader.readMetadata()) metadata[record.name] = Object.fromEntries(record.metadata);
  const [schema] = reader.schemasById.values();
  const [channel] = reader.channelsById.values();
  return {
    ...ticks.summary(),
    library: reader.header.library,
    schema: { name: schema.name, encoding: schema.encoding, size: schema.data.length },
    channel: { topic: channel.topic, encoding: channel.messageEncoding },
    statistics: {
      messages: Number(reader.statistics.messageCount),
      chunks: reader.statistics.chunkCount,
      attachments: reader.statistics.attachmentCount,
    },
    chunks: reader.chunkIndexes.length,
    compression: reader.chunkIndexes[0]?.compression ?? "",
    attachments,
    metadata,
  };
}

async function readAsStream(file) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const ticks = new Ticks();
  const block = new Uint8Array(65536);
  for (let position = 0; ; ) {
    const { bytesRead } = await file.read(block, 0, block.length, position);
    if (bytesRead === 0) break;
    position += bytesRead;
    reader.append(block.slice(0, bytesRead));
    for (let record; (record = reader.nextRecord()); ) if (record.type === "Message") ticks.add(record);
  }
  if (!reader.done()) throw new Error("the file ends before its end");
  return ticks.summary();
}

try {
  const file = await open(process.argv[2], "r");
  const indexed = await readByIndex(file);
  const streamed = await readAsStream(file);
  await file.close();
  console.log(JSON.stringify({ indexed, streamed }));
} catch (error) {
  console.error(`${process.argv[2]}: ${error.message}`);
  process.exitCode = 1;
}
