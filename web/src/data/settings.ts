// SPDX-License-Identifier: BSD-3-Clause
// Keys of a vehicle file, as the pages of docs that are made from the tables of parameters have them (config/table.hpp), and their
// values in a flight.
import {lastAtOrBefore} from './table.ts';
import type {Flight} from './flight.ts';

export interface SettingInfo { key: string; standard: string; unit: string; allowed: string; meaning: string }
type Kind = 'multirotor' | 'fixed wing';

/** Of docs/autonomy-keys.md or docs/vehicle-keys.md, for one kind of vehicle. Entries of lists are no single keys. */
export function parseKeyPage(page: string, kind: Kind): SettingInfo[] {
  const other: Kind = kind === 'multirotor' ? 'fixed wing' : 'multirotor';
  const out: SettingInfo[] = [];
  let section = '';
  let part = '';
  let named = '';
  let skipped = false;
  for (const line of page.split('\n')) {
    const heading = /^## (.*)/.exec(line)?.[1];
    if (heading) {
      section = /`(.+?)`/.exec(heading)?.[1] ?? 'autonomy';
      skipped = heading.toLowerCase().includes(other);
      named = '';
    }
    named = /^\*\*(.+)\*\*$/.exec(line)?.[1] ?? named;
    if (line.startsWith('| key |')) [part, named] = [named, ''];
    const cells = /^\| `(.+?)` \| (.*) \|$/.exec(line);
    if (skipped || !cells) continue;
    const [standard, unit, allowed, meaning] = cells[2]!.split(' | ').map((cell) => cell.trim());
    const key = [section, part, cells[1]!].filter(Boolean).join('.');
    if (allowed && !key.includes('[]') && !allowed.endsWith('entries')) out.push({key, standard: standard!, unit: unit!, allowed, meaning: meaning!});
  }
  return out;
}

/** Values by path, of the block-style YAML that the simulator writes. Lists of maps are left out, other lists stand in brackets. */
export function parseSettings(yaml: string): Map<string, string> {
  const values = new Map<string, string>();
  const path: string[] = [];
  let list = '';
  let mapsBelow = Infinity; // indentation of the entries of a list of maps
  for (const line of yaml.split('\n')) {
    const [, indent, text] = /^( *)(.*)$/.exec(line)!;
    const depth = indent!.length / 2;
    if (!text || depth > mapsBelow) continue;
    if (text.startsWith('-')) {
      if (text === '-') mapsBelow = depth;
      else values.set(list, values.has(list) ? values.get(list)!.replace(/\]$/, `, ${text.slice(2)}]`) : `[${text.slice(2)}]`);
      continue;
    }
    mapsBelow = Infinity;
    const colon = text.indexOf(':');
    path.length = depth;
    path.push(text.slice(0, colon));
    list = path.join('.');
    const value = text.slice(colon + 1).trim();
    if (value) values.set(list, value);
  }
  return values;
}

/** The entries of a list of maps in the same YAML, by the keys that lead to it; none if there is no such list. */
export function parseMaps(yaml: string, ...keys: string[]): Map<string, string>[] {
  let block = yaml;
  for (const [depth, key] of keys.entries()) {
    const indent = '  '.repeat(depth);
    block = new RegExp(`^${indent}${key}:\\n((?:${indent} .*\\n)*)`, 'm').exec(block)?.[1] ?? '';
  }
  return block.split(/^ *-$/m).slice(1).map((entry) => new Map([...entry.matchAll(/^ *(\w+): (.*)$/gm)].map(([, key, value]) => [key!, value!])));
}

/** The vehicle file in force at `t`; empty where the log has none. */
export function settingsAt(flight: Flight, t: number): string {
  const {settings} = flight;
  const times = settings.map((one) => one.t);
  return settings[Math.max(lastAtOrBefore(times, times.length, t), 0)]?.text ?? '';
}
