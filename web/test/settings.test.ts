// SPDX-License-Identifier: BSD-3-Clause
// Keys of autonomy and vehicle as the pages of docs have them, against the files of vehicles.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {parseKeyPage, parseSettings} from '../src/data/settings.ts';
import {MULTIROTOR} from './flights.ts';

const read = (name: string) => readFile(new URL(`../../${name}`, import.meta.url), 'utf8');
const autonomy = await read('docs/autonomy-keys.md');
const vehicle = await read('docs/vehicle-keys.md');

test('each key has its unit, default, range and meaning, and belongs to its kind of vehicle', () => {
  const keys = parseKeyPage(autonomy, 'multirotor');
  assert.deepEqual(keys.find(({key}) => key === 'autonomy.limits.tilt_deg'),
    {key: 'autonomy.limits.tilt_deg', standard: '30', unit: 'deg', allowed: 'from 1 to 60', meaning: 'of every commanded attitude'});
  assert.ok(keys.some(({key}) => key === 'autonomy.attitude_loops'), 'a key without a section around it');
  assert.ok(keys.some(({key}) => key.startsWith('autonomy.estimator.sigma.')));
  assert.ok(!keys.some(({key}) => key === 'autonomy.takeoff.rotate_m_s'));
  assert.ok(parseKeyPage(autonomy, 'fixed wing').some(({key}) => key === 'autonomy.takeoff.rotate_m_s'));
  for (const kind of ['multirotor', 'fixed wing'] as const) {
    const all = [...parseKeyPage(autonomy, kind), ...parseKeyPage(vehicle, kind)].map(({key}) => key);
    assert.equal(new Set(all).size, all.length, 'once each');
  }
});

test('every key that a vehicle gives is one of the pages', async () => {
  const values = parseSettings(await readFile(join(MULTIROTOR, 'vehicle.yaml'), 'utf8'));
  const known = new Set([...parseKeyPage(autonomy, 'multirotor'), ...parseKeyPage(vehicle, 'multirotor')].map(({key}) => key));
  const own = new Set(['type', 'environment.start_utc', 'sensors.preset']); // said in a sentence of the page
  for (const key of values.keys()) assert.ok(known.has(key) || own.has(key) || key.startsWith('firmware.'), key);
  assert.equal(values.get('body.mass_kg'), '3.5');
  assert.equal(values.get('autonomy.follower.horizontal.kp_1_s2'), '6.0');
});

test('lists stand in brackets, and those of maps are left out', () => {
  const values = parseSettings('a:\n  layout:\n    -\n      output: 0\n      spin: 1\n  points:\n    - [1, 2]\n    - [3, 4]\n  after: "x: y"\nb: [5]\n');
  assert.deepEqual([...values], [['a.points', '[[1, 2], [3, 4]]'], ['a.after', '"x: y"'], ['b', '[5]']]);
});
