// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the firmware as they were at a moment of a flight.
import type {Flight} from './flight.ts';

/** Messages of the link; where there are none, the list as the vehicle armed. */
export const tableOf = (flight: Flight) => flight.tables.get('/link/param_value') ?? flight.tables.get('/parameters');

/** The latest value of each in the first messages; of what is not known by then, the one with which the vehicle armed, or its first. */
export function valuesAt(flight: Flight, rows: number): Map<string, number> {
  const table = tableOf(flight);
  const names = table?.text('name') ?? [];
  const values = table?.column('value') ?? [];
  const armed = flight.tables.get('/parameters');
  const latest = new Map(names.length > rows ? armed?.text('name')?.map((name, k) => [name, armed.column('value')![k]!]) : []);
  for (const [k, name] of names.entries()) if (k < rows || !latest.has(name)) latest.set(name, values[k]!);
  return latest;
}

/** Those in force at `t`. */
export const valuesOfMoment = (flight: Flight, t: number) => valuesAt(flight, (tableOf(flight)?.rowAt(t) ?? -1) + 1);
