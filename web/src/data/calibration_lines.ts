// SPDX-License-Identifier: BSD-3-Clause
// Lines of a calibration that a person does, so far; viewer/viewer_commands.cpp has the texts.
import type {Flight} from './flight.ts';

/** Of the newest one, in their order. */
export function calibrationLines(flight: Flight): string[] {
  const lines: string[] = [];
  for (const {source, text} of flight.events) {
    if (source !== 'viewer') continue;
    if (/^viewer \d+ calibrates (?!stop)/.test(text)) lines.length = 0;
    const found = /^viewer \d+ calibration: (.*)$/.exec(text);
    if (found) lines.push(found[1]!);
  }
  return lines;
}
