// SPDX-License-Identifier: BSD-3-Clause
// Steps of a command, and how the vehicle answers them:
//
//     z(t) = (y(t) - y0) / (command - y0),  y0 the mean of y just before the step, t from the step on      (1)
//     rise time      from z = 0.1 to z = 0.9, each for the first time
//     overshoot      the largest z less 1, not less than 0
//     settling time  the last moment at which |z - 1| is more than the band
//
// as textbooks have them for a system that reaches its command (Ogata, Modern Control Engineering, 5-3).
import type {Curve} from './curves.ts';

/** A command that stood, jumped and stood again until `end_s`. */
export interface Step { t: number; end_s: number; from: number; to: number }
/** NaN: not within the time that the command stood. `beside` is how far y0 was from the command before, `left` from the one after, both as
 * shares of the step. */
export interface StepFigures { beside: number; rise_s: number; overshoot: number; settling_s: number; left: number }

const STOOD_S = 0.3;
const MEAN_S = 0.1; // of the answer before the step
const STANDS_S = 0.5;
const STANDING = 0.1; // of the step
const LEFT_SHARE = 0.2; // of the time after the step: the mean error at its end

/** @param minStep  in the unit of the command. */
export function findSteps({t, y}: Curve, minStep: number): Step[] {
  const steps: Step[] = [];
  for (let k = 1; k < y.length; ++k) {
    const [from, to] = [y[k - 1]!, y[k]!];
    const size = Math.abs(to - from);
    if (!(size >= minStep)) continue;
    let first = k - 1;
    while (first > 0 && Math.abs(y[first - 1]! - from) <= STANDING * size) --first;
    let last = k;
    while (last + 1 < y.length && Math.abs(y[last + 1]! - to) <= STANDING * size) ++last;
    if (t[k - 1]! - t[first]! >= STOOD_S && t[last]! - t[k]! >= STANDS_S) steps.push({t: t[k]!, end_s: t[last]!, from, to});
  }
  return steps;
}

/** @param band  0.05 or 0.02.
 * @returns nothing where the samples of the answer are missing. */
export function stepFigures(response: Curve, step: Step, band: number): StepFigures | undefined {
  const stood = samples(response, step.t - STOOD_S, step.t).filter(({t}) => t < step.t);
  const after = samples(response, step.t, step.end_s);
  if (stood.length === 0 || after.length < 2) return undefined;
  const last = stood.filter(({t}) => t >= step.t - MEAN_S);
  const before = last.length > 0 ? last : stood.slice(-1); // a busy computer may have missed the others
  const y0 = before.reduce((sum, {y}) => sum + y, 0) / before.length;
  const span = step.to - y0;
  const z = after.map(({t, y}) => ({t: t - step.t, z: (y - y0) / span}));
  const crossing = (level: number) => {
    const k = z.findIndex((one) => one.z >= level);
    return k < 0 ? NaN : k === 0 ? z[0]!.t : between(z[k - 1]!, z[k]!, level);
  };
  const peak = Math.max(...z.map((one) => one.z));
  const outside = z.findLastIndex((one) => Math.abs(one.z - 1) > band);
  const settled = outside + 1 < z.length;
  const edge = outside >= 0 && z[outside]!.z > 1 ? 1 + band : 1 - band;
  const tail = z.filter((one) => one.t >= (1 - LEFT_SHARE) * z.at(-1)!.t);
  return {
    beside: Math.abs(y0 - step.from) / Math.abs(step.to - step.from),
    rise_s: crossing(0.9) - crossing(0.1),
    overshoot: Math.max(peak - 1, 0),
    settling_s: !settled ? NaN : outside < 0 ? 0 : between(z[outside]!, z[outside + 1]!, edge),
    left: 1 - tail.reduce((sum, one) => sum + one.z, 0) / tail.length,
  };
}

type Point = {t: number; z: number};
const between = (a: Point, b: Point, level: number) => b.z === a.z ? b.t : a.t + (level - a.z) / (b.z - a.z) * (b.t - a.t);

function samples({t, y}: Curve, from: number, to: number): {t: number; y: number}[] {
  const out: {t: number; y: number}[] = [];
  for (let k = 0; k < t.length; ++k) if (t[k]! >= from && t[k]! <= to && Number.isFinite(y[k])) out.push({t: t[k]!, y: y[k]!});
  return out;
}

const SHOWN_BEFORE_S = 0.2;

/** Figures of a response that began elsewhere than at the command say nothing of this step. */
export const MAX_BESIDE = 0.2;

const SIMILAR = 0.2;
/** The latest step before that asked for about the same. */
export const similarBefore = (steps: readonly Step[], step: Step) => steps.findLast((one) => one.t < step.t
  && Math.abs((one.to - one.from) / (step.to - step.from) - 1) < SIMILAR);

/** A part of a curve, with the step at 0. */
export function around({t, y}: Curve, step: Step): Curve {
  const rows = [...t.keys()].filter((k) => t[k]! >= step.t - SHOWN_BEFORE_S && t[k]! <= step.end_s);
  return {t: Float64Array.from(rows, (k) => t[k]! - step.t), y: Float64Array.from(rows, (k) => y[k]!)};
}

export function commandOf(step: Step): Curve {
  return {t: Float64Array.of(-SHOWN_BEFORE_S, 0, 1e-6, step.end_s - step.t), y: Float64Array.of(step.from, step.from, step.to, step.to)};
}
