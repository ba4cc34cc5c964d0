// SPDX-License-Identifier: BSD-3-Clause
// States over time, as strips: what the firmware, its errors, the pilot and the autonomy were doing when.
import {faultsOf} from './analysis.ts';
import {AIDS, ESTIMATE, type Flight, type Tone} from './flight.ts';
import type {Table} from './table.ts';

export interface Span { from: number; to: number; label: string; tone: Tone }
export interface Lane { name: string; spans: Span[] }

/** Bits of Status.error_code. */
export const ERRORS = ['mixer invalid', 'IMU silent', 'RC lost', 'estimator unhealthy', 'timestamp moved backwards', 'IMU not calibrated',
  'buffer overrun', 'failsafe throttle invalid'];
const BY_COMPANION = 0x3c0; // Status.rc_override: no valid command of the companion on that axis
const BY_PILOT = 0x3f;

/** Names of the bits that are set. */
export function errorNames(code: number): string[] { return ERRORS.filter((_, bit) => (code >> bit) & 1); }

export function lanesOf(flight: Flight): Lane[] {
  const status = flight.tables.get('/status');
  const phase = flight.tables.get('/autonomy/phase');
  const lanes: Lane[] = [];
  if (status) {
    const flag = (row: number, name: string) => status.column(name)?.[row] ?? 0;
    lanes.push(
      lane('firmware', status, flight.end_s, (row) => flag(row, 'failsafe') ? ['failsafe', 'bad']
        : flag(row, 'armed') ? ['armed', 'good'] : ['disarmed', 'neutral']),
      lane('errors', status, flight.end_s, (row) => [errorNames(flag(row, 'error_code')).join(', '), 'bad']),
      lane('control', status, flight.end_s, (row) => control(flag(row, 'armed'), flag(row, 'failsafe'), flag(row, 'rc_override'))));
  }
  if (phase) lanes.push(lane('autonomy', phase, flight.end_s, (row) => [phase.text('name')?.[row] ?? '', 'good']));
  const faults = faultsOf(flight.facts, flight.end_s);
  if (faults.length > 0) lanes.push({name: 'faults', spans: faults.map(({what, from, to}) => ({from, to, label: what, tone: 'bad'}))});
  const estimate = flight.tables.get(ESTIMATE.topic);
  if (estimate) {
    const columns = AIDS.map((_, k) => estimate.column(`refusing[${k}]`));
    const rejected = lane('rejected', estimate, flight.end_s, (row) => [AIDS.filter((_, k) => columns[k]?.[row]).join(', '), 'warning']);
    if (rejected.spans.length > 0) lanes.push(rejected); // no lane for what never happened
  }
  return lanes;
}

function control(armed: number, failsafe: number, override: number): [string, Tone] {
  if (!armed) return ['', 'neutral'];
  if (failsafe) return ['failsafe', 'bad'];
  const axes = override & (BY_COMPANION | BY_PILOT);
  if (axes === 0) return ['companion', 'good'];
  return (override & BY_COMPANION) === BY_COMPANION || (override & 3) === 3 ? ['pilot', 'warning'] : ['shared', 'warning'];
}

/** Rows with the same label are one span; an empty label is none. */
function lane(name: string, table: Table, end: number, state: (row: number) => [string, Tone]): Lane {
  const spans: Span[] = [];
  let before = '';
  for (let row = 0; row < table.length; ++row) {
    const [label, tone] = state(row);
    if (label === before) continue;
    const from = table.times[row]!;
    if (before !== '') spans.at(-1)!.to = from;
    if (label !== '') spans.push({from, to: end, label, tone});
    before = label;
  }
  return {name, spans};
}
