// SPDX-License-Identifier: BSD-3-Clause
// The simulation steered from outside, and the flight repeated from its log to the bit.
import assert from 'node:assert/strict';
import {spawn, type ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {bytesSource} from '../src/data/bytes.ts';
import {readLog} from '../src/data/read_log.ts';
import {FLY} from './flights.ts';
import {flyWatched, until, viewer} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_steering_'));
const running: ChildProcess[] = [];
after(async () => {
  for (const program of running) program.kill('SIGKILL');
  await rm(scratch, {recursive: true});
});

const fly = (folder: string, ...options: string[]) => flyWatched(running, join(scratch, folder), ...options);

/** @param log  the folder of a flight, or a log in it. @returns exit code and what it said. */
async function repeat(folder: string, log = folder) {
  const child = spawn(FLY, ['fly', '--repeat', join(scratch, log), '--json', '--out', join(scratch, `${folder}_again`)], {stdio: ['ignore', 'pipe', 'pipe']});
  running.push(child);
  let said = '';
  let printed = '';
  child.stdout.on('data', (data) => { printed += String(data); });
  child.stderr.on('data', (data) => { said += String(data); });
  const code = await new Promise<number>((resolve) => child.on('close', resolve));
  return {code, said, summary: JSON.parse(printed) as Record<string, unknown>};
}

const read = async (folder: string) => readLog(bytesSource('log', new Uint8Array(await readFile(join(scratch, folder, 'flight.mcap')))));

test('a flight changed by hand is repeated from its log to the bit', {timeout: 240_000}, async () => {
  const flight = await fly('changed', '--speed', '4', '--hold');
  const one = await viewer(flight.url);
  assert.equal((await one.steer('pause')).text, 'take control first');
  assert.ok((await one.commands.takeControl())[0]!.good);
  // A standing simulation takes commands, and goes on by single steps.
  assert.ok((await one.steer('pause')).good);
  await one.until((control) => control.paused);
  const set = one.commands.set([{name: 'BATT_CURR_ALPHA', value: 0.1 / 3}]); // ends when the simulation goes on
  assert.ok((await one.steer('step 4')).good);
  for (const text of ['resume', 'speed 8']) assert.ok((await one.steer(text)).good, text);
  for (const [text, why] of [['wind 99,0', /allowed SPEED,FROM_DEG/], ['fault baro@3', /it begins now/], ['fault motor9_dead', /motor 9, allowed 0 to/],
    ['stick roll 2', /allowed 0 to 1/], ['switch roll on', /allowed arm/], ['reset nowhere', /found 'nowhere'/], ['dance', /allowed wind/], ['step 0.5', /allowed/],
    ['tune limits.tilt_deg 99', /found 99, allowed .*from 1 to 60/], ['tune limits.tilt 20', /tilt/], ['tune estimator.range_delay_s 0.1', /before a flight alone/]] as const) {
    const {good, text: said} = await one.steer(text);
    assert.ok(!good && why.test(said), `${text}: ${said}`);
  }
  await one.until((control) => control.speed === 8);
  assert.equal((await set).length, 1);
  await until(() => /stage arm/.test(flight.said()));
  await new Promise((resolve) => setTimeout(resolve, 500)); // 4 s, in which the filter settles: it holds
  assert.ok(!/stage fly/.test(flight.said()));
  for (const answers of [await one.commands.calibrate('gyro'), await one.commands.write(), await one.commands.checks(), await one.commands.testMotor(0, 0.1)]) {
    assert.equal(answers.length, 1);
    assert.ok(answers[0]!.good, answers[0]!.text);
  }
  for (const text of ['wind 4,200,3', 'gust 6,90,2.5', 'hold off']) assert.ok((await one.steer(text)).good, text); // not before it is calibrated
  await until(() => /take-?off|phase takeoff|stage fly/.test(flight.said()));
  for (const text of ['tune limits.tilt_deg 20', 'tune follower.horizontal.kp_1_s2 4.5', 'fault gnss:2']) assert.ok((await one.steer(text)).good, text);
  for (const text of ['fault mag', 'pause']) assert.ok((await one.steer(text)).good, text); // it flies no further while the other one comes
  // Another viewer takes over, and the first one is notified.
  const two = await viewer(flight.url);
  assert.ok((await two.commands.takeControl())[0]!.good);
  await one.until((control) => control.viewer === two.seen.control!.you);
  assert.match((await one.steer('heal')).text, /viewer 2 has control/);
  for (const text of ['heal', 'switch attitude_override on', 'stick roll 0.52', 'stick roll 0.5', 'switch attitude_override off', 'land', 'resume']) assert.ok((await two.steer(text)).good, text);
  one.socket.close();
  await until(() => flight.printed().endsWith('}\n'));
  const summary = JSON.parse(flight.printed()) as Record<string, unknown>;
  flight.child.kill('SIGTERM');
  const again = await repeat('changed', join('changed', 'flight.mcap'));
  assert.equal(again.summary['log_sha256'], summary['log_sha256'], again.said);
  assert.equal(again.code, 0);
  assert.match(again.said, /commands repeated; the log is equal to the bit/);
  const {events, settings, tables} = await read('changed');
  assert.deepEqual(settings.map(({text}) => [/tilt_deg: (\S+)/.exec(text)![1], /kp_1_s2: (\S+)/.exec(text)![1]]), [['35', '6.0'], ['20', '6.0'], ['20', '4.5']]);
  const said = events.filter(({source}) => source === 'viewer');
  assert.ok(said.some(({text}) => /^viewer 2 takes control from viewer 1 \(step \d+\)$/.test(text)));
  for (const text of ['sets BATT_CURR_ALPHA', 'calibrates gyro', 'writes the parameters', 'asks for the checks before arming', 'tests motor 0 0.1'])
    assert.ok(said.some((line) => line.text.startsWith(`viewer 1 ${text}`)), text);
  assert.equal(said[0]!.text, 'viewer 0 steers: hold on (step 0)', 'by --hold');
  assert.match(said[1]!.text, /^viewer 1 is refused: steers: pause: take control first \(step/);
  assert.ok(said.some(({text}) => text.startsWith('viewer 1 is refused: steers: heal: viewer 2 has control')));
  const tested = said.find(({text}) => text.startsWith('viewer 1 tests motor'))!.t;
  const outputs = tables.get('/output_raw')!;
  const turned = (from: number, to: number) => outputs.column('values[0]')!.subarray(outputs.rowAt(from) + 1, outputs.rowAt(to) + 1).some((value) => value > 0.09);
  assert.ok(!turned(0, tested) && turned(tested, tested + 0.4), 'the motor turned');
  for (const {t, text} of said) assert.equal(Number(/\(step (\d+)\)$/.exec(text)![1]), Math.round(t / 0.0025), text);
});

test('after landing a viewer takes control and flies again', {timeout: 240_000}, async () => {
  const flight = await fly('landed', '--mission', 'hop', '--speed', '50');
  const one = await viewer(flight.url);
  await until(() => /has ended/.test(flight.said()));
  assert.equal((await one.steer('reset')).text, 'the flight has ended', 'without control');
  await one.commands.takeControl();
  assert.match((await one.steer('reset nowhere')).text, /found 'nowhere'/);
  assert.ok((await one.steer('reset hop')).good);
  await until(() => /has ended.*has ended/s.test(flight.said()));
  const [first, second] = flight.printed().trim().split('\n').map((line) => (JSON.parse(line) as Record<string, unknown>)['log_sha256']);
  assert.ok(first && first === second, 'nobody changed either');
  flight.child.kill('SIGTERM');
});

test('a reset ends a flight, its log is repeated, and another one begins', {timeout: 240_000}, async () => {
  const flight = await fly('reset', '--mission', 'hop');
  const one = await viewer(flight.url);
  await one.commands.takeControl();
  await until(() => /stage configure/.test(flight.said()));
  assert.ok((await one.steer('reset square')).good);
  await until(() => one.socket.readyState === WebSocket.CLOSED);
  const first = JSON.parse(/^{.*?}\n/.exec(flight.printed())![0]) as Record<string, unknown>;
  assert.equal(first['outcome'], 'interrupted');
  const next = await viewer(flight.url);
  await next.commands.takeControl();
  await until(() => /stage configure.*stage configure/s.test(flight.said()));
  flight.child.kill('SIGINT');
  await until(() => flight.child.exitCode !== null);
  const second = await read('reset-2');
  assert.equal(second.facts.get('mission_argument'), 'square');
  for (const folder of ['reset', 'reset-2']) assert.equal((await repeat(folder)).code, 0, folder);
});
