// SPDX-License-Identifier: BSD-3-Clause
// What each output does, out of the mixer's parameters: PRI_MIXER_r_k is the share of output k in the forces along the body's axes (r = 0, 1, 2)
// and in the torques about them (3, 4, 5).

/** `thrust` is upwards, `ahead` that of a propeller in front or behind. */
export interface MixedOutput { output: number; isMotor: boolean; thrust: number; ahead: number; roll: number; pitch: number; yaw: number }

const OUTPUTS = 10;
const MOTOR = 2; // PRI_MIXER_OUT_k

/** Outputs that the mixer drives; none while its parameters are not known. */
export function mixedOutputs(values: ReadonlyMap<string, number>): MixedOutput[] {
  const share = (row: number, k: number) => values.get(`PRI_MIXER_${row}_${k}`) ?? 0;
  return Array.from({length: OUTPUTS}, (_, k) => ({
    output: k, isMotor: values.get(`PRI_MIXER_OUT_${k}`) === MOTOR, thrust: 0 - share(2, k), ahead: share(0, k),
    roll: share(3, k), pitch: share(4, k), yaw: share(5, k),
  })).filter(({output}) => [0, 1, 2, 3, 4, 5].some((row) => share(row, output) !== 0));
}

/** Where a rotor is as seen from above, from its torques: nose up by those in front, right side down by those on the left. -1 to 1. */
export function placeOf({roll, pitch}: MixedOutput, all: readonly MixedOutput[]): {front: number; right: number} {
  const largest = Math.max(...all.map((one) => Math.hypot(one.roll, one.pitch)), 1e-9);
  return {front: pitch / largest, right: -roll / largest};
}

/** The parameters that name a receiver channel, and what is on it. */
export const CHANNEL_PARAMETERS: Record<string, string> = {
  RC_X_CHN: 'roll', RC_Y_CHN: 'pitch', RC_Z_CHN: 'yaw', RC_F_CHN: 'throttle', RC_ATT_OVRD_CHN: 'attitude override',
  RC_THR_OVRD_CHN: 'throttle override', RC_ATT_CTRL_CHN: 'angle or rate', RC_ARM_CHN: 'arm',
};

/** What is on receiver channel `channel`, from 0; several switches may share one. */
export function usesOf(values: ReadonlyMap<string, number>, channel: number): string[] {
  return Object.entries(CHANNEL_PARAMETERS).filter(([name]) => values.get(name) === channel).map(([, use]) => use);
}
