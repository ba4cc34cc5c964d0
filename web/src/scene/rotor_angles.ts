// SPDX-License-Identifier: BSD-3-Clause
import type {Flight} from '../data/flight.ts';

/** How far each rotor has turned by each row of /sim/truth_vehicle [rad]: the same moment always looks the same. */
export function rotorAngles(flight: Flight, count: number): Float64Array[] {
  const table = flight.tables.get('/sim/truth_vehicle');
  if (!table) return [];
  return Array.from({length: count}, (_, k) => {
    const speed = table.column(`rotor_speed[${k}]`);
    const angle = new Float64Array(table.length);
    for (let row = 1; row < angle.length; ++row) {
      angle[row] = angle[row - 1]! + (speed?.[row] ?? 0) * (table.times[row]! - table.times[row - 1]!);
    }
    return angle;
  });
}
