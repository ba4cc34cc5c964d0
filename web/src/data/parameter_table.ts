// SPDX-License-Identifier: BSD-3-Clause
// What the firmware's table (firmware/core/parameters.csv) says about its parameters.

export interface ParameterInfo {
  name: string; isFloat: boolean; standard: number; min: number; max: number;
  /** One value outside the range that is allowed too. */
  sentinel: number | undefined;
  unit: string; description: string;
}

/** @param csv  quoted cells hold commas; no cell holds a line break. */
export function parseParameterTable(csv: string): Map<string, ParameterInfo> {
  const [head, ...lines] = csv.trim().split('\n').map(cells);
  return new Map(lines.map((line) => {
    const of = (column: string) => line[head!.indexOf(column)] ?? '';
    const number = (column: string) => Number(of(column).replace('inf', 'Infinity'));
    const name = of('name');
    return [name, {name, isFloat: of('type') === 'float', standard: number('default'), min: number('min'), max: number('max'),
      sentinel: of('sentinel') === '' ? undefined : number('sentinel'), unit: of('units'), description: of('description')}];
  }));
}

function cells(line: string): string[] {
  return [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(([, quoted, plain]) => quoted?.replaceAll('""', '"') ?? plain!.trim());
}

/** What precedes the first underscore, where others share it. */
export function groupsOf(names: string[]): string[] {
  const FEWEST = 3;
  const counts = new Map<string, number>();
  for (const name of names) counts.set(groupOf(name), (counts.get(groupOf(name)) ?? 0) + 1);
  return [...counts].filter(([, count]) => count >= FEWEST).map(([group]) => group).sort();
}

export const groupOf = (name: string) => name.split('_')[0]!;

/** "0 .. 1" or "-1, 4 .. 7"; empty where everything is allowed. */
export function allowedText({min, max, sentinel, standard}: ParameterInfo): string {
  if (min === -Infinity && max === Infinity) return '';
  const apart = sentinel ?? standard;
  return `${apart < min || apart > max ? `${apart}, ` : ''}${min} .. ${max}`;
}

/** Why a text is no value that the firmware takes; empty if it is one. */
export function complaint(text: string, info: ParameterInfo | undefined): string {
  const value = Number(text);
  if (text.trim() === '' || !Number.isFinite(value)) return 'no number';
  if (!info) return '';
  if (!info.isFloat && !Number.isInteger(value)) return 'no whole number';
  const allowed = value >= info.min && value <= info.max || value === (info.sentinel ?? info.standard);
  return allowed ? '' : `allowed: ${allowedText(info)}`;
}

/** Equal as the link carries them: an integer, or a number of 32 bits. */
export const sameValue = (a: number, b: number) => a === b || Math.fround(a) === Math.fround(b) && !(Number.isInteger(a) && Number.isInteger(b));
export const shortNumber = (value: number) => String(Number.isInteger(value) ? value : +value.toPrecision(7));
