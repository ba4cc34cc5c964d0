// SPDX-License-Identifier: BSD-3-Clause
// ./rosflight view and fly --view as they are typed: a port that is taken, a log file in place of a folder, logs of other programs, the
// pace of a flight.
import {McapWriter} from '@mcap/core';
import assert from 'node:assert/strict';
import {spawnSync, type ChildProcess} from 'node:child_process';
import {existsSync} from 'node:fs';
import {copyFile, mkdtemp, rm, writeFile} from 'node:fs/promises';
import {createServer, type AddressInfo} from 'node:net';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import type {Browser} from 'playwright-core';
import {drawn, goTo, newPage, onPage, startBrowser, vehicleIsSeen} from './browser.ts';
import {logOf, MULTIROTOR, VIEW} from './flights.ts';
import {flyWatched, view, viewer} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_command_line_'));
const started: ChildProcess[] = [];
let browser: Browser;

before(async () => { browser = await startBrowser(); });
after(async () => {
  for (const program of started) program.kill('SIGKILL');
  await browser?.close();
  await rm(scratch, {recursive: true});
});

test('a port that is taken ends the program with one line, which says what to do, and exit code 2', async () => {
  const other = createServer().listen(0, '127.0.0.1');
  await new Promise((resolve) => other.once('listening', resolve));
  const {port} = other.address() as AddressInfo;
  const folder = join(scratch, 'never');
  for (const words of [['view', MULTIROTOR], ['view', logOf(MULTIROTOR)], ['fly', '--view', '--out', folder]]) {
    const {status, stdout, stderr} = spawnSync(VIEW, [...words, '--port', String(port)], {encoding: 'utf8', timeout: 60_000});
    assert.equal(stderr, `rosflight: --port: found ${port}, Address already in use; allowed a free port, or 0 for any\n`, words[0]);
    assert.deepEqual([status, stdout], [2, ''], words[0]);
  }
  assert.equal(existsSync(folder), false);
  other.close();
});

test('an origin that is none is refused the same way', () => {
  const {status, stdout, stderr} = spawnSync(VIEW, ['view', MULTIROTOR, '--allow-origin', 'https://example.org/'], {encoding: 'utf8', timeout: 60_000});
  assert.deepEqual([status, stdout, stderr.split('\n').length], [2, '', 2]);
  assert.match(stderr, /^rosflight: --allow-origin: found https:\/\/example.org\/, allowed SCHEME:\/\/HOST\[:PORT\]/);
});

test('a log file is shown by itself, without what its folder holds beside it', async () => {
  const file = join(scratch, 'renamed.mcap');
  await copyFile(logOf(MULTIROTOR), file);
  const url = await view(started, file);
  const offer = await (await fetch(`${url}offer.json`)).json() as Record<string, unknown>;
  assert.deepEqual(offer, {log: 'flight/flight.mcap', name: file});
  await onPage(browser, url, async (page) => {
    assert.equal(await page.locator('h1').innerText(), 'multirotor flies default');
    await goTo(page, 20);
    await vehicleIsSeen(page);
    assert.equal(await page.locator('.badge', {hasText: /success|failed/}).count(), 0, 'the verdict is in summary.json');
  });
});

/** What a topic of another program has: its type, its definition, and messages each second as bytes of CDR. */
interface Topic { name: string; type: string; definition: string; encoding?: string; messages: Uint8Array[] }

async function writeLog(file: string, topics: Topic[]) {
  const parts: Uint8Array[] = [];
  let size = 0;
  const writer = new McapWriter({writable: {
    write: async (bytes) => { parts.push(bytes.slice()); size += bytes.length; },
    position: () => BigInt(size),
  }});
  await writer.start({profile: 'ros2', library: 'another program'});
  for (const {name, type, definition, encoding = 'cdr', messages} of topics) {
    const schemaId = await writer.registerSchema({name: type, encoding: encoding === 'cdr' ? 'ros2msg' : 'jsonschema', data: new TextEncoder().encode(definition)});
    const channelId = await writer.registerChannel({schemaId, topic: name, messageEncoding: encoding, metadata: new Map()});
    for (const [k, data] of messages.entries()) {
      const logTime = 1_700_000_000_000_000_000n + BigInt(k) * 1_000_000_000n;
      await writer.addMessage({channelId, sequence: k, logTime, publishTime: logTime, data});
    }
  }
  await writer.end();
  await writeFile(file, Buffer.concat(parts));
}

/** Little-endian CDR: each value at a multiple of its size behind the four bytes of the head. */
function cdr(...values: (['f64' | 'u32' | 'u8', number] | string)[]): Uint8Array {
  const bytes: number[] = [];
  const put = (size: number, set: (view: DataView) => void) => {
    while (bytes.length % size) bytes.push(0);
    const view = new DataView(new ArrayBuffer(size));
    set(view);
    bytes.push(...new Uint8Array(view.buffer));
  };
  for (const value of values) {
    if (typeof value === 'string') {
      const text = [...new TextEncoder().encode(value), 0];
      put(4, (view) => view.setUint32(0, text.length, true));
      bytes.push(...text);
    } else if (value[0] === 'f64') put(8, (view) => view.setFloat64(0, value[1], true));
    else if (value[0] === 'u32') put(4, (view) => view.setUint32(0, value[1], true));
    else bytes.push(value[1]);
  }
  return Uint8Array.from([0, 1, 0, 0, ...bytes]);
}

