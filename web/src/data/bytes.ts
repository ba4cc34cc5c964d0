// SPDX-License-Identifier: BSD-3-Clause
// Where the bytes of a log come from: memory, a file that the user chose, or the server. Only what is asked for is read.

export interface ByteSource {
  name: string;
  size: number;
  /** @throws Error  it cannot be read, or ends before. */
  read(start: number, length: number): Promise<Uint8Array>;
}

export function bytesSource(name: string, bytes: Uint8Array): ByteSource {
  return {name, size: bytes.length, read: async (start, length) => whole(name, bytes.subarray(start, start + length), length)};
}

export function blobSource(name: string, blob: Blob): ByteSource {
  return {
    name, size: blob.size,
    read: async (start, length) => whole(name, new Uint8Array(await blob.slice(start, start + length).arrayBuffer()), length),
  };
}

/** A file of the server, in ranges; `more` headers go with each request. A server that knows no ranges sends it whole, once; one that shortens
 * a range is asked again for the rest. */
export async function urlSource(url: string, name = url, more: Record<string, string> = {}): Promise<ByteSource> {
  const answer = await fetch(url, {headers: {...more, Range: 'bytes=0-0'}});
  if (!answer.ok) throw new Error(`${name}: the server answers ${answer.status} ${answer.statusText}`);
  const size = Number(/\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '')?.[1]);
  if (answer.status !== 206 || !Number.isFinite(size)) return bytesSource(name, new Uint8Array(await answer.arrayBuffer()));
  return {
    name, size,
    async read(start, length) {
      const parts: Uint8Array[] = [];
      let got = 0;
      while (got < length) {
        const answer = await fetch(url, {headers: {...more, Range: `bytes=${start + got}-${start + length - 1}`}});
        if (answer.status !== 206) throw new Error(`${name}: the server answers ${answer.status} ${answer.statusText}`);
        const part = new Uint8Array(await answer.arrayBuffer());
        if (part.length === 0) break;
        parts.push(part);
        got += part.length;
      }
      return whole(name, parts.length === 1 ? parts[0]! : joined(parts, got), length);
    },
  };
}

function whole(name: string, bytes: Uint8Array, length: number): Uint8Array {
  if (bytes.length !== length) throw new Error(`${name}: ends ${length - bytes.length} bytes too early`);
  return bytes;
}

function joined(parts: readonly Uint8Array[], length: number): Uint8Array {
  const all = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}
