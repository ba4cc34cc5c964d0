// SPDX-License-Identifier: BSD-3-Clause
// The reader of logs against the official one, npm @mcap/core, and against what the flight said of itself.
import {McapIndexedReader} from '@mcap/core';
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {createServer} from 'node:http';
import type {AddressInfo} from 'node:net';
import {test} from 'node:test';
import {zstdDecompressSync} from 'node:zlib';
import {bytesSource, urlSource} from '../src/data/bytes.ts';
import {lanesOf} from '../src/data/lanes.ts';
import {McapLog} from '../src/data/mcap.ts';
import {recordsOf} from '../src/data/mcap_records.ts';
import {readLog} from '../src/data/read_log.ts';
import {FIXED_WING, logOf, MULTIROTOR, summaryOf} from './flights.ts';
import {random} from './random.ts';

const bytes = new Uint8Array(await readFile(logOf(MULTIROTOR)));

/** Messages and a sum over their bytes for each topic. */
type Contents = Record<string, [count: number, size: number, sum: number]>;

function count(contents: Contents, topic: string, data: Uint8Array) {
  const entry = contents[topic] ??= [0, 0, 0];
  entry[0] += 1;
  entry[1] += data.length;
  for (const byte of data) entry[2] = (entry[2] * 31 + byte) % 1000003;
}

test('the messages of a log are those that the official reader finds', async () => {
  const theirs: Contents = {};
  const reader = await McapIndexedReader.Initialize({
    readable: {size: async () => BigInt(bytes.length), read: async (at, size) => bytes.subarray(Number(at), Number(at + size))},
    decompressHandlers: {zstd: (packed) => zstdDecompressSync(packed)},
  });
  for await (const {channelId, data} of reader.readMessages()) count(theirs, reader.channelsById.get(channelId)!.topic, data);
  const ours: Contents = {};
  const log = await McapLog.open(bytesSource('log', bytes));
  await log.readMessages(({topic}, _, data) => count(ours, topic, data));
  assert.deepEqual(ours, theirs);
  assert.equal(Object.values(ours).reduce((sum, [messages]) => sum + messages, 0), (await summaryOf(MULTIROTOR))['log_messages']);
  assert.deepEqual(log.attachments.map(({name}) => name), ['vehicle.yaml', 'mission.yaml']);
});

test('a flight ends where its waypoint list and its clock say', async () => {
  const flight = await readLog(bytesSource('log', bytes));
  const summary = await summaryOf(MULTIROTOR);
  assert.ok(Math.abs(flight.end_s - (summary['sim_time_s'] as number)) < 0.1, `${flight.end_s} s`);
  // At each waypoint's moment the vehicle is as far from it in truth as the summary says.
  const waypoints = summary['waypoints'] as {truth_distance_m: number; estimate_distance_m: number; time_s: number}[];
  for (const [k, {truth_distance_m, time_s}] of waypoints.entries()) {
    const {p} = flight.poseAt(time_s)!;
    const distance = Math.hypot(...p.map((value, axis) => value - flight.plans[0]!.points[k]![axis]!));
    assert.ok(Math.abs(distance - truth_distance_m) < 0.05, `waypoint ${k + 1}: ${distance} instead of ${truth_distance_m} m`);
  }
  assert.equal(flight.facts.get('vehicle'), 'multirotor');
  assert.ok(!flight.fixedWing);
  assert.ok(flight.urdf.includes('rotor_0'));
  assert.ok(flight.events.length > 10);
  assert.deepEqual(flight.notes, []);
});

test('states are strips without holes and in order', async () => {
  const flight = await readLog(bytesSource('log', bytes));
  const lanes = lanesOf(flight);
  assert.deepEqual(lanes.map(({name}) => name), ['firmware', 'errors', 'control', 'autonomy']);
  assert.deepEqual(lanes[0]!.spans.map(({label}) => label), ['disarmed', 'armed', 'disarmed']);
  for (const {spans} of lanes) for (const {from, to} of spans) assert.ok(from < to);
});

test('a fixed wing has its plan, its wind and its airspeed', async () => {
  const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(FIXED_WING)))));
  assert.ok(flight.fixedWing);
  assert.ok(flight.plans.reduce((sum, {points}) => sum + points.length, 0) > 20);
  assert.ok(flight.tables.get('/airspeed')!.length > 100);
  assert.ok(flight.urdf.includes('"wing"'));
});

test('a log without its end is read as far as it goes, and says so', async () => {
  const half = bytes.subarray(0, Math.floor(bytes.length / 2));
  const flight = await readLog(bytesSource('half', half));
  assert.ok(flight.end_s > 10 && flight.end_s < 45, `${flight.end_s} s`);
  assert.match(flight.notes[0]!, /^The log has no end: it was read as far as it goes, \d+\.\d s\.$/);
});

