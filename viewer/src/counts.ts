// Lengths that a message tells: a damaged one may tell of billions, and nothing but the end of memory would stop the page.
import type { ByteBuffer } from "flatbuffers";

/** Bytes that a vector has of a table, which lies elsewhere. */
export const kTableSize = 4;

/** A vector's length, of elements of `size` bytes, where the message has room for so many. */
export function countOf(length: number, size: number, { bb }: { bb: ByteBuffer | null }): number {
  if (length * size > bb!.capacity()) throw new Error("the message does not fit its schema");
  return length;
}
