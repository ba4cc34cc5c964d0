// SPDX-License-Identifier: BSD-3-Clause
// How often what moves is drawn: with each frame of the browser where the device can, seldomer where it cannot.

/** A frame that came later than this, 25 a second, was more than the device can draw [ms]. */
const SLOW_MS = 40;
const LONGEST_REST_MS = 500;

/** Draws with the browser's next frame; called where a picture begins. If that one keeps the browser longer than SLOW_MS, an equal rest comes
 * before the next: a slow device that does nothing but draw answers no finger and no key. */
export function nextPicture(draw: FrameRequestCallback) {
  const asked_ms = performance.now();
  requestAnimationFrame((now_ms) => {
    const took_ms = performance.now() - asked_ms;
    if (took_ms <= SLOW_MS) draw(now_ms);
    else setTimeout(() => requestAnimationFrame(draw), Math.min(took_ms, LONGEST_REST_MS));
  });
}
