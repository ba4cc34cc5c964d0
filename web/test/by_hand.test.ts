// SPDX-License-Identifier: BSD-3-Clause
// Calibrations that a person does with a vehicle on a link, by the commands of the page's buttons, without a browser: what each says, how
// it ends, and what the vehicle then has. links.browser.test.ts does them on the page.
import assert from 'node:assert/strict';
import {type ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, describe, test} from 'node:test';
import {calibrationLines} from '../src/data/calibration_lines.ts';
import {parseParameterFile} from '../src/data/parameter_file.ts';
import type {Flight} from '../src/data/flight.ts';
import {MULTIROTOR, PARAMETERS, PYTHON, SIL, VIEW} from './flights.ts';
import {start, until, viewer} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_by_hand_'));
const running: ChildProcess[] = [];
after(async () => {
  for (const program of running) program.kill('SIGKILL');
  await rm(scratch, {recursive: true});
});

const PEER = new URL('../../ground/test/peer.py', import.meta.url).pathname; // a vehicle that is turned by hand

/** Those of the newest calibration, in one text. */
const said = (flight: Flight) => calibrationLines(flight).join('\n');
const latest = (flight: Flight, name: string) => {
  const values = flight.tables.get('/link/param_value')!;
  return values.column('value')![values.text('name')!.lastIndexOf(name)]!;
};
const known = (flight: Flight) => new Set(flight.tables.get('/link/param_value')?.text('name')).size;

async function show(link: string) {
  const folder = await mkdtemp(join(scratch, 'view'));
  const {found} = await start(running, VIEW, ['view', link, '--out', join(folder, 'flight')], /http:\S+/);
  const one = await viewer(found[0]);
  await one.commands.takeControl();
  return one;
}

describe('calibrations that a person does', {concurrency: true}, () => {
  test('receiver and speed controllers', {timeout: 300_000}, async () => {
    const {child, found} = await start(running, SIL, ['sil', '--link', 'tcp:0', '--nvm', join(scratch, 'transmitter.nvm'), '--rc', '-'], /link=(\S+)/);
    const {commands, flight} = await show(found[1]!);
    /** The person at the transmitter. */
    const move = (...controls: string[]) => child.stdin.write(`${controls.join('\n')}\n`);
    const told = (line: RegExp) => until(() => line.test(said(flight)));
    move('attitude_mode 1', 'throttle_override 1');
    await until(() => known(flight) === PARAMETERS);
    const file = parseParameterFile(await readFile(join(MULTIROTOR, 'parameters.yaml'), 'utf8'));
    for (const {good, text} of await commands.set(file)) assert.ok(good, text);

    const receiver = commands.calibrate('rc');
    await told(/move both sticks of the transmitter to all their ends/);
    assert.match((await commands.calibrate('mag'))[0]!.text, /rc is being calibrated/);
    for (let to = 1; !/release the sticks/.test(said(flight)); to = 1 - to) {
      move(...['roll', 'pitch', 'yaw', 'throttle'].map((stick) => `${stick} ${to}`));
      await new Promise((resolve) => setTimeout(resolve, 200));
    }
    move('roll 0.53', 'pitch 0.5', 'yaw 0.5', 'throttle 0');
    const [ranges] = await receiver;
    assert.ok(ranges!.good, ranges!.text);
    assert.match(said(flight), /roll stick \(channel \d+\): 1000 \.\. 2000 us/);
    assert.match(said(flight), /trim X_EQ_TORQUE: 0\.0 -> 0\.0\d*[1-9]/);

    const mixer = latest(flight, 'PRIMARY_MIXER');
    const speedControllers = commands.calibrate('esc_props_off');
    await told(/arm, then raise the throttle stick to its end/);
    move('arm 1');
    await until(() => flight.latest('/status', 'armed', Infinity) === 1);
    move('throttle 1');
    await told(/upper end 1\.000 on 10 outputs: power the speed controllers/);
    move('throttle 0');
    await told(/lower end 0\.000: wait for the tones, then disarm/);
    move('arm 0');
    const [ends] = await speedControllers;
    assert.deepEqual([ends!.good, ends!.text], [true, 'former mixer put back and stored']);
    assert.match(said(flight), /endpoints sent: 0\.000 and 1\.000 on 10 outputs/);
    assert.equal(latest(flight, 'PRIMARY_MIXER'), mixer);

    const again = commands.calibrate('esc_props_off');
    await until(() => latest(flight, 'PRIMARY_MIXER') === 0);
    assert.ok((await commands.calibrate('stop'))[0]!.good);
    const [stopped] = await again;
    assert.deepEqual([stopped!.good, stopped!.text], [false, 'stopped; former mixer put back and stored']);
    assert.equal(latest(flight, 'PRIMARY_MIXER'), mixer);
  });

  test('the magnetometer', {timeout: 300_000}, async () => {
    const {found} = await start(running, PYTHON, [PEER], /tcp:\S+/);
    const {commands, flight} = await show(found[0]);
    const [result] = await commands.calibrate('mag');
    assert.ok(result!.good, result!.text);
    const share = Number(/mag: fit residual ([\d.]+) % of the field, limit/.exec(said(flight))![1]);
    assert.ok(share < 1, said(flight));
    assert.ok(Math.abs(latest(flight, 'MAG_X_BIAS') - 15e-6) < 2e-6, 'of the peer');
  });
});
