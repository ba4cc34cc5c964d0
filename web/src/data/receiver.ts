// SPDX-License-Identifier: BSD-3-Clause
// What the receiver's channels have shown so far.
import type {Flight} from './flight.ts';

export const CHANNELS = 8; // RcRaw.values
export interface EndPoints { low_us: number; high_us: number }

/** Smallest and largest pulse of a channel until `t`; undefined before the first one. */
export function endPoints(flight: Flight, channel: number, t: number): EndPoints | undefined {
  const table = flight.tables.get('/rc_raw');
  const pulses = table?.column(`values[${channel}]`);
  if (!table || !pulses) return undefined;
  let [low_us, high_us] = [Infinity, -Infinity];
  for (let row = table.rowAt(t); row >= 0; --row) {
    low_us = Math.min(low_us, pulses[row]!);
    high_us = Math.max(high_us, pulses[row]!);
  }
  return low_us <= high_us ? {low_us, high_us} : undefined;
}
