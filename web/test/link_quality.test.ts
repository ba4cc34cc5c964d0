// SPDX-License-Identifier: BSD-3-Clause
// Quality of the link in a flight whose link is cut for three seconds, and of made-up requests and answers.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {bytesSource} from '../src/data/bytes.ts';
import type {Flight} from '../src/data/flight.ts';
import {linkQualityAt, TIME_SYNC} from '../src/data/link_quality.ts';
import {readLog} from '../src/data/read_log.ts';
import {FLY, logOf} from './flights.ts';

let folder = '';
let flight: Flight;
before(async () => {
  folder = await mkdtemp(join(tmpdir(), 'rosflight_link_'));
  spawnSync(FLY, ['fly', '--fault', 'link_cut@20:3', '--out', join(folder, 'flight')]);
  flight = await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(join(folder, 'flight'))))));
});
after(() => rm(folder, {recursive: true}));

test('of a cut from 20 to 23 s: good, weak, lost while nothing has come for 2 s, weak, good', () => {
  const states = [19.9, 20.35, 21, 22.1, 22.9, 23.2, 30].map((t) => linkQualityAt(flight, t)!.state);
  assert.deepEqual(states, ['good', 'good', 'weak', 'lost', 'lost', 'weak', 'good']);
  const said = flight.events.filter(({source, text}) => source === 'companion' && text.startsWith('link'));
  assert.deepEqual(said.map(({text}) => text), ['link up', 'link lost', 'link up']);
  assert.equal(linkQualityAt(flight, said[1]!.t - 0.11)!.state, 'weak', 'until the companion says so, whose last frame was newer by less than a request');
  assert.equal(linkQualityAt(flight, said[1]!.t + 0.01)!.state, 'lost');
});

test('requests of five seconds are counted, each 0.1 s, and those of the cut have no answer', () => {
  const before = linkQualityAt(flight, 19.95)!;
  assert.deepEqual([before.requests, before.unanswered], [47, 0], '15.0 to 19.6 s');
  assert.ok(Math.abs(before.roundTrip_ms - 2.5) < 1e-6 && Math.abs(before.age_s - 0.0475) < 1e-6, 'the answer of 19.9 s, a step of 2.5 ms later');
  // 30 of the cut, from 20.0 to 22.9 s, and that of 23.0 s if its answer was the last to be cut.
  const within = linkQualityAt(flight, 24)!;
  assert.equal(within.requests, 48, '19.0 to 23.7 s');
  assert.ok(Math.abs(within.unanswered - 30) <= 1, `${within.unanswered}`);
  assert.ok(Math.abs(linkQualityAt(flight, 22.5)!.age_s - 2.6) < 0.11);
});

/** Requests at these times, each with its answer after `delay` seconds; none where that is not finite. */
function made(requests: {at: number; delay: number}[]): Flight {
  const rows = requests.flatMap(({at, delay}) => [{t: at, direction: 1, ts1: at}, {t: at + delay, direction: 0, ts1: at}])
    .filter(({t}) => Number.isFinite(t)).sort((a, b) => a.t - b.t);
  const times = rows.map(({t}) => t);
  const columns: Record<string, number[]> = {direction: rows.map(({direction}) => direction), ts1: rows.map(({ts1}) => ts1)};
  const table = {times, length: rows.length, column: (name: string) => columns[name], rowAt: (t: number) => times.findLastIndex((time) => time <= t)};
  return {tables: new Map([[TIME_SYNC, table]])} as unknown as Flight;
}

test('one lost of ten is weak, one of forty is not, and a late answer is a lost one', () => {
  const every = (k: number, delay: number) => Array.from({length: 100}, (_, n) => ({at: n / 10, delay: n % k === 0 ? delay : 0.01}));
  assert.equal(linkQualityAt(made(every(10, NaN)), 9.95)!.state, 'weak');
  assert.equal(linkQualityAt(made(every(40, NaN)), 9.95)!.state, 'good');
  const late = linkQualityAt(made(every(10, 0.5)), 9.95)!;
  assert.deepEqual([late.state, late.unanswered], ['weak', 5]);
});

test('an answer whose request was not seen counts as one, as in a running flight', () => {
  const all = made(Array.from({length: 100}, (_, n) => ({at: n / 10, delay: n >= 70 && n < 80 ? NaN : 0.01})));
  const table = all.tables.get(TIME_SYNC)!;
  const kept = [...Array(table.length).keys()].filter((row) => table.column('direction')![row] === 0 || table.times[row]! >= 7 && table.times[row]! < 7.99);
  const times = kept.map((row) => table.times[row]!);
  const some = {times, length: kept.length, rowAt: (t: number) => times.findLastIndex((time) => time <= t),
    column: (name: string) => kept.map((row) => table.column(name)![row]!)};
  const {requests, unanswered, roundTrip_ms} = linkQualityAt({tables: new Map([[TIME_SYNC, some]])} as unknown as Flight, 9.95)!;
  assert.deepEqual([requests, unanswered, roundTrip_ms], [47, 10, NaN], '5.0 to 9.6 s');
});

test('without requests nothing is said, without any answer the link is lost after two seconds', () => {
  assert.equal(linkQualityAt({tables: new Map()} as unknown as Flight, 3), undefined);
  const none = made(Array.from({length: 40}, (_, n) => ({at: n / 10, delay: NaN})));
  assert.deepEqual([1.9, 2.1].map((t) => linkQualityAt(none, t)!.state), ['weak', 'lost']);
  assert.ok(Number.isNaN(linkQualityAt(none, 1)!.roundTrip_ms));
});
