// SPDX-License-Identifier: BSD-3-Clause
// Keys of a vehicle file, as the pages of docs that are made from the tables of parameters have them (config/table.hpp), and their
// values in a flight.
import {lastAtOrBefore} from './table.ts';
import type {Flight} from './flight.ts';

export interface SettingInfo { key: string; standard: string; unit: string; allowed: string; meaning: string }
const KINDS = ['multirotor', 'fixed wing', 'quad-plane'] as const;
export type Kind = (typeof KINDS)[number];

/** A quad-plane has the sections of a wing too, but guidance of its own. */
function belongs(heading: string, kind: Kind): boolean {
  const named = KINDS.filter((each) => heading.toLowerCase().includes(each));
  return named.length === 0 || named.includes(kind) || (kind === 'quad-plane' && heading.endsWith('` of a fixed wing'));
}

/** Of docs/autonomy-keys.md or docs/vehicle-keys.md, for one kind of vehicle. A key of the entries of a list has `[]` in it. */
export function parseKeyPage(page: string, kind: Kind): SettingInfo[] {
  const out: SettingInfo[] = [];
  let section = '';
  let part = '';
  let named = '';
  let skipped = false;
  for (const line of page.split('\n')) {
    const heading = /^## (.*)/.exec(line)?.[1];
    if (heading) {
      section = /`(.+?)`/.exec(heading)?.[1] ?? 'autonomy';
      skipped = !belongs(heading, kind);
      named = '';
    }
    named = /^\*\*(.+)\*\*$/.exec(line)?.[1] ?? named;
    if (line.startsWith('| key |')) [part, named] = [named, ''];
    const cells = /^\| `(.+?)` \| (.*) \|$/.exec(line);
    if (skipped || !cells) continue;
    const [standard, unit, allowed, meaning] = cells[2]!.split(' | ').map((cell) => cell.trim());
    const key = [section, part, cells[1]!].filter(Boolean).join('.');
    if (allowed && !allowed.endsWith('entries')) out.push({key, standard: standard!, unit: unit!, allowed, meaning: meaning!});
  }
  return out;
}

/** Values by path, of the block-style YAML that the simulator writes. Lists of numbers stand in brackets; entries of a list of maps have
 * their number in the path, as `--set` has it: `rotors.layout.0.spin`. */
export function parseSettings(yaml: string): Map<string, string> {
  const values = new Map<string, string>();
  const path: string[] = [];
  for (const line of yaml.split('\n')) {
    const [, indent, text] = /^( *)(.*)$/.exec(line)!;
    if (!text) continue;
    const depth = indent!.length / 2;
    const before = path[depth];
    path.length = depth;
    if (text === '-') {
      path.push(String(/^\d+$/.test(before ?? '') ? Number(before) + 1 : 0));
    } else if (text.startsWith('- ')) {
      const list = path.join('.');
      values.set(list, values.has(list) ? values.get(list)!.replace(/\]$/, `, ${text.slice(2)}]`) : `[${text.slice(2)}]`);
    } else {
      const colon = text.indexOf(':');
      path.push(text.slice(0, colon));
      const value = text.slice(colon + 1).trim();
      if (value) values.set(path.join('.'), value);
    }
  }
  return values;
}

/** Paths of the entries that a list of maps has: `rotors.layout.0` and so on. */
export function entriesOf(values: ReadonlyMap<string, string>, list: string): string[] {
  const first = `${list}.`;
  return [...new Set([...values.keys()].filter((key) => key.startsWith(first)).map((key) => first + parseInt(key.slice(first.length))))];
}

/** Each key of the entries of a list once for each entry, entry by entry; a part that an entry does not have is left out. */
export function perEntry(infos: SettingInfo[], values: ReadonlyMap<string, string>): SettingInfo[] {
  const given = [...values.keys()];
  const hasPart = ({key}: SettingInfo) => given.some((one) => one.startsWith(key.slice(0, key.lastIndexOf('.') + 1)));
  return infos.flatMap((info, k) => {
    const [list, rest] = info.key.split('[]');
    if (rest === undefined) return [info];
    if (infos[k - 1]?.key.startsWith(`${list}[]`)) return []; // with the first of the list
    const keys = infos.filter(({key}) => key.startsWith(`${list}[]`));
    return entriesOf(values, list!).flatMap((entry) => keys.map((one) => ({...one, key: one.key.replace(`${list}[]`, entry)})).filter(hasPart));
  });
}

/** The vehicle file in force at `t`; empty where the log has none. */
export function settingsAt(flight: Flight, t: number): string {
  const {settings} = flight;
  const times = settings.map((one) => one.t);
  return settings[Math.max(lastAtOrBefore(times, times.length, t), 0)]?.text ?? '';
}
