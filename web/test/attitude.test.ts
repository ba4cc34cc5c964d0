// SPDX-License-Identifier: BSD-3-Clause
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Quaternion, Vector3} from 'three';
import {between, eulerAngles, turned, type Quaternion as Attitude, type Triple} from '../src/data/attitude.ts';
import {attitudeFromNed, fromNed} from '../src/scene/frames.ts';
import {random} from './random.ts';

const near = (found: readonly number[], wanted: readonly number[]) => found.forEach((value, k) =>
  assert.ok(Math.abs(value - wanted[k]!) < 1e-6, `${found.join(' ')} instead of ${wanted.join(' ')}`));
const half = Math.SQRT1_2;

test('a quarter turn about each axis is a quarter turn of that angle', () => {
  near(eulerAngles([half, half, 0, 0]), [Math.PI / 2, 0, 0]);
  near(eulerAngles([half, 0, 0, half]), [0, 0, Math.PI / 2]);
  near(eulerAngles([Math.cos(0.2), 0, Math.sin(0.2), 0]), [0, 0.4, 0]);
});

test('nose right by a quarter turn points the front to the east', () => {
  near(turned([half, 0, 0, half], [1, 0, 0]), [0, 1, 0]);
});

test('a model turned for the picture points where the vehicle does', () => {
  const next = random(3);
  for (let run = 0; run < 200; ++run) {
    const raw = Array.from({length: 4}, () => next() / 2 ** 30 - 1);
    const q = raw.map((value) => value / Math.hypot(...raw)) as unknown as Attitude;
    for (const v of [[1, 0, 0], [0, 1, 0], [0, 0, 1]] as Triple[]) {
      // The model's front is -z, its right x, its down -y: a body vector goes into the model as a point of NED goes into the picture.
      const shown = fromNed(v).applyQuaternion(attitudeFromNed(q));
      near(shown.toArray(), fromNed(turned(q, v)).toArray());
    }
  }
});

test('north is away from the viewer, east right, up up', () => {
  near(fromNed([1, 2, -3]).toArray(), [2, 3, -1]);
  assert.ok(attitudeFromNed([1, 0, 0, 0]).equals(new Quaternion()));
  near(new Vector3(0, 0, -1).applyQuaternion(attitudeFromNed([half, 0, 0, half])).toArray(), [1, 0, 0]);
});

test('between two attitudes the shorter rotation is taken', () => {
  near(between([1, 0, 0, 0], [-1, 0, 0, 0], 0.5), [1, 0, 0, 0]);
  const middle = between([1, 0, 0, 0], [half, 0, 0, half], 0.5);
  near(eulerAngles(middle), [0, 0, Math.PI / 4]);
});
