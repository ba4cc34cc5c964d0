// SPDX-License-Identifier: BSD-3-Clause
// The pitot tube of a simulated fixed wing is calibrated by the command that the page's button sends; a stuck surface is a fault that it
// steers.
import assert from 'node:assert/strict';
import type {ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {bytesSource} from '../src/data/bytes.ts';
import {readLog} from '../src/data/read_log.ts';
import {flyWatched, until, viewer} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_pitot_'));
const running: ChildProcess[] = [];
after(async () => {
  for (const program of running) program.kill('SIGKILL');
  await rm(scratch, {recursive: true});
});

const BIAS_PA = 37;
const LIMIT_PA = 2; // as much of it ground/sensor_calibration.cpp allows to be left

test('the calibration of the pitot tube finds its bias, says how good it is, and is in the log', {timeout: 120_000}, async () => {
  const folder = join(scratch, 'flight');
  const {child, url} = await flyWatched(running, folder, '--vehicle', 'anaconda', '--mission', 'circuit', '--hold', '--speed', '20',
    '--set', `vehicle.sensors.diff_pressure.pressure_Pa.fixed_bias=${BIAS_PA}`);
  const {commands, steer, flight: live} = await viewer(url);
  await until(() => live.end_s > 20); // after what the pilot calibrates by himself
  await commands.takeControl();
  const [zero] = await commands.set([{name: 'DIFF_PRESS_BIAS', value: 0}]);
  assert.ok(zero!.good, zero!.text);
  const [result] = await commands.calibrate('airspeed');
  assert.ok(result!.good, result!.text);
  assert.match(result!.text, /^noise [\d.e-]+ Pa, limit 10 Pa; offset left -?[\d.e-]+ Pa, limit 2 Pa$/);
  assert.ok((await steer('fault servo0_stuck')).good);
  assert.equal((await steer('fault servo3_stuck')).good, false, 'it has three surfaces');
  child.kill('SIGINT');
  await new Promise((resolve) => child.on('exit', resolve));
  const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(join(folder, 'flight.mcap')))));
  const begun = flight.events.find(({source, text}) => source === 'viewer' && text.startsWith('viewer 1 calibrates airspeed'))!;
  const values = flight.tables.get('/link/param_value')!;
  const row = values.text('name')!.lastIndexOf('DIFF_PRESS_BIAS');
  const bias_Pa = values.column('value')![row]!;
  assert.ok(values.times[row]! > begun.t && Math.abs(bias_Pa - BIAS_PA) < LIMIT_PA, `${bias_Pa} Pa`);
});
