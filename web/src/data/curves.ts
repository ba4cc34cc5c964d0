// SPDX-License-Identifier: BSD-3-Clause
// Curves over time made from the columns of a flight: fields as they are, and what follows from several of them.
import type {Analysis} from './analysis.ts';
import {eulerAngles, turned, type Quaternion, type Triple} from './attitude.ts';
import type {Flight, PoseTopic} from './flight.ts';
import {lastAtOrBefore, type Table} from './table.ts';
import {DEG_PER_RAD} from './units.ts';

/** NaN is a gap. */
export interface Curve { t: Float64Array; y: Float64Array }

/** A field times a factor. @returns undefined if the flight does not have it. */
export function field(flight: Flight, topic: string, name: string, factor = 1): Curve | undefined {
  const table = flight.tables.get(topic);
  const values = table?.column(name);
  if (!table || !values) return undefined;
  return {t: table.times.subarray(0, table.length), y: factor === 1 ? values : values.map((value) => factor * value)};
}

/** A curve of the flight's analysis times a factor. @returns undefined if it has none of this name. */
export function analysisCurve(analysis: Analysis | undefined, name: string, factor = 1): Curve | undefined {
  const {t_s: t, [name]: y} = analysis?.curves ?? {};
  if (!t || !y) return undefined;
  return {t: Float64Array.from(t, (value) => value ?? NaN), y: Float64Array.from(y, (value) => value === null ? NaN : factor * value)};
}

/** A value made from several columns of one topic. @returns undefined if one of them is missing. */
export function derived(flight: Flight, topic: string, names: readonly string[], value: (cells: number[]) => number)
  : Curve | undefined {
  const table = flight.tables.get(topic);
  const columns = names.map((name) => table?.column(name));
  if (!table || columns.some((column) => column === undefined)) return undefined;
  const cells: number[] = [];
  const y = new Float64Array(table.length);
  for (let row = 0; row < y.length; ++row) {
    columns.forEach((column, k) => { cells[k] = column![row]!; });
    y[row] = value(cells);
  }
  return {t: table.times.subarray(0, table.length), y};
}

/** Roll, pitch or yaw [deg], yaw without jumps of a turn. */
export function angle(flight: Flight, topic: string, attitude: readonly string[], axis: 0 | 1 | 2): Curve | undefined {
  const curve = derived(flight, topic, attitude, (q) => eulerAngles(q as unknown as Quaternion)[axis] * DEG_PER_RAD);
  return curve && axis === 2 ? unwrapped(curve) : curve;
}

/** Angles [deg] without jumps of a turn. */
export function unwrapped<C extends Curve | undefined>(curve: C): C {
  if (!curve) return curve;
  let before = NaN;
  const y = curve.y.map((value) => {
    if (!Number.isFinite(value)) return value;
    const near = Number.isFinite(before) ? value + 360 * Math.round((before - value) / 360) : value;
    return before = near;
  });
  return {...curve, y};
}

/** Shifted by whole turns so that it begins within half a turn of another one. */
export function alignedTo(curve: Curve | undefined, other: Curve | undefined): Curve | undefined {
  if (!curve || !other) return curve;
  const first = curve.y.findIndex(Number.isFinite);
  if (first < 0) return curve;
  const there = sampleAt(other, curve.t[first]!);
  if (!Number.isFinite(there)) return curve;
  const shift = 360 * Math.round((there - curve.y[first]!) / 360);
  return shift === 0 ? curve : {t: curve.t, y: curve.y.map((value) => value + shift)};
}

/** Velocity of the body over ground in north-east-down [m/s]: one of its components, or its length across ground. */
export function groundVelocity(flight: Flight, value: (v_W: Triple) => number): Curve | undefined {
  const names = ['w', 'x', 'y', 'z'].map((a) => `pose.orientation.${a}`).concat(['x', 'y', 'z'].map((a) => `twist.linear.${a}`));
  return derived(flight, '/sim/truth_state', names, ([w, x, y, z, u, v, s]) =>
    value(turned([w!, x!, y!, z!], [u!, v!, s!])));
}

/** `of` less `reference`, at the times of the first. */
export function difference(of: Curve | undefined, reference: Curve | undefined): Curve | undefined {
  if (!of || !reference) return undefined;
  return {t: of.t, y: of.y.map((value, row) => value - sampleAt(reference, of.t[row]!))};
}

/** Distance of two curves across ground, at the times of the first. */
export function horizontal(north: Curve | undefined, east: Curve | undefined): Curve | undefined {
  if (!north || !east) return undefined;
  return {t: north.t, y: north.y.map((value, row) => Math.hypot(value, east.y[row]!))};
}

/** Linear between samples, NaN outside of them. */
export function sampleAt({t, y}: Curve, time: number): number {
  const last = t.length - 1;
  if (last < 0 || time < t[0]! || time > t[last]!) return NaN;
  const low = lastAtOrBefore(t, t.length, time);
  const high = Math.min(low + 1, last);
  const span = t[high]! - t[low]!;
  return span > 0 ? y[low]! + (time - t[low]!) / span * (y[high]! - y[low]!) : y[low]!;
}

/** Positions of a topic in north-east-down [m], no more than `max`, evenly chosen; `rows` is which. */
export function path(table: Table, names: PoseTopic['position'], max: number): {points: Triple[]; rows: number[]} {
  const columns = names.map((name) => table.column(name));
  const points: Triple[] = [];
  const rows: number[] = [];
  const step = Math.max(1, Math.ceil(table.length / max));
  for (let row = 0; row < table.length; row += step) {
    const point = columns.map((column) => column?.[row] ?? NaN) as unknown as Triple;
    if (!point.every(Number.isFinite)) continue;
    points.push(point);
    rows.push(row);
  }
  return {points, rows};
}

/** Column of a chart whose curves share their times: undefined is no sample of this curve there, null a gap. */
export type Column = ArrayLike<number | null | undefined>;

const HELD_S = 1;
const HELD_INTERVALS = 3;

/** The row of the column's last sample, -1 if it has none. */
export function lastRow(values: Column): number { return lastSample(values, values.length - 1); }

/** The row whose value a chart shows at `row`: of the sample there or before. A curve that has ended, at `last`, shows its last value for
 * HELD_S or HELD_INTERVALS of its intervals, then none, as at a gap: `row` itself. */
export function shownRow(times: ArrayLike<number>, values: Column, last: number, row: number): number {
  if (row <= last) return Math.max(lastSample(values, row), 0);
  if (last < 0) return row;
  const before = lastSample(values, last - 1);
  const interval_s = before < 0 ? 0 : times[last]! - times[before]!;
  return times[row]! - times[last]! > Math.max(HELD_S, HELD_INTERVALS * interval_s) ? row : last;
}

function lastSample(values: Column, row: number): number {
  while (row >= 0 && values[row] === undefined) --row;
  return row;
}
