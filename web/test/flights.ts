// SPDX-License-Identifier: BSD-3-Clause
// Flights and programs that tools/web_test.py has made ready for the tests.
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';

function named(name: string): string {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set: ./rosflight test web runs these tests`);
  return value;
}

/** Flight folder of the default flight. */
export const MULTIROTOR = named('ROSFLIGHT_WEB_MULTIROTOR');
/** Flight folder of a fixed wing. */
export const FIXED_WING = named('ROSFLIGHT_WEB_FIXED_WING');
/** Folder with the page as it was built. */
export const PAGE = named('ROSFLIGHT_WEB_PAGE');
/** Program behind ./rosflight view. */
export const VIEW = named('ROSFLIGHT_WEB_VIEW');
/** Program behind ./rosflight fly. */
export const FLY = named('ROSFLIGHT_WEB_FLY');
/** Program behind ./rosflight sil. */
export const SIL = named('ROSFLIGHT_WEB_SIL');

/** Python with pymavlink. */
export const PYTHON = named('ROSFLIGHT_WEB_PYTHON');

export const logOf = (folder: string) => join(folder, 'flight.mcap');

export async function summaryOf(folder: string): Promise<Record<string, unknown>> {
  return JSON.parse(await readFile(join(folder, 'summary.json'), 'utf8')) as Record<string, unknown>;
}

/** How many the firmware has: a line each, and the head. */
export const PARAMETERS = (await readFile(new URL('../../firmware/core/parameters.csv', import.meta.url), 'utf8')).trim().split('\n').length - 1;
