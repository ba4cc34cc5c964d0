// SPDX-License-Identifier: BSD-3-Clause
// The reference decoder of Zstandard in WebAssembly, as three brings it: ten times as fast as one in script.
import {ZSTDDecoder} from 'three/examples/jsm/libs/zstddec.module.js';

/** Unpacks a frame of so many bytes. Less comes out if it is damaged. */
export type Unpack = (packed: Uint8Array, size: number) => Uint8Array;

let ready: Promise<Unpack> | undefined;

/** @throws Error  the browser has no WebAssembly. */
export function unpackZstd(): Promise<Unpack> {
  return ready ??= load();
}

async function load(): Promise<Unpack> {
  const decoder = new ZSTDDecoder();
  await decoder.init();
  return (packed, size) => decoder.decode(packed, size);
}