const seconds = Array.from({length: 11}, (_, k) => k);
const BAR = '='.repeat(80);
const TIME = `${BAR}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n`;
const json = {name: '/battery', type: 'Battery', definition: '{"type":"object"}', encoding: 'json', messages: seconds.map(() => new TextEncoder().encode('{"volt":12}'))};
/** As ros2 bag record -s mcap leaves them. */
const bag: Topic[] = [
  {name: '/temperature', type: 'std_msgs/msg/Float64', definition: 'float64 data\n', messages: seconds.map((t) => cdr(['f64', 20 + t]))},
  {name: '/robot/pose', type: 'geometry_msgs/msg/PoseStamped',
    definition: `std_msgs/Header header\nPose pose\n${BAR}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n${TIME}${BAR}\nMSG: geometry_msgs/Pose\n`
      + `Point position\nQuaternion orientation\n${BAR}\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n${BAR}\nMSG: geometry_msgs/Quaternion\n`
      + 'float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n',
    messages: seconds.map((t) => cdr(['u32', t], ['u32', 0], 'map', ['f64', t], ['f64', 0], ['f64', 0], ['f64', 0], ['f64', 0], ['f64', 0], ['f64', 1]))},
  {name: '/rosout', type: 'rcl_interfaces/msg/Log',
    definition: `byte DEBUG=10\nbyte INFO=20\nbuiltin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line\n${TIME}`,
    messages: seconds.slice(0, 2).map((t) => cdr(['u32', t], ['u32', 0], ['u8', 20], 'driver', `second ${t}`, 'driver.cpp', 'main', ['u32', 7]))},
  {name: '/robot_description', type: 'std_msgs/msg/String', definition: 'string data\n',
    messages: [cdr('<robot name="r"><link name="base"><visual><geometry><mesh filename="package://r/base.dae"/></geometry></visual></link></robot>')]},
  // Names that the project uses too, with other types.
  {name: '/attitude', type: 'geometry_msgs/msg/Vector3', definition: 'float64 x\nfloat64 y\nfloat64 z\n', messages: seconds.map(() => cdr(['f64', 1], ['f64', 2], ['f64', 3]))},
  {name: '/status', type: 'std_msgs/msg/String', definition: 'string data\n', messages: seconds.map(() => cdr('good'))},
  json,
];

test('a log of another program is opened as far as its types are those of ROS 2', async () => {
  const file = join(scratch, 'bag.mcap');
  await writeLog(file, bag);
  await onPage(browser, await view(started, file), async (page) => {
    assert.equal(await page.locator('h1').innerText(), file);
    await page.getByText('Not read, in another encoding: /battery.').waitFor();
    await goTo(page, 5);
    for (const tab of await page.getByRole('tab').all()) {
      await tab.click();
      await drawn(page);
    }
    await page.getByRole('tab', {name: 'Events'}).click();
    await page.getByText('second 1').first().waitFor();
    await page.getByRole('tab', {name: 'Plots'}).click();
    for (const field of ['/temperature data', '/robot/pose pose.position.x']) {
      await page.getByLabel('Add a plot of any field').fill(field);
      await page.waitForSelector(`figure:has-text("${field}") canvas`);
    }
  });
});

test('a log without a message of ROS 2 is refused with one line', async () => {
  const file = join(scratch, 'json.mcap');
  await writeLog(file, [json]);
  const {page, complaints} = await newPage(browser);
  await page.goto(await view(started, file));
  assert.equal(await page.getByRole('alert').innerText(), `${file}: has no ROS 2 message (cdr, ros2msg)`);
  assert.deepEqual(complaints, []);
  await page.context().close();
});

// A busy machine makes a flight slower, never faster: the limit from above holds always, that from below for one of three.
const TRIES = 3;
for (const [words, factor] of [[[], 1], [['--speed', '4'], 4], [['--speed', '0.5'], 0.5]] as const) {
  test(`fly --view ${words.join(' ')} flies at ${factor} times real time, never faster`, {timeout: 120_000}, async () => {
    const WALL_S = 3;
    const SLACK_S = 0.05; // of the flight, between a step and the message that has it
    let pace = 0;
    for (let k = 0; k < TRIES && pace < 0.8 * factor; ++k) {
      const start_ms = performance.now(); // before the first step
      const {child, url} = await flyWatched(started, join(scratch, `pace_${factor}_${k}`), '--mission', 'hop', ...words);
      const {socket, flight} = await viewer(url);
      const seen: [wall_s: number, flight_s: number][] = [];
      while ((seen.at(-1)?.[1] ?? 0) < WALL_S * factor) {
        await new Promise((resolve) => setTimeout(resolve, 20));
        const flight_s = flight.end_s;
        const wall_s = (performance.now() - start_ms) / 1000;
        assert.ok(flight_s <= wall_s * factor + SLACK_S, `${flight_s} s in ${wall_s} s`);
        if (flight_s > 0) seen.push([wall_s, flight_s]);
      }
      const [first, last] = [seen[0]!, seen.at(-1)!];
      pace = (last[1] - first[1]) / (last[0] - first[0]);
      socket.close();
      child.kill('SIGKILL');
    }
    assert.ok(pace >= 0.8 * factor, `${pace} times real time`);
  });
}
