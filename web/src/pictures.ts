// SPDX-License-Identifier: BSD-3-Clause
// How often what moves is drawn: with each frame of the browser where the device can, seldomer where it cannot.

/** A frame that came later than this, 25 a second, was more than the device can draw [ms]. */
const SLOW_MS = 40;
const LONGEST_REST_MS = 500;

let drawing = false;

/** Whether the browser's frame is being made: what is drawn now is in it, what asks for a frame waits for the next. */
export const pictureIsMade = () => drawing;

/** Draws with the browser's next frame; called where a picture begins. If that one keeps the browser longer than SLOW_MS, an equal rest comes
 * before the next: a slow device that does nothing but draw answers no finger and no key. */
export function nextPicture(draw: FrameRequestCallback) {
  const picture = (now_ms: number) => {
    drawing = true;
    try {
      draw(now_ms);
    } finally {
      drawing = false;
    }
  };
  const asked_ms = performance.now();
  requestAnimationFrame((now_ms) => {
    const took_ms = performance.now() - asked_ms;
    if (took_ms <= SLOW_MS) picture(now_ms);
    else setTimeout(() => requestAnimationFrame(picture), Math.min(took_ms, LONGEST_REST_MS));
  });
}
