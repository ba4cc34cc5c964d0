// SPDX-License-Identifier: BSD-3-Clause
// What can be tuned by its step response: the command of the sticks or of the companion, the answer, and the gains between them.
import {angle, derived, field, type Curve} from './curves.ts';
import type {Flight} from './flight.ts';
import {findSteps, type Step} from './step_response.ts';
import {DEG_PER_RAD} from './units.ts';

/** @param shown_s  of a step, at most. */
export interface Axis { name: string; unit: string; gains: readonly string[]; minStep: number; shown_s: number;
  /** Whose angle or rate a stick commands, by gains of the firmware; without one the altitude, by gains of autonomy. */
  stick?: Stick }
export interface Stick { name: string; channel: string; maxParameter: string;
  /** Bits of Status.rc_override: the stick counts. */
  pilot: number; angle?: 0 | 1 }

const gains = (loop: string) => ['P', 'I', 'D'].map((one) => `PID_${loop}_${one}`);
const STICKS: readonly Axis[] = [
  {name: 'Roll', unit: '°', gains: gains('ROLL_ANG'), minStep: 3, shown_s: 3, stick: {name: 'roll', channel: 'RC_X_CHN', maxParameter: 'RC_MAX_ROLL', pilot: 0x45, angle: 0}},
  {name: 'Pitch', unit: '°', gains: gains('PITCH_ANG'), minStep: 3, shown_s: 3, stick: {name: 'pitch', channel: 'RC_Y_CHN', maxParameter: 'RC_MAX_PITCH', pilot: 0x89, angle: 1}},
  {name: 'Yaw rate', unit: '°/s', gains: gains('YAW_RATE'), minStep: 8, shown_s: 3, stick: {name: 'yaw', channel: 'RC_Z_CHN', maxParameter: 'RC_MAX_YAWRATE', pilot: 0x111}},
];
/** Of the follower of trajectories (autonomy/multirotor/trajectory_follower.hpp). */
export const ALTITUDE: Axis = {name: 'Altitude', unit: 'm', minStep: 0.3, shown_s: 6,
  gains: ['follower.vertical.kp_1_s2', 'follower.vertical.ki_1_s3', 'follower.vertical.kd_1_s']};

/** A fixed wing has no steps of the altitude, as its path climbs by ramps; nor has a vehicle on a link, whose autonomy is not seen. */
export const axesOf = ({fixedWing, settings}: Flight): readonly Axis[] => fixedWing || settings.length === 0 ? STICKS : [...STICKS, ALTITUDE];

const ATTITUDE_Q = ['w', 'x', 'y', 'z'].map((a) => `attitude.${a}`);
const ANGLES = 2; // Command.mode: roll and pitch are angles
const PULSE = {middle: 1500, half: 500}; // µs of the receiver
const ANY_AXIS = 0x3ff; // of Status.rc_override

/** What the firmware measured; of the altitude, what autonomy estimated. */
export function responseOf(flight: Flight, {stick}: Axis): Curve | undefined {
  if (!stick) return field(flight, '/autonomy/estimate', 'position[2]', -1);
  return stick.angle === undefined ? field(flight, '/attitude', 'angular_velocity.z', DEG_PER_RAD) : angle(flight, '/attitude', ATTITUDE_Q, stick.angle);
}

/** Steps of stick and companion while armed; those of a stick that commands no angle are none. */
export function stepsOf(flight: Flight, axis: Axis, parameters: ReadonlyMap<string, number>): Step[] {
  const armed = (step: Step) => flight.latest('/status', 'armed', step.t) === 1;
  const steps = (curve: Curve | undefined, pilot: number, byPilot: boolean) =>
    curve ? findSteps(curve, axis.minStep).flatMap((step) => inForce(flight, pilot, step, byPilot)) : [];
  const {stick} = axis;
  if (!stick) return steps(field(flight, '/trajectory_command', 'position[2]', -1), ANY_AXIS, false).filter(armed);
  const selector = parameters.get('RC_ATT_CTRL_CHN') ?? -1;
  const names = [`values[${parameters.get(stick.channel) ?? 0}]`, ...(selector >= 0 ? [`values[${selector}]`] : [])];
  const moved = derived(flight, '/rc_raw', names, ([pulse, mode]) => {
    const isAngle = selector >= 0 ? mode! > PULSE.middle : (parameters.get('RC_ATT_MODE') ?? 1) !== 0;
    if (stick.angle !== undefined && !isAngle) return NaN;
    return (pulse! - PULSE.middle) / PULSE.half * (parameters.get(stick.maxParameter) ?? NaN) * DEG_PER_RAD;
  });
  const channel = 3 + (stick.angle ?? 2);
  const companion = derived(flight, '/command', ['mode', 'ignore', `u[${channel}]`], ([mode, ignore, u]) =>
    mode === ANGLES && !((ignore! >> channel) & 1) ? u! * DEG_PER_RAD : NaN);
  return [...steps(moved, stick.pilot, true), ...steps(companion, stick.pilot, false)]
    .filter(armed).sort((a, b) => a.t - b.t);
}

/** The part of a step in which pilot or companion had the axis; none if it was the other one. The status comes at 10 Hz.
 * @param pilot  bits of Status.rc_override. */
function inForce(flight: Flight, pilot: number, step: Step, byPilot: boolean): Step[] {
  const SOON_S = 0.25;
  const MIN_S = 0.5;
  const status = flight.tables.get('/status');
  const override = status?.column('rc_override');
  if (!status || !override) return [];
  const holds = (row: number) => ((override[row]! & pilot) !== 0) === byPilot;
  let row = status.rowAt(step.t + SOON_S);
  if (row < 0 || !holds(row)) return [];
  while (row < status.length && status.times[row]! <= step.end_s && holds(row)) ++row;
  const end_s = Math.min(step.end_s, status.times[Math.min(row, status.length) - 1]!);
  return end_s - step.t >= MIN_S ? [{...step, end_s}] : [];
}
