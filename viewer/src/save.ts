// What was felt in the lab as a recording, as docs/recording.md has it: it replays natively, bit for bit.
import { McapWriter } from "@mcap/core";

export interface Felt {
  session: Uint8Array;
  schema: Uint8Array;
  rate: number;
  messages: Uint8Array[];  // of ticks 0, 1, ...
}

export async function toMcap({ session, schema, rate, messages }: Felt): Promise<Blob> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let size = 0n;
  const writable = {
    position: () => size,
    write: async (bytes: Uint8Array) => {
      parts.push(bytes.slice());
      size += BigInt(bytes.length);
    },
  };
  const writer = new McapWriter({ writable, chunkSize: 1 << 20 });
  await writer.start({ profile: "", library: "lumbrical" });
  await writer.addMetadata({ name: "lumbrical", metadata: new Map([["program", "the viewer's lab"]]) });
  await writer.addAttachment({ name: "session", mediaType: "application/octet-stream", logTime: 0n, createTime: 0n, data: session });
  const schemaId = await writer.registerSchema({ name: "lumbrical.fb.Tick", encoding: "flatbuffer", data: schema });
  const channelId = await writer.registerChannel({ topic: "tick", messageEncoding: "flatbuffer", schemaId, metadata: new Map() });
  for (const [sequence, data] of messages.entries()) {
    const time = BigInt(Math.floor((sequence * 1e9) / rate + 0.5));
    await writer.addMessage({ channelId, sequence, logTime: time, publishTime: time, data });
  }
  await writer.end();
  return new Blob(parts);
}
