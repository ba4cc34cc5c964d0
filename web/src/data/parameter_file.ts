// SPDX-License-Identifier: BSD-3-Clause
// Parameter files as ROSflight 2.x and ./rosflight params write them: a line `- {name: RC_F_CHN, type: 6, value: 4}` each.
import {sameValue} from './parameter_table.ts';

export interface ParameterValue { name: string; value: number; isFloat: boolean }

const TYPES = {int32: 6, float: 9};

/** @throws Error  with the line that is none of a parameter file. */
export function parseParameterFile(text: string): ParameterValue[] {
  const values = new Map<string, ParameterValue>();
  for (const [k, raw] of text.split('\n').entries()) {
    const line = raw.replace(/#.*/, '').trim();
    if (line === '' || line === '---' || line === '[]') continue;
    const found = /^- *\{(.*)\}$/.exec(line);
    const keys = new Map(found?.[1]!.split(',').map((pair) => pair.split(':').map((part) => part.trim()) as [string, string]));
    const name = keys.get('name') ?? '';
    const type = Number(keys.get('type'));
    const value = Number(keys.get('value') || NaN);
    const whole = type !== TYPES.int32 || Number.isInteger(value);
    if (keys.size !== 3 || !/^\w{1,16}$/.test(name) || !Object.values(TYPES).includes(type) || !Number.isFinite(value) || !whole) {
      throw new Error(`line ${k + 1}: found ${raw.trim().slice(0, 80)}, allowed is {name: NAME, type: 6 or 9, value: NUMBER}`);
    }
    if (values.has(name)) throw new Error(`line ${k + 1}: ${name} stands there twice`);
    values.set(name, {name, value, isFloat: type === TYPES.float});
  }
  return [...values.values()];
}

export function formatParameterFile(values: readonly ParameterValue[]): string {
  const text = ({value, isFloat}: ParameterValue) => isFloat ? floatText(value) : String(value);
  return [...values].sort((a, b) => a.name < b.name ? -1 : 1)
    .map((one) => `- {name: ${one.name}, type: ${one.isFloat ? TYPES.float : TYPES.int32}, value: ${text(one)}}\n`).join('');
}

/** The shortest text that reads back as the same number of 32 bits. */
function floatText(value: number): string {
  const wanted = Math.fround(value);
  const DIGITS = 9; // enough for any
  let text = String(wanted);
  for (let digits = 1; digits <= DIGITS; ++digits) {
    const shorter = String(Number(wanted.toPrecision(digits)));
    if (Math.fround(Number(shorter)) === wanted) {
      text = shorter;
      break;
    }
  }
  return Number.isInteger(Number(text)) && !text.includes('e') ? `${text}.0` : text;
}

export interface Difference { name: string; here: number | undefined; there: number }

/** What a file has otherwise than the vehicle; `here` is undefined where the vehicle has no such parameter. */
export function differences(values: ReadonlyMap<string, number>, file: readonly ParameterValue[]): Difference[] {
  return file.map(({name, value}) => ({name, here: values.get(name), there: value}))
    .filter(({here, there}) => here === undefined || !sameValue(here, there));
}

/** Of one file against another, also what only one of them has; `there` is NaN where the other has no such parameter. */
export function twoFiles(one: readonly ParameterValue[], other: readonly ParameterValue[]): Difference[] {
  const here = new Map(one.map(({name, value}) => [name, value]));
  const there = new Set(other.map(({name}) => name));
  return [...differences(here, other), ...one.filter(({name}) => !there.has(name)).map(({name, value}) => ({name, here: value, there: NaN}))];
}
