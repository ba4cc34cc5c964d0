// SPDX-License-Identifier: BSD-3-Clause

/** Numbers below 2^31 from a seed: the minimal standard generator of S. Park and K. Miller, 1988. */
export function random(seed: number): () => number {
  let state = seed;
  return () => state = Number(BigInt(state) * 48271n % 2147483647n);
}
