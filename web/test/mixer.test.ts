// SPDX-License-Identifier: BSD-3-Clause
// The airframe out of the mixer's parameters.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {CHANNEL_PARAMETERS, mixedOutputs, placeOf, usesOf} from '../src/data/mixer.ts';
import {parseParameterFile} from '../src/data/parameter_file.ts';
import {MULTIROTOR} from './flights.ts';

const values = new Map(parseParameterFile(await readFile(join(MULTIROTOR, 'parameters.yaml'), 'utf8')).map(({name, value}) => [name, value]));

test('motors of the X stand where the vehicle file has them, and yaw in turn', async () => {
  const outputs = mixedOutputs(values);
  assert.equal(outputs.length, 4);
  const file = await readFile(new URL('../../vehicles/multirotor.yaml', import.meta.url), 'utf8');
  const rotors = [...file.matchAll(/position_m: *\[ *([-\d.]+), *([-\d.]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);
  assert.equal(rotors.length, 4, 'rotors of the file');
  for (const one of outputs) {
    const {front, right} = placeOf(one, outputs);
    const [x, y] = rotors[one.output]!;
    assert.ok(one.isMotor && one.thrust > 0);
    assert.ok(front * x! > 0 && right * y! > 0, `output ${one.output}: ${front}, ${right} in the mixer, ${x}, ${y} in the file`);
  }
  assert.equal(outputs.filter(({yaw}) => yaw > 0).length, 2);
});

test('each parameter that names a channel is known, and a channel has all its uses', async () => {
  const csv = await readFile(new URL('../../firmware/core/parameters.csv', import.meta.url), 'utf8');
  const named = [...csv.matchAll(/^(RC_\w+_CHN),.*channel \(0-based\)/gm)].map(([, name]) => name!).filter((name) => !name.startsWith('RC_NUM'));
  assert.deepEqual(Object.keys(CHANNEL_PARAMETERS).sort(), named.sort());
  assert.deepEqual(usesOf(new Map([['RC_X_CHN', 0], ['RC_ATT_OVRD_CHN', 5], ['RC_THR_OVRD_CHN', 5], ['RC_ARM_CHN', -1]]), 5), ['attitude override', 'throttle override']);
});
