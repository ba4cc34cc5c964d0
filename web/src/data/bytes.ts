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

/** A file of the server, in ranges; `more` headers go with each request. A server that knows no ranges sends it whole, once. */
export async function urlSource(url: string, name = url, more: Record<string, string> = {}): Promise<ByteSource> {
  const answer = await fetch(url, {headers: {...more, Range: 'bytes=0-0'}});
  if (!answer.ok) throw new Error(`${name}: the server answers ${answer.status} ${answer.statusText}`);
  const size = Number(/\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '')?.[1]);
  if (answer.status !== 206 || !Number.isFinite(size)) return bytesSource(name, new Uint8Array(await answer.arrayBuffer()));
  return {
    name, size,
    async read(start, length) {
      if (length === 0) return new Uint8Array();
      const part = await fetch(url, {headers: {...more, Range: `bytes=${start}-${start + length - 1}`}});
      if (part.status !== 206) throw new Error(`${name}: the server answers ${part.status} ${part.statusText}`);
      return whole(name, new Uint8Array(await part.arrayBuffer()), length);
    },
  };
}

function whole(name: string, bytes: Uint8Array, length: number): Uint8Array {
  if (bytes.length !== length) throw new Error(`${name}: ends ${length - bytes.length} bytes too early`);
  return bytes;
}
