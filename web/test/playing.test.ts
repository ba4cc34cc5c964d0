// SPDX-License-Identifier: BSD-3-Clause
// The clock of a replay, driven by the moments of animation frames that a test makes.
import assert from 'node:assert/strict';
import {afterEach, beforeEach, mock, test} from 'node:test';
import type {Flight} from '../src/data/flight.ts';
import {play, seek, speed, SPEEDS, time, flight, playing} from '../src/state.ts';

let waiting: FrameRequestCallback[] = [];
let now_ms = 0;

/** Frames come as `intervals` say, in milliseconds. */
function frames(...intervals: number[]) {
  for (const interval of intervals) {
    now_ms += interval;
    for (const callback of waiting.splice(0)) callback(now_ms);
  }
}

beforeEach(() => {
  waiting = [];
  mock.method(performance, 'now', () => 0); // a device that draws in no time, whatever this one does meanwhile
  globalThis.requestAnimationFrame = (callback) => waiting.push(callback);
  flight.value = {end_s: 1000} as Flight;
  seek(0);
});
afterEach(() => {
  play(false);
  mock.restoreAll();
});

test('at each speed from 0.1 to 20 the time of the flight is the time of the frames times the speed', () => {
  assert.deepEqual([SPEEDS[0], SPEEDS.at(-1)], [0.1, 20]);
  for (const factor of SPEEDS) {
    speed.value = factor;
    seek(5);
    play(true);
    frames(0); // the first one tells when it began
    // 60 Hz, 144 Hz, and a machine that was busy: 10 s together.
    const intervals = [...Array<number>(120).fill(1000 / 60), ...Array<number>(720).fill(1000 / 144), 700, 1300, 400, 600];
    assert.equal(Math.round(intervals.reduce((sum, one) => sum + one)), 10_000);
    frames(...intervals);
    assert.ok(Math.abs(time.value - (5 + 10 * factor)) < 1e-9, `${factor}x: ${time.value} s`);
    play(false);
    frames(16, 16);
    assert.ok(Math.abs(time.value - (5 + 10 * factor)) < 1e-9, 'stands still');
  }
});

test('another speed counts from the next frame on, without a jump', () => {
  speed.value = 1;
  play(true);
  frames(0, 500);
  assert.equal(time.value, 0.5);
  speed.value = 20;
  assert.equal(time.value, 0.5);
  frames(100);
  assert.ok(Math.abs(time.value - 2.5) < 1e-12);
});

test('it stops at the end, and playing again begins at the start', () => {
  speed.value = 20;
  seek(990);
  play(true);
  frames(0, 400);
  assert.equal(time.value, 998);
  frames(400, 400);
  assert.equal(time.value, 1000);
  assert.equal(playing.value, false);
  assert.equal(waiting.length, 0);
  play(true);
  assert.equal(time.value, 0);
});
