// SPDX-License-Identifier: BSD-3-Clause
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {readMessage} from '../src/data/cdr.ts';
import {parseSchema} from '../src/data/ros_schema.ts';
import {Table} from '../src/data/table.ts';
import {random} from './random.ts';

const hex = (text: string) => Uint8Array.from(text.match(/[0-9a-f]{2}/g)!, (byte) => parseInt(byte, 16));

// Laid out by hand after OMG CORBA 3.3 part 2, section 9.3: each value at a multiple of its size behind the four bytes.
const MIXED = parseSchema('a/Mixed', 'uint8 a\nfloat64 b\nstring c\nint16[] d\nuint8 e\nint64 f');
const BYTES = hex(`00010000
  07 00000000000000 000000000000f83f
  03000000 686900 00
  02000000 feff0300
  09 000000 00000000 fbffffffffffffff`);

test('values, texts and sequences are where their alignment puts them', () => {
  assert.deepEqual(readMessage(MIXED, BYTES), {a: 7, b: 1.5, c: 'hi', d: [-2, 3], e: 9, f: -5});
});

test('big-endian messages are read too', () => {
  const type = parseSchema('a/B', 'uint16 x\nfloat32 y');
  assert.deepEqual(readMessage(type, hex('00000000 0102 0000 3fc00000')), {x: 258, y: 1.5});
});

test('a table has the same values as columns', () => {
  const table = new Table(MIXED);
  for (let row = 0; row < 200; ++row) table.add(row / 10, BYTES);
  assert.deepEqual(table.names.sort(), ['a', 'b', 'd[0]', 'd[1]', 'e', 'f']);
  assert.equal(table.column('d[1]')!.length, 200);
  assert.equal(table.column('d[1]')![199], 3);
  assert.equal(table.text('c')![199], 'hi');
  assert.equal(table.rowAt(5.05), 50);
  assert.equal(table.rowAt(-1), -1);
  assert.equal(table.valueAt('b', 3.33), 1.5);
});

test('an element that a message does not have is no number', () => {
  const type = parseSchema('a/B', 'float32[] x');
  const table = new Table(type);
  table.add(0, hex('00010000 01000000 0000803f'));
  table.add(1, hex('00010000 02000000 0000803f 00000040'));
  assert.deepEqual([...table.column('x[1]')!], [NaN, 2]);
});

test('values between messages are linear, those outside the nearest', () => {
  const table = new Table(parseSchema('a/B', 'float32 x'));
  table.add(1, hex('00010000 00000000'));
  table.add(2, hex('00010000 00002041')); // 10
  assert.deepEqual([0, 1.25, 2, 9].map((t) => table.valueAt('x', t)), [0, 2.5, 10, 10]);
});

test('a damaged message throws and leaves the table as it was', () => {
  const table = new Table(MIXED);
  assert.throws(() => table.add(0, BYTES.subarray(0, 20)), RangeError);
  assert.throws(() => table.add(0, hex('00030000 00')), /encapsulation 3/);
  assert.throws(() => readMessage(parseSchema('a/B', 'string[] x'), hex('00010000 ffffffff')), /cannot hold a sequence/);
  assert.equal(table.length, 0);
});

test('whatever the bytes are, reading ends with a value or an error', () => {
  const type = parseSchema('a/Deep', 'Inner[] inner\nstring s\nfloat64[] d\n===\nMSG: a/Inner\nstring[] names\nuint8[2] two');
  const next = random(1);
  for (let run = 0; run < 20_000; ++run) {
    const bytes = Uint8Array.from({length: next() % 60}, (_, k) => k === 1 ? 1 : k < 4 ? 0 : next() % 4 ? 0 : next() % 256);
    for (const read of [() => readMessage(type, bytes), () => new Table(type).add(0, bytes)]) {
      try {
        read();
      } catch (error) {
        assert.ok(error instanceof RangeError || /encapsulation/.test((error as Error).message), String(error));
      }
    }
  }
});
