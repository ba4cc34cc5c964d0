// SPDX-License-Identifier: BSD-3-Clause
// What keeps the vehicle from arming: the list of the firmware when it was asked for it, else the flags of its status; and what it
// answered to attempts.
import type {Flight} from './flight.ts';

export type Verdict = 'pass' | 'warning' | 'refuses';
export interface CheckLine { name: string; verdict: Verdict; reason: string }

const VERDICTS: readonly Verdict[] = ['pass', 'warning', 'refuses']; // link::CheckOutcome

/** What to do about each check of the firmware (firmware/core/arming_checks.hpp). */
export const WAYS_OUT: Record<string, string> = {
  'mixer': 'Set PRIMARY_MIXER to the mixer of the airframe.',
  'ESC mixer': 'Set PRIMARY_MIXER to the mixer of the airframe, unless the speed controllers are to be calibrated.',
  'IMU': 'The IMU sends nothing. Check its wiring, then restart the flight controller.',
  'IMU time': 'Restart the flight controller. If it comes again, its clock or its IMU is damaged.',
  'calibration': 'Leave the vehicle at rest and calibrate the gyro: in Preflight of the vehicle take control, then press Calibrate beside Gyro.',
  'estimator': 'Keep the vehicle at rest until its attitude has settled.',
  'receiver': 'Switch the transmitter on. Check that the receiver is bound and connected.',
  'failsafe': 'Set FAILSAFE_THR to a throttle from 0 to 1 with which the vehicle comes down.',
  'throttle': 'Move the throttle stick to its lowest position.',
  'override': 'Switch the throttle override on, or set TAKE_MIN_THR to 1.',
  'still': 'Keep the vehicle still for half a second.',
  'level': 'Stand the vehicle upright, or calibrate its accelerometer if it is.',
  'sensors': 'The sensors named have stopped sending. Check their wiring, then restart the flight controller.',
  'storage': 'Check the parameters, then write them to memory.',
  'loop time': 'The flight controller has too much to do. Restart it and look at the counters of its firmware.',
  'battery seen': 'Connect the battery monitor and set the motor parameters, or set USE_MOTOR_PARAM to 0.',
  'battery': 'Charge the battery. BATT_VOLT_MAX is the voltage of a full one.',
};

/** The same of flags that are no check. This firmware never sets them. */
const OF_OTHER_FIRMWARE: Record<string, string> = {
  'buffer overrun': 'Restart the flight controller. The firmware of this project never sends this flag.',
};

/** What to do about a line of linesAt(). */
export const wayOut = (name: string): string => WAYS_OUT[name] ?? OF_OTHER_FIRMWARE[name] ?? '';

/** Checks of the bits of Status.error_code, in their order. */
const OF_FLAGS = ['mixer', 'IMU', 'receiver', 'estimator', 'IMU time', 'calibration', 'buffer overrun', 'failsafe'];

/** The newest list that was complete by then; `t` is its moment. */
export function checksAt(flight: Flight, t: number): {t: number; lines: CheckLine[]} | undefined {
  const table = flight.tables.get('/link/check_result');
  if (!table) return undefined;
  const cell = (name: string, row: number) => table.column(name)?.[row] ?? NaN;
  for (let last = table.rowAt(t); last >= 0; --last) {
    const count = cell('count', last);
    const first = last - count + 1;
    if (cell('index', last) !== count - 1 || first < 0 || cell('index', first) !== 0) continue;
    const lines = Array.from({length: count}, (_, k) => ({name: table.text('name')![first + k]!, verdict: VERDICTS[cell('result', first + k)] ?? 'refuses',
      reason: table.text('reason')![first + k]!}));
    return {t: table.times[last]!, lines};
  }
  return undefined;
}

/** From the flags that are sent all the time; nothing before the first. */
export function flagsAt(flight: Flight, t: number): CheckLine[] | undefined {
  const code = flight.latest('/status', 'error_code', t);
  if (!Number.isFinite(code)) return undefined;
  return OF_FLAGS.map((name, bit) => ({name, verdict: (code >> bit) & 1 ? 'refuses' : 'pass', reason: ''}));
}

/** The list, with the flags if they came after it; the flags alone without a list. */
export function linesAt(flight: Flight, t: number): CheckLine[] | undefined {
  const flags = flagsAt(flight, t);
  const list = checksAt(flight, t);
  if (!list) return flags;
  const status = flight.tables.get('/status');
  const newer = status && status.times[status.rowAt(t)]! > list.t ? flags : undefined;
  const now = new Map(newer?.map(({name, verdict}) => [name, verdict]));
  return list.lines.map(({name, verdict, reason}) => {
    const flag = now.get(name) ?? verdict;
    return {name, verdict: flag, reason: flag === 'pass' ? '' : reason};
  });
}

/** Why the newest attempt to arm was refused, if it was and nothing armed since. */
export function refusalAt(flight: Flight, t: number): {t: number; reasons: string[]} | undefined {
  const START = 'Unable to arm: ';
  const BURST_s = 0.5; // reasons of one attempt come one after the other, attempts once a second at most
  const texts = flight.events.filter((event) => event.t <= t && event.text.startsWith(START));
  const last = texts.at(-1)?.t;
  if (last === undefined) return undefined;
  const status = flight.tables.get('/status');
  if (status?.column('armed')!.subarray(Math.max(status.rowAt(last), 0), status.rowAt(t) + 1).includes(1)) return undefined;
  return {t: last, reasons: [...new Set(texts.filter((event) => event.t > last - BURST_s).map(({text}) => text.slice(START.length)))]};
}
