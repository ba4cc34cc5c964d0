// SPDX-License-Identifier: BSD-3-Clause
// Which sample a chart shows where another of its curves has one.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {lastRow, shownRow, type Column} from '../src/data/curves.ts';

const TIMES = [0, 0.1, 0.2, 0.3, 1.2, 1.3, 9, 10];

function shown(values: Column): (number | null | undefined)[] {
  return TIMES.map((_, row) => values[shownRow(TIMES, values, lastRow(values), row)]);
}

test('between its samples a curve shows the one before', () => {
  assert.deepEqual(shown([5, undefined, 6, undefined, undefined, undefined, undefined, 7]), [5, 5, 6, 6, 6, 6, 6, 7]);
});

test('a curve that has ended shows its last value for a second', () => {
  assert.deepEqual(shown([5, undefined, 6, undefined, undefined, undefined, undefined, undefined]),
    [5, 5, 6, 6, 6, undefined, undefined, undefined]);
});

test('a rare one shows it for three intervals', () => {
  assert.deepEqual(shown([5, undefined, undefined, undefined, undefined, 6, undefined, undefined]), [5, 5, 5, 5, 5, 6, undefined, undefined]);
  assert.deepEqual(shown([undefined, undefined, undefined, undefined, 5, undefined, 6, undefined]),
    [undefined, undefined, undefined, undefined, 5, 5, 6, 6]);
});

test('a gap has no value, nor has a curve without samples', () => {
  assert.deepEqual(shown([5, null, undefined, undefined, undefined, undefined, 6, undefined]), [5, null, null, null, null, null, 6, 6]);
  assert.deepEqual(shown(TIMES.map(() => undefined)), TIMES.map(() => undefined));
});
