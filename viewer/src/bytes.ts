// Where a recording's bytes come from: a file the user picked, or an address of the page's own origin, a range at a time.

export interface Bytes {
  name: string;
  size(): Promise<bigint>;
  read(offset: bigint, length: bigint): Promise<Uint8Array>;
}

export function bytesOfFile(file: Blob, name: string): Bytes {
  return {
    name,
    size: async () => BigInt(file.size),
    read: async (offset, length) => {
      const end = offset + length;
      if (end > BigInt(file.size)) throw new Error(`${name}: ends at byte ${file.size}, before byte ${end}`);
      return new Uint8Array(await file.slice(Number(offset), Number(end)).arrayBuffer());
    },
  };
}

// What a server that knows no ranges may make the page hold.
const kMostWhole = 256e6;

/** Of a server that may not tell how much is to come. */
async function wholeOf(response: Response, name: string): Promise<Blob> {
  const pieces: BlobPart[] = [];
  const reader = response.body!.getReader();
  const told = Number(response.headers.get("Content-Length") ?? 0);
  for (let size = 0; Math.max(size, told) <= kMostWhole; ) {
    const { value, done } = await reader.read();
    if (done) return new Blob(pieces);
    pieces.push(value);
    size += value.length;
  }
  await reader.cancel();
  throw new Error(`${name}: this server does not send parts of a file, and the whole is too large for a page; ` +
    "open it by lumbrical view, or from disk");
}

export async function bytesOfUrl(url: string): Promise<Bytes> {
  const name = decodeURIComponent(url.split("/").pop() ?? url);
  const ask = async (range: string) => {
    const response = await fetch(url, { headers: { Range: range }, cache: "no-store" });
    if (!response.ok) throw new Error(`${name}: the server answers ${response.status} ${response.statusText}`);
    return response;
  };
  const first = await ask("bytes=0-7");
  if (first.status !== 206) return bytesOfFile(await wholeOf(first, name), name);
  const total = /\/(\d+)$/.exec(first.headers.get("Content-Range") ?? "")?.[1];
  if (total === undefined) throw new Error(`${name}: this server does not tell how long the file is; open it by lumbrical view, or from disk`);
  const size = BigInt(total);
  return {
    name,
    size: async () => size,
    read: async (offset, length) => {
      if (length === 0n) return new Uint8Array();
      const response = await ask(`bytes=${offset}-${offset + length - 1n}`);
      const bytes = new Uint8Array(await response.arrayBuffer());
      if (BigInt(bytes.length) !== length)
        throw new Error(`${name}: byte ${offset + BigInt(bytes.length)} and those behind it could not be read`);
      return bytes;
    },
  };
}
