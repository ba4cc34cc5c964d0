// SPDX-License-Identifier: BSD-3-Clause
// How far each control surface of a fixed wing is deflected by the output that drives it.
import type {Flight} from './flight.ts';
import {mixedOutputs} from './mixer.ts';
import {valuesOfMoment} from './parameter_values.ts';
import {entriesOf, parseSettings, settingsAt} from './settings.ts';
import {DEG_PER_RAD} from './units.ts';

/** Surfaces as they are drawn; an inverted V-tail has two, each of which is elevator and rudder. */
export type Part = 'left aileron' | 'right aileron' | 'elevator' | 'rudder' | 'left tail' | 'right tail';

export interface Surface {
  output: number;
  /** Deflection at either end of the output [rad]. */
  travel_rad: number;
  /** What it moves; the sign is 1 if a positive output moves the trailing edge down, that of a rudder to the left. */
  parts: readonly (readonly [Part, 1 | -1])[];
}

/** Of a vehicle whose file is not known, which is drawn with this travel. */
export const ASSUMED_TRAVEL_DEG = 30;

/** Those of the vehicle file in force; without one those that the mixer's parameters drive. */
export function surfacesOf(flight: Flight): Surface[] {
  const file = settingsAt(flight, flight.end_s);
  return file ? surfacesOfFile(file) : flight.fixedWing ? surfacesOfMixer(valuesOfMoment(flight, Infinity)) : [];
}

/** Section `surfaces` of a vehicle file. Its effects count as its derivatives do (sim/fixedwing/aerodynamics.hpp). */
export function surfacesOfFile(file: string): Surface[] {
  const keys = parseSettings(file);
  const sense = (key: string, usual: number) => Math.sign(usual * Number(keys.get(key) ?? usual)) || 1;
  const [right, down, left] = [sense('aero.roll.aileron', 1), sense('aero.pitch.elevator', -1), sense('aero.yaw.rudder', -1)];
  return entriesOf(keys, 'surfaces.layout').map((entry) => {
    const effect = (name: string) => Number(keys.get(`${entry}.${name}`) ?? 0);
    return {output: effect('output'), travel_rad: effect('travel_deg') / DEG_PER_RAD,
      parts: partsOf(right * effect('aileron'), down * effect('elevator'), left * effect('rudder'))};
  });
}

/** Servos of the firmware's mixer, whose commands are positive for roll right, nose up and yaw right. */
export function surfacesOfMixer(values: ReadonlyMap<string, number>): Surface[] {
  const sense = (parameter: string) => values.get(parameter) === 1 ? -1 : 1;
  return mixedOutputs(values).filter(({isMotor}) => !isMotor).map(({output, roll, pitch, yaw}) => ({
    output, travel_rad: ASSUMED_TRAVEL_DEG / DEG_PER_RAD,
    parts: partsOf(sense('REV_AILERON') * roll, -sense('REV_ELEVATOR') * pitch, -sense('REV_RUDDER') * yaw),
  }));
}

/** Of a servo that rolls right, moves an elevator down and yaws left by these shares. */
function partsOf(right: number, down: number, left: number): Surface['parts'] {
  const sign = (value: number) => value < 0 ? -1 : 1;
  // Trailing edge down, the right half of an inverted V-tail yaws left, and a right elevon rolls left.
  if (down && left) return [[down * left > 0 ? 'right tail' : 'left tail', sign(down)]];
  if (down && right) return [[down * right < 0 ? 'right aileron' : 'left aileron', sign(down)]];
  if (right) return [['right aileron', sign(-right)], ['left aileron', sign(right)]];
  return down ? [['elevator', sign(down)]] : left ? [['rudder', sign(left)]] : [];
}

/** Angle of each part at `t` [rad], trailing edge down, that of a rudder to the left; the mean where several servos move one. */
export function deflections(flight: Flight, surfaces: readonly Surface[], t: number): Map<Part, number> {
  const angles = new Map<Part, number[]>();
  for (const {output, travel_rad, parts} of surfaces) {
    const value = servoOutput(flight, output, t);
    for (const [part, sign] of parts) angles.set(part, [...angles.get(part) ?? [], sign * travel_rad * Math.min(Math.max(value || 0, -1), 1)]);
  }
  return new Map([...angles].map(([part, all]) => [part, all.reduce((sum, one) => sum + one, 0) / all.length]));
}

/** -1 to 1, made from 0 to 1: what reached the servo in a simulation, else what the firmware reports. */
function servoOutput(flight: Flight, output: number, t: number): number {
  const reached = flight.latest('/sim/truth_vehicle', `outputs[${output}]`, t);
  return 2 * (Number.isFinite(reached) ? reached : flight.latest('/output_raw', `values[${output}]`, t)) - 1;
}
