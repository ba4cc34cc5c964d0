// SPDX-License-Identifier: BSD-3-Clause
// Steps of the altitude of a simulated multirotor, as the view Tune makes and measures them. Without an integral the altitude is that of
//
//     tau s^3 + (1 + tau D) s^2 + (kd + D) s + kp                                                   (1)
//     m D = 4 rho n d^3 |C_T1|,   m g = 4 rho n^2 d^4 C_T0                                          (2)
//
// as the thrust of each of four propellers, rho n^2 d^4 (C_T0 + C_T1 J), falls with the air that comes from above, J = v / (n d), and
// follows its command with a lag tau. Its pole is the fastest by far, and what it leaves is a system of second order, whose response is known in
// closed form. Where the poles without it are real and far apart the slow one leaves a system of first order, for which the lag does not count.
import assert from 'node:assert/strict';
import type {ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {bytesSource} from '../src/data/bytes.ts';
import {readLog} from '../src/data/read_log.ts';
import {MAX_BESIDE, stepFigures} from '../src/data/step_response.ts';
import {ALTITUDE, axesOf, responseOf, stepsOf} from '../src/data/tune_axes.ts';
import {FIXED_WING, logOf} from './flights.ts';
import {flyWatched, until, viewer} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_altitude_'));
const running: ChildProcess[] = [];
after(async () => {
  for (const program of running) program.kill('SIGKILL');
  await rm(scratch, {recursive: true});
});

/** Of vehicles/multirotor.yaml, and the air at sea level. */
const m_kg = 3.5, d_m = 0.381, CT0 = 0.08729101, CT1 = -0.11006411, tau_s = 0.05, rho_kg_m3 = 1.225;
const GRAVITY_M_S2 = 9.80665;
const KP = 4;
const n_1_s = Math.sqrt(m_kg * GRAVITY_M_S2 / (4 * rho_kg_m3 * d_m ** 4 * CT0));
const DRAG_1_S = 4 * rho_kg_m3 * n_1_s * d_m ** 3 * -CT1 / m_kg; // D of (2)

/** Damping ratio of what is left of (1) without the pole of the lag, by Newton's method from -1 / tau. */
function dampingRatio(kd: number): number {
  const a = 1 + tau_s * DRAG_1_S, b = kd + DRAG_1_S;
  let s = -1 / tau_s;
  for (let k = 0; k < 20; ++k) s -= (((tau_s * s + a) * s + b) * s + KP) / ((3 * tau_s * s + 2 * a) * s + b);
  const sum = a + tau_s * s; // what is left is tau s^2 + sum s + product
  const product = b + sum * s;
  return sum / 2 / Math.sqrt(tau_s * product);
}

/** The slow answer has the largest step that there is, for the noise; in the others the vehicle would be faster than (2) is linear for. */
const STEPS = [{kd: 1.3, size_m: 2}, {kd: 2.5, size_m: 2}, {kd: 8, size_m: 3}];

const near = (actual: number, wanted: number, within: number, what: string) => assert.ok(Math.abs(actual - wanted) < within, `${what}: ${actual}, wanted ${wanted}`);

test('steps of the altitude are answered as the systems of first and second order that their gains make', {timeout: 120_000}, async () => {
  const mission = join(scratch, 'high.yaml');
  await writeFile(mission, 'mission:\n  - {type: hold, w: [0, 0, -8], speed: 4, heading_deg: 0, hold_seconds: 600}\n');
  const {child, url} = await flyWatched(running, join(scratch, 'flight'), '--mission', mission, '--speed', '20',
    // The slow errors of these sensors move the vehicle during a step.
    '--set', 'vehicle.sensors.gnss.vertical_m.drift_sigma=0', '--set', 'vehicle.sensors.baro.pressure_Pa.bias_walk=0');
  const {commands, steer, flight: live} = await viewer(url);
  await commands.takeControl();
  const does = async (text: string, s: number) => {
    const {good, text: why} = await steer(text);
    assert.ok(good, why);
    const end = live.end_s + s;
    await until(() => live.end_s >= end);
  };
  await until(() => live.end_s > 30);
  const [p, i, d] = ALTITUDE.gains;
  await does(`tune ${i} 0`, 0); // the integral stays: it carries what hover thrust and model differ by
  await does(`tune ${p} ${KP}`, 0);
  for (const {kd, size_m} of STEPS) {
    await does(`tune ${d} ${kd}`, 1);
    await does(`altitude_offset ${size_m}`, 12);
    await does('altitude_offset 0', 12);
  }
  child.kill('SIGINT');
  await new Promise((resolve) => child.on('exit', resolve));

  const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(join(scratch, 'flight', 'flight.mcap')))));
  const response = responseOf(flight, ALTITUDE)!;
  const steps = stepsOf(flight, ALTITUDE, new Map());
  assert.deepEqual(steps.map(({from, to}) => Math.round(to - from)), STEPS.flatMap(({size_m}) => [size_m, -size_m]));
  const figures = steps.map((step) => stepFigures(response, step, 0.05)!);
  for (const {beside} of figures) assert.ok(beside < MAX_BESIDE / 4, `${beside}`);
  for (const [k, {kd}] of STEPS.entries()) {
    // The noise of the estimate, some 2 cm, moves a crossing of 10 or 90 % of the slow answer by 0.1 s: the mean of up and down.
    const mean = (of: (one: typeof figures[0]) => number) => (of(figures[2 * k]!) + of(figures[2 * k + 1]!)) / 2;
    const overshoot = mean((one) => one.overshoot);
    const c = kd + DRAG_1_S;
    if (c < 2 * Math.sqrt(KP)) {
      const ratio = dampingRatio(kd);
      near(overshoot, Math.exp(-Math.PI * ratio / Math.sqrt(1 - ratio * ratio)), 0.04, `overshoot with ${kd}`);
    } else {
      near(mean((one) => one.rise_s) * (c - Math.sqrt(c * c - 4 * KP)) / 2, Math.log(9), 0.1, 'rise times the slow pole');
      assert.ok(overshoot < 0.04, `${overshoot}`);
    }
  }
});

test('a fixed wing has none: its path climbs by ramps', async () => {
  const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(FIXED_WING)))));
  assert.equal(axesOf(flight).includes(ALTITUDE), false);
});
