// SPDX-License-Identifier: BSD-3-Clause
// The figures of a step response, against closed forms of systems of first and second order.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {findSteps, stepFigures, type Step} from '../src/data/step_response.ts';

const RATE_HZ = 1000;
const STEP: Step = {t: 1, end_s: 11, from: 2, to: -6}; // downwards, from elsewhere than 0
const near = (actual: number, wanted: number, within: number, what: string) => assert.ok(Math.abs(actual - wanted) < within, `${what}: ${actual}, wanted ${wanted}`);

/** z(t) as the samples of a response to STEP. */
function sampled(z: (t: number) => number, rate_hz = RATE_HZ) {
  const t = Float64Array.from({length: 12 * rate_hz}, (_, k) => k / rate_hz);
  return {t, y: t.map((at) => STEP.from + (STEP.to - STEP.from) * (at < STEP.t ? 0 : z(at - STEP.t)))};
}

/** Unit step response of w^2 / (s^2 + 2 d w s + w^2), d < 1. */
const oscillator = (w: number, d: number) => (t: number) => {
  const damped = w * Math.sqrt(1 - d * d);
  return 1 - Math.exp(-d * w * t) * (Math.cos(damped * t) + d * w / damped * Math.sin(damped * t));
};

/** Where a function rises or falls through a level between a and b. */
function root(f: (t: number) => number, level: number, a: number, b: number): number {
  const rises = f(b) > f(a);
  for (let k = 0; k < 60; ++k) {
    const middle = (a + b) / 2;
    if (f(middle) > level === rises) b = middle;
    else a = middle;
  }
  return (a + b) / 2;
}

test('first order: rise ln 9, settled to 5 % after ln 20 and to 2 % after ln 50 time constants, no overshoot', () => {
  for (const tau of [0.1, 0.4]) {
    const response = sampled((t) => 1 - Math.exp(-t / tau));
    const five = stepFigures(response, STEP, 0.05)!;
    near(five.rise_s, tau * Math.log(9), 1e-5, 'rise');
    near(five.settling_s, tau * Math.log(20), 1e-5, 'settled to 5 %');
    near(stepFigures(response, STEP, 0.02)!.settling_s, tau * Math.log(50), 1e-5, 'settled to 2 %');
    assert.equal(five.overshoot, 0);
    near(five.left, 0, 1e-6, 'left');
  }
});

test('second order: overshoot exp(-pi d / sqrt(1 - d^2)); critically damped the known times', () => {
  for (const d of [0.2, 0.4, 0.6, 0.8]) {
    const w = 6;
    const figures = stepFigures(sampled(oscillator(w, d)), STEP, 0.05)!;
    near(figures.overshoot, Math.exp(-Math.PI * d / Math.sqrt(1 - d * d)), 1e-5, `overshoot at ${d}`);
    // It leaves the band for the last time in the half wave that still reaches it: between peak n and n + 1.
    const half = Math.PI / (w * Math.sqrt(1 - d * d));
    const peak = (n: number) => Math.exp(-n * half * d * w);
    let n = 1;
    while (peak(n + 1) > 0.05) ++n;
    const over = n % 2 === 1;
    const wanted = peak(1) > 0.05 ? root(oscillator(w, d), over ? 1.05 : 0.95, n * half, (n + 1) * half) : root(oscillator(w, d), 0.95, 0, half);
    near(figures.settling_s, wanted, 1e-4, `settled at ${d}`);
    const rise = root(oscillator(w, d), 0.9, 0, half) - root(oscillator(w, d), 0.1, 0, half);
    near(figures.rise_s, rise, 1e-5, `rise at ${d}`);
  }
  const w = 5;
  const critical = stepFigures(sampled((t) => 1 - (1 + w * t) * Math.exp(-w * t)), STEP, 0.05)!;
  near(critical.rise_s, 3.357908 / w, 1e-5, 'rise');
  near(critical.settling_s, 4.743865 / w, 1e-5, 'settled');
});

test('at the rate of the log figures are good to a tenth of a sample', () => {
  const figures = stepFigures(sampled(oscillator(8, 0.5), 100), STEP, 0.05)!;
  near(figures.overshoot, 0.163034, 5e-4, 'overshoot');
  near(figures.rise_s, root(oscillator(8, 0.5), 0.9, 0, 0.4) - root(oscillator(8, 0.5), 0.1, 0, 0.4), 1e-3, 'rise');
});

test('what does not reach the command is not settled, and says what is left', () => {
  const figures = stepFigures(sampled((t) => 0.8 * (1 - Math.exp(-t / 0.1))), STEP, 0.05)!;
  assert.ok(Number.isNaN(figures.settling_s) && Number.isNaN(figures.rise_s));
  near(figures.left, 0.2, 1e-6, 'left');
  near(figures.beside, 0, 1e-9, 'beside');
  near(stepFigures(sampled(() => 1), {...STEP, from: 0}, 0.05)!.beside, 2 / 6, 1e-9, 'beside');
  assert.equal(stepFigures({t: Float64Array.of(0), y: Float64Array.of(0)}, STEP, 0.05), undefined);
});

test('samples that a viewer missed just before the step: the last one counts while the command stood, then there are no figures', () => {
  const {t, y} = sampled((at) => 1 - Math.exp(-at / 0.1));
  const without = (hole_s: number) => {
    const kept = [...t.keys()].filter((k) => t[k]! >= STEP.t || t[k]! < STEP.t - hole_s);
    return stepFigures({t: Float64Array.from(kept, (k) => t[k]!), y: Float64Array.from(kept, (k) => y[k]!)}, STEP, 0.05);
  };
  for (const hole_s of [0.05, 0.15, 0.25]) near(without(hole_s)!.rise_s, 0.1 * Math.log(9), 1e-5, `rise after a hole of ${hole_s} s`);
  assert.equal(without(0.35), undefined);
});

test('a step stands before and after; ramps, blips and small ones are none', () => {
  const t = Float64Array.from({length: 500}, (_, k) => k / 50);
  const steps = (y: (t: number) => number) => findSteps({t, y: t.map(y)}, 3);
  const [up, down] = steps((at) => at >= 2 && at < 4 ? 10 : 0);
  assert.deepEqual([up, down].map((one) => [one!.t, one!.from, one!.to]), [[2, 0, 10], [4, 10, 0]]);
  assert.equal(up!.end_s, 3.98);
  assert.equal(steps((at) => Math.min(Math.max(at - 2, 0) * 20, 10)).length, 0, 'ramp');
  assert.equal(steps((at) => at >= 2 && at < 2.3 ? 10 : 0).length, 0, 'a blip, and the way back from it');
  assert.equal(steps((at) => at >= 2 ? 2.9 : 0).length, 0, 'small');
  assert.equal(steps((at) => at >= 2 ? 10 : NaN).length, 0, 'nothing was commanded before');
});
