// SPDX-License-Identifier: BSD-3-Clause
// How often is drawn, on devices that a test makes up.
import assert from 'node:assert/strict';
import {mock, test} from 'node:test';
import {nextPicture} from '../src/pictures.ts';

const FRAME_MS = 1000 / 60;

/** Draws for ten seconds on a device that needs so long for a picture [ms]; returns the pictures, and the share of the time left for the rest. */
function drawing(picture_ms: number): {pictures: number; free: number} {
  let now_ms = 0;
  let free_ms = 0;
  let pictures = 0;
  const timers: {at_ms: number; call: () => void}[] = [];
  let frame: FrameRequestCallback | undefined;
  const clock = mock.method(performance, 'now', () => now_ms);
  globalThis.requestAnimationFrame = (callback) => { frame = callback; return 0; };
  const timer = mock.method(globalThis, 'setTimeout', (call: () => void, ms: number) => timers.push({at_ms: now_ms + ms, call}));
  const draw = () => {
    ++pictures;
    nextPicture(draw);
    now_ms += picture_ms;
  };
  nextPicture(draw);
  while (now_ms < 10_000) {
    const frame_ms = Math.ceil(now_ms / FRAME_MS + 1e-9) * FRAME_MS;
    const next = frame ? {at_ms: frame_ms, call: frame} : timers.shift()!;
    frame = undefined;
    free_ms += Math.max(next.at_ms - now_ms, 0);
    now_ms = Math.max(now_ms, next.at_ms);
    next.call(now_ms);
  }
  clock.mock.restore();
  timer.mock.restore();
  return {pictures, free: free_ms / now_ms};
}

test('a device that keeps up draws each frame', () => {
  assert.ok(Math.abs(drawing(8).pictures - 600) <= 1);
  assert.ok(Math.abs(drawing(30).pictures - 300) <= 1); // each second one
});

test('a slow device has half of its time for fingers and keys', () => {
  for (const picture_ms of [50, 100, 400]) {
    const {pictures, free} = drawing(picture_ms);
    assert.ok(free >= 0.5, `${picture_ms} ms: ${free}`);
    assert.ok(pictures >= 10_000 / (2 * picture_ms + 3 * FRAME_MS), `${picture_ms} ms: ${pictures}`); // three: each wait ends with a frame
  }
});

test('a rest is half a second at most, also after a frame that the browser held back while the page was hidden', () => {
  const {pictures} = drawing(3000);
  assert.equal(pictures, 3);
});