test('the room for messages is what the file says of them, and no more than it can hold', async () => {
  const flight = await readLog(bytesSource('log', bytes));
  for (const [topic, table] of flight.tables) assert.equal(table.times.length, Math.max(table.length, 64), topic);
  const lie = bytes.slice();
  const view = new DataView(lie.buffer);
  const FOOTER = lie.length - 8 - 20; // address of the summary first
  const summary = lie.subarray(Number(view.getBigUint64(FOOTER, true)), FOOTER - 9);
  const {body} = recordsOf(summary).find(({op}) => op === 11)!;
  const FIRST_COUNT = 42 + 4 + 2; // behind the numbers of records and the times, the length of the list and the number of the channel
  new DataView(body.buffer, body.byteOffset).setBigUint64(FIRST_COUNT, 2n ** 51n, true);
  const lying = await readLog(bytesSource('lying', lie));
  assert.equal(lying.end_s, flight.end_s);
  for (const table of lying.tables.values()) assert.ok(table.times.length <= bytes.length / 16);
});

test('a damaged chunk ends reading with a note', async () => {
  const damaged = bytes.slice();
  damaged.fill(0xaa, 2_000_000, 2_200_000);
  const flight = await readLog(bytesSource('damaged', damaged));
  assert.match(flight.notes[0]!, /^The log is damaged after \d+\.\d s: /);
});

test('the index is read first: before the first message hardly anything but the end of the file', async () => {
  const read: [start: number, length: number][] = [];
  const whole = bytesSource('log', bytes);
  const log = await McapLog.open({...whole, read: (start, length) => {
    read.push([start, length]);
    return whole.read(start, length);
  }});
  const amount = read.reduce((sum, [, length]) => sum + length, 0);
  assert.ok(amount < bytes.length / 20, `${amount} of ${bytes.length} bytes`);
  // The start names the format, the end says where the index is: what follows are the index and what it leads to.
  assert.deepEqual(read[0], [0, 8]);
  assert.equal(read[1]![0] + read[1]![1], bytes.length);
  assert.ok(read[2]![0] > bytes.length / 2 && read[2]![0] + read[2]![1] === read[1]![0]);
  assert.ok(log.complete);
  const reader = await McapIndexedReader.Initialize({
    readable: {size: async () => BigInt(bytes.length), read: async (at, size) => bytes.subarray(Number(at), Number(at + size))},
  });
  assert.deepEqual([...log.channels.keys()].sort(), [...reader.channelsById.keys()].sort());
  // No chunk, which has the messages, was touched.
  for (const {chunkStartOffset, chunkLength} of reader.chunkIndexes) {
    const [from, to] = [Number(chunkStartOffset), Number(chunkStartOffset + chunkLength)];
    for (const [start, length] of read) assert.ok(start + length <= from || start >= to, `${start} + ${length} in the chunk at ${from}`);
  }
});

test('a server that shortens a range is asked for the rest; one that sends nothing more ends it', async (t) => {
  let longest = 100_000;
  const server = createServer((request, response) => {
    const [, first, last] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range!)!.map(Number) as [number, number, number];
    const part = bytes.subarray(first, Math.min(first + longest, last + 1));
    response.writeHead(206, {'Content-Range': `bytes ${first}-${first + part.length - 1}/${bytes.length}`}).end(part);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  t.after(() => {
    server.closeAllConnections();
    server.close();
  });
  const log = await urlSource(`http://127.0.0.1:${(server.address() as AddressInfo).port}/`, 'log');
  assert.equal(log.size, bytes.length);
  assert.deepEqual(Buffer.from(await log.read(12_345, 234_567)), Buffer.from(bytes.subarray(12_345, 12_345 + 234_567)));
  assert.deepEqual((await readLog(log)).events, (await readLog(bytesSource('log', bytes))).events);
  longest = 0;
  await assert.rejects(log.read(0, 10), /^Error: log: ends 10 bytes too early$/);
});

test('what is no log is refused with one line', async () => {
  for (const other of [new Uint8Array(), new TextEncoder().encode('{"this": "is JSON"}'), new Uint8Array(5000)]) {
    await assert.rejects(readLog(bytesSource('other', other)), /^Error: other: is no MCAP file$/);
  }
  await assert.rejects(readLog(bytesSource('head', bytes.subarray(0, 100))), /has no ROS 2 message/);
});

test('whatever is wrong with the bytes, reading ends with a flight or an error', async () => {
  const next = random(7);
  const small = bytes.slice(0, 300_000);
  for (let run = 0; run < 60; ++run) {
    const broken = small.slice(0, next() % 2 ? undefined : next() % small.length);
    for (let k = 0; k < 20; ++k) broken[8 + next() % 2000] = next() % 256;
    for (let k = 0; k < 20; ++k) broken[next() % broken.length] = next() % 256;
    await readLog(bytesSource('broken', broken)).catch((error: unknown) => assert.ok(error instanceof Error));
  }
});
