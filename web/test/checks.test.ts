// SPDX-License-Identifier: BSD-3-Clause
// What keeps a vehicle from arming, out of messages as the log has them.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';
import {checksAt, flagsAt, linesAt, refusalAt, wayOut, WAYS_OUT} from '../src/data/checks.ts';
import {Flight} from '../src/data/flight.ts';
import {parseSchema} from '../src/data/ros_schema.ts';

const RESULT = parseSchema('rosflight_log_msgs/msg/CheckResult', 'uint8 index\nuint8 count\nuint8 result\nstring name\nstring reason');
const STATUS = parseSchema('rosflight_msgs/msg/Status', 'uint16 error_code\nbool armed');

function text(value: string): number[] {
  const bytes = [...new TextEncoder().encode(value), 0];
  return [bytes.length, 0, 0, 0, ...bytes];
}

/** CDR: strings stand at multiples of 4. */
function result(index: number, count: number, verdict: number, name: string, reason: string): Uint8Array {
  const body = [index, count, verdict, 0, ...text(name)];
  while (body.length % 4) body.push(0);
  return Uint8Array.from([0, 1, 0, 0, ...body, ...text(reason)]);
}

test('each check of the firmware has a way out, and no other', async () => {
  const table = await readFile(new URL('../../firmware/core/arming_checks.hpp', import.meta.url), 'utf8');
  const names = [...table.matchAll(/\{Check::k\w+, +"([^"]+)"/g)].map(([, name]) => name!);
  assert.equal(names.length, Number(/kCheckCount = (\d+)/.exec(table)![1]));
  assert.deepEqual(Object.keys(WAYS_OUT).sort(), names.sort());
});

test('each flag of the status has a way out, which needs no other program: the page has the link', () => {
  const flight = new Flight('made');
  flight.add('/status', STATUS, 1, Uint8Array.from([0, 1, 0, 0, 0xff, 0, 0]));
  const lines = flagsAt(flight, 9)!;
  assert.deepEqual(lines.map(({verdict}) => verdict), Array.from({length: 8}, () => 'refuses'));
  for (const {name} of lines) assert.match(wayOut(name), /^[A-Z].*\.$/, name);
  for (const [name, text] of Object.entries(WAYS_OUT)) assert.ok(!text.includes('./rosflight'), `${name}: ${text}`);
});

test('the list is the newest that is complete', () => {
  const flight = new Flight('made');
  const add = (t: number, ...line: Parameters<typeof result>) => flight.add('/link/check_result', RESULT, t, result(...line));
  assert.equal(checksAt(flight, 9), undefined);
  add(1, 0, 2, 2, 'mixer', 'invalid mixer');
  assert.equal(checksAt(flight, 9), undefined);
  add(1.1, 1, 2, 1, 'level', 'vehicle is not level');
  add(2, 0, 2, 0, 'mixer', '');
  const list = checksAt(flight, 9)!;
  assert.equal(list.t, 1.1);
  assert.deepEqual(list.lines, [{name: 'mixer', verdict: 'refuses', reason: 'invalid mixer'}, {name: 'level', verdict: 'warning', reason: 'vehicle is not level'}]);
  add(2.1, 1, 2, 0, 'level', '');
  assert.deepEqual(checksAt(flight, 9)!.lines.map(({verdict}) => verdict), ['pass', 'pass']);
  assert.equal(checksAt(flight, 2)!.t, 1.1);
});

test('flags of the status stand for checks', () => {
  const flight = new Flight('made');
  assert.equal(flagsAt(flight, 9), undefined);
  flight.add('/status', STATUS, 1, Uint8Array.from([0, 1, 0, 0, 0x21, 0, 0])); // invalid mixer, uncalibrated IMU
  assert.deepEqual(flagsAt(flight, 9)!.filter(({verdict}) => verdict === 'refuses').map(({name}) => name), ['mixer', 'calibration']);
});

test('a flag that changes after the list counts', () => {
  const flight = new Flight('made');
  flight.add('/status', STATUS, 0.9, Uint8Array.from([0, 1, 0, 0, 0, 0, 0]));
  flight.add('/link/check_result', RESULT, 1, result(0, 2, 2, 'mixer', 'invalid mixer'));
  flight.add('/link/check_result', RESULT, 1, result(1, 2, 2, 'throttle', 'throttle not low'));
  assert.deepEqual(linesAt(flight, 1)!.map(({verdict}) => verdict), ['refuses', 'refuses'], 'and not one from before it');
  flight.add('/status', STATUS, 2, Uint8Array.from([0, 1, 0, 0, 0, 0, 0]));
  assert.deepEqual(linesAt(flight, 2), [{name: 'mixer', verdict: 'pass', reason: ''}, {name: 'throttle', verdict: 'refuses', reason: 'throttle not low'}]);
});

test('a refused attempt stands until the vehicle arms', () => {
  const flight = new Flight('made');
  const event = (t: number, said: string) => flight.events.push({t, tone: 'bad', source: 'fcu', text: said});
  event(1, 'Unable to arm: RC signal lost');
  event(3, 'Unable to arm: throttle not low');
  event(3.01, 'Unable to arm: vehicle is being moved');
  assert.equal(refusalAt(flight, 0.5), undefined);
  assert.deepEqual(refusalAt(flight, 4)!.reasons, ['throttle not low', 'vehicle is being moved']);
  flight.add('/status', STATUS, 5, Uint8Array.from([0, 1, 0, 0, 0, 0, 1]));
  flight.add('/status', STATUS, 7, Uint8Array.from([0, 1, 0, 0, 0, 0, 0]));
  assert.equal(refusalAt(flight, 4)!.t, 3.01);
  for (const t of [6, 8]) assert.equal(refusalAt(flight, t), undefined);
});
