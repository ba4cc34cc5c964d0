// SPDX-License-Identifier: BSD-3-Clause
// The firmware's table and parameter files, against what the firmware's own programs wrote.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {changesIn, typed, type Edits} from '../src/data/edits.ts';
import {differences, formatParameterFile, parseParameterFile} from '../src/data/parameter_file.ts';
import {allowedText, complaint, groupsOf, parseParameterTable, sameValue} from '../src/data/parameter_table.ts';
import {MULTIROTOR} from './flights.ts';

const infos = parseParameterTable(await readFile(new URL('../../firmware/core/parameters.csv', import.meta.url), 'utf8'));
const written = await readFile(join(MULTIROTOR, 'parameters.yaml'), 'utf8');

test('the table has every parameter that the firmware has', () => {
  const file = parseParameterFile(written);
  assert.deepEqual([...infos.keys()].sort(), file.map(({name}) => name).sort());
  for (const {name, isFloat, value} of file) {
    assert.equal(isFloat, infos.get(name)!.isFloat, name);
    assert.equal(complaint(String(value), infos.get(name)), '', name);
  }
  assert.match(infos.get('BAUD_RATE')!.description, /once at start-up, so a change/);
});

test('a file is written as the firmware\'s own programs write it', () => {
  assert.equal(formatParameterFile(parseParameterFile(written)), written.replace(/^#.*\n/gm, ''));
});

test('a value says why it is none', () => {
  assert.equal(complaint('4', infos.get('NUM_MOTORS')), '');
  assert.equal(complaint('4.5', infos.get('NUM_MOTORS')), 'no whole number');
  assert.equal(complaint('11', infos.get('NUM_MOTORS')), 'allowed: 1 .. 10');
  for (const text of ['', 'four', 'NaN', 'Infinity']) assert.equal(complaint(text, infos.get('NUM_MOTORS')), 'no number');
  const apart = [...infos.values()].find(({sentinel, max}) => sentinel !== undefined && sentinel > max)!;
  assert.equal(complaint(String(apart.sentinel), apart), '');
  assert.match(allowedText(apart), new RegExp(`^${apart.sentinel}, `));
});

test('values are the same if the link carries the same', () => {
  assert.ok(sameValue(0.1, Math.fround(0.1)));
  assert.ok(!sameValue(0.1, 0.1000001));
  assert.ok(!sameValue(16777216, 16777217), 'integers have 32 bits');
});

test('a file that is none is refused with its line', () => {
  for (const [line, why] of [['nonsense', /line 2: found nonsense/], ['- {name: A, type: 6}', /line 2/], ['- {name: A, type: 6, value: 1.5}', /line 2/],
    ['- {name: A, type: 7, value: 1}', /line 2/], ['- {name: A, type: 6, value: }', /line 2/], ['- {name: B, type: 6, value: 1}', /twice/]] as const) {
    assert.throws(() => parseParameterFile(`- {name: B, type: 6, value: 1}\n${line}\n`), why);
  }
});

test('differences are those that sending would change', () => {
  const here = new Map([['A', Math.fround(0.1)], ['B', 2]]);
  const file = parseParameterFile('- {name: A, type: 9, value: 0.1}\n- {name: B, type: 6, value: 3}\n- {name: C, type: 6, value: 1}\n');
  assert.deepEqual(differences(here, file), [{name: 'B', here: 2, there: 3}, {name: 'C', here: undefined, there: 1}]);
});

test('groups are of three and more', () => assert.deepEqual(groupsOf(['A_1', 'A_2', 'A_3', 'B_1', 'B_2']), ['A']));

test('a number is sent as it is typed, also where its first letters are the value that is there', () => {
  for (const [value, text] of [[0, '0.001'], [1, '1.5'], [12, '120'], [0.5, '0.50'], [-1, '-1.25']] as const) {
    const values = new Map([['GAIN', value]]);
    let edits: Edits = new Map();
    for (let letters = 0; letters <= text.length; ++letters) {
      const field = text.slice(0, letters);
      edits = typed(edits, 'GAIN', field, String(value));
      assert.equal(edits.get('GAIN') ?? String(value), field, 'what the field shows');
    }
    assert.deepEqual(changesIn(edits, values), Number(text) === value ? [] : [['GAIN', text]]);
  }
});
