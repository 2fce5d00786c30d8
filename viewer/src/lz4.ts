// Decompresses LZ4 frames (https://github.com/lz4/lz4/blob/dev/doc/lz4_Frame_format.md) into a known number of bytes. Checksums
// are MCAP's, of the whole chunk.

const kMagic = 0x184d2204;
const kStored = 0x80000000;

/** One block; returns where the next one's output begins. */
function decodeBlock(from: Uint8Array, to: Uint8Array, start: number): number {
  let i = 0;
  let o = start;
  const extended = (length: number) => {
    if (length !== 15) return length;
    for (let byte = 255; byte === 255; length += byte) {
      if (i >= from.length) throw new Error("LZ4: a length has no end");
      byte = from[i++];
    }
    return length;
  };
  while (i < from.length) {
    const token = from[i++];
    const literals = extended(token >> 4);
    if (i + literals > from.length || o + literals > to.length) throw new Error("LZ4: literals beyond the end");
    to.set(from.subarray(i, i + literals), o);
    i += literals;
    o += literals;
    if (i === from.length) break;
    const distance = from[i] | (from[i + 1] << 8);
    i += 2;
    const length = extended(token & 15) + 4;
    if (i > from.length || distance === 0 || distance > o || o + length > to.length)
      throw new Error("LZ4: a match lies outside");
    // Where it overlaps what it writes, a match repeats itself.
    if (distance >= length) to.copyWithin(o, o - distance, o - distance + length);
    else for (let k = 0; k < length; ++k) to[o + k] = to[o + k - distance];
    o += length;
  }
  return o;
}

/** Into `out`, which has to be as large as announced. */
export function decompressLz4(bytes: Uint8Array, out: Uint8Array): Uint8Array {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 7 || view.getUint32(0, true) !== kMagic) throw new Error("LZ4: not a frame");
  const flags = bytes[4];
  const blockChecksum = (flags & 16) !== 0 ? 4 : 0;
  let i = 7 + ((flags & 8) !== 0 ? 8 : 0) + ((flags & 1) !== 0 ? 4 : 0);
  let o = 0;
  for (;;) {
    if (i + 4 > bytes.length) throw new Error("LZ4: the frame is torn");
    const header = view.getUint32(i, true);
    i += 4;
    if (header === 0) break;
    const length = header & 0x7fffffff;
    if (i + length > bytes.length) throw new Error("LZ4: a block is torn");
    const block = bytes.subarray(i, i + length);
    if ((header & kStored) !== 0) {
      if (o + length > out.length) throw new Error("LZ4: more than was announced");
      out.set(block, o);
      o += length;
    } else {
      o = decodeBlock(block, out, o);
    }
    i += length + blockChecksum;
  }
  if (o !== out.length) throw new Error("LZ4: less than was announced");
  return out;
}
