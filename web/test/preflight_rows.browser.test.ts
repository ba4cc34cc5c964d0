// SPDX-License-Identifier: BSD-3-Clause
// Rows of the firmware's checks before arming, each provoked in a simulated vehicle, and found on the page of its log.
import assert from 'node:assert/strict';
import {type ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {checksAt, WAYS_OUT, type CheckLine} from '../src/data/checks.ts';
import {goTo, onPage, SMALL, startBrowser} from './browser.ts';
import {flyWatched, until, view, viewer} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_rows_'));
const running: ChildProcess[] = [];
after(async () => {
  for (const program of running) program.kill('SIGKILL');
  await rm(scratch, {recursive: true});
});

/** What makes a row fail: changes of the simulation, or a parameter; and what ends it besides `heal`. */
const CAUSES: Record<string, {steer?: string; set?: {[name: string]: number}; back?: string}> = {
  'mixer': {set: {PRIMARY_MIXER: 255}},
  'ESC mixer': {set: {PRIMARY_MIXER: 0}},
  'IMU': {steer: 'fault imu'},
  'IMU time': {steer: 'board reversed_clock', back: 'board healthy'},
  'loop time': {steer: 'board slow', back: 'board healthy'},
  'receiver': {steer: 'fault rc_silence'},
  'failsafe': {set: {FAILSAFE_THR: -1}},
  'throttle': {steer: 'stick throttle 0.5', back: 'stick throttle 0'},
  'override': {steer: 'switch throttle_override off', back: 'switch throttle_override on'},
  'still': {steer: 'fault gyro_step_x=1'},
  'estimator': {steer: 'fault accel_step_z=5'}, // half of gravity is none
  'level': {steer: 'fault accel_step_y=3.5'},
  'sensors': {steer: 'fault baro'},
  'battery seen': {set: {PROP_CT: 0, USE_MOTOR_PARAM: 1}},
  'battery': {set: {BATT_VOLT_MAX: 40}},
};
/** The row under which the pilot tries to arm. */
const TRIED = 'failsafe';
/** vehicle.browser.test.ts has the damaged memory of a firmware as a process. */
const NOT_HERE = ['storage'];

test('each row that a simulated vehicle can show fails when it is provoked, says why and what to do, and passes again', {timeout: 300_000}, async () => {
  const folder = join(scratch, 'rows');
  const flight = await flyWatched(running, folder, '--hold', '--speed', '1');
  const one = await viewer(flight.url);
  await one.commands.takeControl();
  await one.commands.checks();
  const list = () => checksAt(one.flight, Infinity);
  await until(() => list() !== undefined);
  const row = (name: string): CheckLine => list()!.lines.find((line) => line.name === name)!;
  assert.equal(row('calibration').verdict, 'refuses', 'before it is calibrated');
  /** The step of the page's slider at which each row's failure is the newest that is known, and the reason. */
  const failures = new Map<string, {t: number; reason: string}>();
  const seen = async (name: string) => {
    const t = Math.ceil(100 * list()!.t) / 100;
    failures.set(name, {t, reason: row(name).reason});
    await until(() => one.flight.end_s > t + 0.01); // before a status says that it is healed
  };
  await seen('calibration');
  await one.steer('speed 20');
  await until(() => /stage arm/.test(flight.said()));
  const table = await readFile(new URL('../../firmware/core/arming_checks.hpp', import.meta.url), 'utf8');
  const names = [...table.matchAll(/\{Check::k\w+, +"([^"]+)"/g)].map(([, name]) => name!);
  assert.deepEqual([...Object.keys(CAUSES), ...NOT_HERE, 'calibration'].sort(), [...names].sort(), 'no row is forgotten');

  /** Asks again and again, for 60 s of the simulation at most. */
  const shows = async (name: string, bad: boolean) => {
    const start = one.flight.end_s;
    for (;;) {
      const before = list()!.t;
      await one.commands.checks();
      await until(() => list()!.t > before);
      if ((row(name).verdict !== 'pass') === bad) return;
      assert.ok(one.flight.end_s - start < 60, `${name} ${bad ? 'passes on' : 'fails on'}`);
    }
  };
  let refused = NaN;
  for (const [name, {steer, set, back}] of Object.entries(CAUSES)) {
    await shows(name, false);
    const link = one.flight.tables.get('/link/param_value')!;
    const wanted = Object.entries(set ?? {}).map(([one, value]) => ({name: one, value}));
    const former = wanted.map(({name: one}) => ({name: one, value: link.column('value')![link.text('name')!.lastIndexOf(one)]!}));
    const did = steer ? [await one.steer(steer)] : await one.commands.set(wanted);
    for (const {good, text} of did) assert.ok(good, `${name}: ${text}`);
    await shows(name, true);
    assert.ok(row(name).reason && WAYS_OUT[name], name);
    await seen(name);
    if (name === TRIED) {
      const refusals = () => one.flight.events.filter(({text}) => text.startsWith('Unable to arm: '));
      const known = refusals().length;
      await one.steer('switch arm on');
      await until(() => refusals().length > known);
      await one.steer('switch arm off');
      refused = refusals()[known]!.t;
    }
    if (back) await one.steer(back);
    await one.steer('heal');
    if (set) await one.commands.set(former);
    await shows(name, false);
  }
  one.socket.close();
  flight.child.kill('SIGINT');
  await new Promise((resolve) => flight.child.on('exit', resolve));

  const browser = await startBrowser();
  try {
    await onPage(browser, await view(running, folder), async (page) => {
      await page.getByRole('tab', {name: 'Preflight'}).click();
      for (const [name, {t, reason}] of failures) {
        await goTo(page, t);
        const shown = await page.locator('.preflight tr', {has: page.getByRole('rowheader', {name, exact: true})}).innerText();
        assert.match(shown, /✗ refuses|! warning/, name);
        assert.ok(shown.includes(`${reason}. ${WAYS_OUT[name]}`), `${name} at ${t} s: ${shown}`);
      }
      const attempt = page.locator('.refusal');
      await goTo(page, Math.floor(100 * refused - 1) / 100);
      assert.equal(await attempt.count(), 0);
      await goTo(page, Math.ceil(100 * refused + 1) / 100);
      assert.equal(await attempt.locator('h2').innerText(), `Attempt to arm at ${refused.toFixed(1)} s, refused`);
      assert.deepEqual(await attempt.locator('li').allInnerTexts(), [failures.get(TRIED)!.reason]);
    }, SMALL);
  } finally {
    await browser.close();
  }
});
