// The messages of an MCAP chunk (https://mcap.dev/spec), as they lie in its memory. The MCAP library would copy each of them: a whole
// file would take three quarters longer, and some fifty megabytes more.
import { crc32 } from "@foxglove/crc";
import { decompress as decompressZstd } from "fzstd";
import { decompressLz4 } from "./lz4";

export interface Message {
  channel: number;
  sequence: number;
  bytes: Uint8Array;
}

const kChunk = 0x06;
const kMessage = 0x05;
const kHeader = 9;  // bytes of a record's opcode and length
const kBeforeData = 22;  // bytes of a message's channel, sequence and times

// As the program reads it (mcap_format.h): honest chunks are smaller, hostile ones would fill the page's memory.
const kLargest = 1 << 24;
const kLargestRatio = 256, kLargestGift = 1024;

const viewOf = (bytes: Uint8Array) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

function decompress(compression: string, bytes: Uint8Array, size: number): Uint8Array {
  if (size > kLargest) throw new Error(`it declares ${size} bytes of records; at most 16 MiB can be read`);
  if (size > kLargestRatio * bytes.length + kLargestGift)
    throw new Error(`it declares ${size} bytes of records in ${bytes.length}, more than ticks can be compressed`);
  if (compression === "" && size === bytes.length) return bytes;
  if (compression === "lz4") return decompressLz4(bytes, new Uint8Array(size));
  if (compression === "zstd") return decompressZstd(bytes, new Uint8Array(size));
  throw new Error(compression === "" ? "it is torn" : `its compression "${compression}" is unknown`);
}

/** What a chunk record holds, decompressed and checked. */
function contentOf(record: Uint8Array): Uint8Array {
  const view = viewOf(record);
  if (record.length < kHeader + 40 || view.getUint8(0) !== kChunk) throw new Error("it is none");
  const size = Number(view.getBigUint64(kHeader + 16, true));
  const crc = view.getUint32(kHeader + 24, true);
  const nameEnd = kHeader + 32 + view.getUint32(kHeader + 28, true);
  if (nameEnd + 8 > record.length) throw new Error("it is torn");
  const compression = new TextDecoder().decode(record.subarray(kHeader + 32, nameEnd));
  const end = nameEnd + 8 + Number(view.getBigUint64(nameEnd, true));
  if (end > record.length) throw new Error("it is torn");
  const content = decompress(compression, record.subarray(nameEnd + 8, end), size);
  if (crc !== 0 && crc32(content) !== crc) throw new Error("its checksum is not the one that was recorded");
  return content;
}

/** The messages of a chunk record, in their order. */
export function* messagesOf(record: Uint8Array): Generator<Message> {
  const content = contentOf(record);
  const view = viewOf(content);
  for (let at = 0; at < content.length; ) {
    const start = at + kHeader;
    const length = start <= content.length ? Number(view.getBigUint64(at + 1, true)) : Infinity;
    if (start + length > content.length) throw new Error("a record ends behind it");
    if (view.getUint8(at) === kMessage) {
      if (length < kBeforeData) throw new Error("a message is torn");
      const bytes = content.subarray(start + kBeforeData, start + length);
      yield { channel: view.getUint16(start, true), sequence: view.getUint32(start + 2, true), bytes };
    }
    at = start + length;
  }
}
