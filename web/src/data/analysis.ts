// SPDX-License-Identifier: BSD-3-Clause
// What a flight folder says beside the log: analysis.json, which the program writes with each flight.
import type {Triple} from './attitude.ts';

export interface Waypoint { position_m: Triple; heading_deg: number | null; hold_s: number }
export interface ChangedParameter { name: string; default: number; value: number }
export interface GyroSpectrum { frequency_Hz: number[]; sensor_rad_s_rtHz: number[]; controller_rad_s_rtHz: number[]; latency_s: number | null }

export interface Analysis {
  command_line: string;
  waypoints: Waypoint[];
  changed_parameters: ChangedParameter[];
  /** Over `t_s`; null where a value is not known. */
  curves: Record<string, (number | null)[]>;
  gyro: GyroSpectrum;
}

export interface Fault { what: string; from: number; to: number }

/** Of the metadata of a log: WHAT@TIME or WHAT@TIME:DURATION, times in seconds. */
export function faultsOf(facts: ReadonlyMap<string, string>, end_s: number): Fault[] {
  return (facts.get('faults') ?? '').split(' ').flatMap((text) => {
    const match = /^(.+)@([\d.]+)(?::([\d.]+))?$/.exec(text);
    if (!match) return [];
    const from = Number(match[2]);
    const to = match[3] === undefined ? end_s : from + Number(match[3]);
    return from < end_s ? [{what: match[1]!, from, to: Math.min(to, end_s)}] : [];
  });
}
