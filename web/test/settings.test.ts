// SPDX-License-Identifier: BSD-3-Clause
// Keys of autonomy and vehicle as the pages of docs have them, against the files of vehicles.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {parseKeyPage, parseSettings, perEntry} from '../src/data/settings.ts';
import {FIXED_WING, MULTIROTOR} from './flights.ts';

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
  const ofQuadplane = [...parseKeyPage(autonomy, 'quad-plane'), ...parseKeyPage(vehicle, 'quad-plane')].map(({key}) => key);
  for (const key of ['rotor_aero.', 'surfaces.', 'aero.', 'rotors.']) assert.ok(ofQuadplane.some((each) => each.startsWith(key)), key);
  assert.ok(!parseKeyPage(vehicle, 'multirotor').some(({key}) => key.startsWith('rotor_aero.')));
  for (const kind of ['multirotor', 'fixed wing', 'quad-plane'] as const) {
    const all = [...parseKeyPage(autonomy, kind), ...parseKeyPage(vehicle, kind)].map(({key}) => key);
    assert.equal(new Set(all).size, all.length, 'once each');
  }
});

test('every key that a vehicle gives is one of the pages', async () => {
  const values = parseSettings(await readFile(join(MULTIROTOR, 'vehicle.yaml'), 'utf8'));
  const known = new Set([...parseKeyPage(autonomy, 'multirotor'), ...perEntry(parseKeyPage(vehicle, 'multirotor'), values)].map(({key}) => key));
  const own = new Set(['type', 'environment.start_utc', 'sensors.preset']); // said in a sentence of the page
  for (const key of values.keys()) assert.ok(known.has(key) || own.has(key) || key.startsWith('firmware.'), key);
  assert.equal(values.get('body.mass_kg'), '3.5');
  assert.equal(values.get('autonomy.follower.horizontal.kp_1_s2'), '6.0');
});

test('lists stand in brackets, and entries of lists of maps have their number', () => {
  const values = parseSettings('a:\n  layout:\n    -\n      output: 0\n      tilt:\n        axis: [1, 0, 0]\n    -\n      output: 1\n  points:\n    - [1, 2]\n    - [3, 4]\n'
    + '  after: "x: y"\nb: [5]\nc:\n  layout:\n    -\n      output: 2\n');
  assert.deepEqual([...values], [['a.layout.0.output', '0'], ['a.layout.0.tilt.axis', '[1, 0, 0]'], ['a.layout.1.output', '1'], ['a.points', '[[1, 2], [3, 4]]'],
    ['a.after', '"x: y"'], ['b', '[5]'], ['c.layout.0.output', '2']]);
});

test('each rotor and surface of a vehicle has its keys, and a servo that tilts it only where there is one', async () => {
  const shown = (kind: 'multirotor' | 'fixed wing', yaml: string) => {
    const values = parseSettings(yaml);
    return perEntry(parseKeyPage(vehicle, kind), values).filter(({key}) => key.includes('.layout.')).map(({key, unit}) => [key, values.get(key) ?? 'default', unit]);
  };
  const rotor = (k: number) => ['output', 'position_m', 'thrust_direction', 'spin'].map((key) => `rotors.layout.${k}.${key}`);
  const four = shown('multirotor', await readFile(join(MULTIROTOR, 'vehicle.yaml'), 'utf8'));
  assert.deepEqual(four.map(([key]) => key), [0, 1, 2, 3].flatMap(rotor));
  assert.deepEqual(four[5], ['rotors.layout.1.position_m', '[-0.1768, 0.1768, -0.0762]', 'm'], 'as in vehicles/multirotor.yaml');
  const wing = shown('fixed wing', await readFile(join(FIXED_WING, 'vehicle.yaml'), 'utf8'));
  assert.deepEqual(wing.map(([key]) => key).sort(),
    [...rotor(0), ...[0, 1, 2].flatMap((k) => ['output', 'travel_deg', 'aileron', 'elevator', 'rudder'].map((key) => `surfaces.layout.${k}.${key}`))].sort());
  assert.deepEqual(wing.filter(([key]) => key!.startsWith('surfaces.layout.1')).map(([, value]) => value), ['1', '40', 'default', '-1', '1']);
  const tilted = shown('multirotor', 'rotors:\n  layout:\n    -\n      output: 0\n    -\n      output: 1\n      tilt:\n        output: 3\n');
  assert.deepEqual(tilted.filter(([key]) => key!.includes('.tilt.')).map(([key, value]) => [key, value]),
    [['output', '3'], ['axis', 'default'], ['travel_deg', 'default'], ['time_constant_s', 'default'], ['rate_limit_deg_s', 'default']]
      .map(([key, value]) => [`rotors.layout.1.tilt.${key}`, value]));
});
