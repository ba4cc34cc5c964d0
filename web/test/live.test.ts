// SPDX-License-Identifier: BSD-3-Clause
// ./rosflight fly --view against FoxgloveClient, the class that Foxglove's own programs connect with, and against viewers that
// behave badly: the flight must not notice any of them.
import {FoxgloveClient, type Channel} from '@foxglove/ws-protocol';
import assert from 'node:assert/strict';
import {spawn, type ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {connect as connectTcp} from 'node:net';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {bytesSource} from '../src/data/bytes.ts';
import {LiveDecoder, PROTOCOLS} from '../src/data/live.ts';
import {readLog} from '../src/data/read_log.ts';
import {FLY, SIL, VIEW} from './flights.ts';
import {ADDRESS, flyWatched, start, until} from './simulated.ts';

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_live_'));
const running: ChildProcess[] = [];
after(async () => {
  for (const program of running) program.kill('SIGKILL');
  await rm(scratch, {recursive: true});
});

/** Of the firmware: a line each, and the head. */
const parameters = (await readFile(new URL('../../firmware/core/parameters.csv', import.meta.url), 'utf8')).trim().split('\n').length - 1;

let count = 0;

/** Starts a flight. `address` is that of its page, `summary` what it prints at landing. */
async function fly(program: string, ...options: string[]) {
  const child = spawn(program, ['fly', '--mission', 'hop', '--json', '--out', join(scratch, String(++count)), ...options],
    {stdio: ['ignore', 'pipe', 'pipe']});
  running.push(child);
  let said = '';
  const summary = new Promise<Record<string, unknown>>((resolve, reject) => {
    let text = '';
    child.stdout.on('data', (data) => {
      text += String(data);
      if (text.endsWith('}\n')) resolve(JSON.parse(text) as Record<string, unknown>);
    });
    child.on('close', () => reject(new Error(`the flight said no summary: ${said}`)));
  });
  summary.catch(() => {}); // a test may end the flight before
  const address = new Promise<string>((resolve) => child.stderr.on('data', (data) => {
    said += String(data);
    const found = ADDRESS.exec(said);
    if (found) resolve(found[1]!);
  }));
  return {child, summary, address};
}

/** Says that it is a WebSocket, subscribes to nothing it could name, and never reads. */
function neverReads(port: number) {
  const socket = connectTcp(port, '127.0.0.1');
  socket.on('error', () => {}); // it is closed in the end
  const lines = ['GET / HTTP/1.1', `Host: 127.0.0.1:${port}`, 'Upgrade: websocket', 'Connection: Upgrade', 'Sec-WebSocket-Version: 13',
    'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', `Sec-WebSocket-Protocol: ${PROTOCOLS[0]}`];
  socket.write(`${lines.join('\r\n')}\r\n\r\n`);
  const text = JSON.stringify({op: 'subscribe', subscriptions: Array.from({length: 40}, (_, k) => ({id: k, channelId: k + 1}))});
  const head = Buffer.from([0x81, 0xfe, text.length >> 8, text.length & 255, 0, 0, 0, 0]); // masked by zeros
  socket.once('data', () => { // the handshake's answer
    socket.pause();
    setInterval(() => socket.write(Buffer.concat([head, Buffer.from(text)])), 50).unref(); // channels appear as the flight goes on
  });
  return socket;
}

test('the log is the same to the bit with and without three viewers, one of which never reads', {timeout: 120_000}, async () => {
  const plain = await (await fly(FLY)).summary;
  const {child, summary, address} = await fly(VIEW, '--view', '--speed', '8');
  const url = await address;
  const socket = url.replace('http', 'ws');
  const stuck = neverReads(Number(new URL(url).port));

  const client = new FoxgloveClient({ws: new WebSocket(socket, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) as never});
  const channels = new Map<number, Channel>();
  const received = new Map<string, number>();
  const complaints: string[] = [];
  client.on('advertise', (advertised) => {
    for (const channel of advertised) channels.set(client.subscribe(channel.id), channel);
  });
  client.on('message', ({subscriptionId}) => {
    const topic = channels.get(subscriptionId)!.topic;
    received.set(topic, (received.get(topic) ?? 0) + 1);
  });
  client.on('error', (error) => complaints.push(String(error)));
  client.on('status', ({message}) => complaints.push(message));

  const decoder = new LiveDecoder('live');
  const ours = new WebSocket(socket, PROTOCOLS);
  ours.binaryType = 'arraybuffer';
  ours.onmessage = ({data}) => {
    if (typeof data !== 'string') return decoder.binary(new Uint8Array(data as ArrayBuffer));
    const answer = decoder.text(data);
    if (answer) ours.send(answer);
  };

  const watched = await summary;
  assert.equal(watched['log_sha256'], plain['log_sha256']);
  assert.equal(watched['success'], true);
  assert.deepEqual(complaints, []);
  assert.ok(channels.size > 30, `${channels.size} channels`);
  assert.ok(received.get('/sim/truth_state')! > 20, `${received.get('/sim/truth_state')} messages`);
  // Our own decoder has every event and the motion.
  const {flight} = decoder;
  assert.ok(flight.urdf.includes('rotor_0') && flight.plans.length === 1);
  assert.equal(flight.tables.get('/parameters')!.length, parameters);
  assert.ok(flight.events.some(({text}) => /land/i.test(text)));
  assert.ok(flight.tables.get('/sim/truth_state')!.length > 20);
  assert.equal(received.get('/rosout'), flight.events.length);
  client.close();
  ours.close();
  stuck.destroy();
  // The page stays until it receives the end.
  assert.equal((await fetch(url)).status, 200);
  assert.equal(child.exitCode, null);
  child.kill('SIGINT');
  assert.equal(await new Promise((resolve) => child.on('exit', resolve)), 0);
});

test('a viewer that comes after the landing gets every event and the latest states', {timeout: 120_000}, async () => {
  const {child, summary, address} = await fly(VIEW, '--view', '--speed', '50');
  const url = await address;
  await summary;
  const decoder = new LiveDecoder('late');
  const socket = new WebSocket(url.replace('http', 'ws'), PROTOCOLS);
  socket.binaryType = 'arraybuffer';
  await new Promise<void>((resolve) => {
    socket.onmessage = ({data}) => {
      if (typeof data === 'string') {
        const answer = decoder.text(data);
        if (answer) socket.send(answer);
      } else {
        decoder.binary(new Uint8Array(data as ArrayBuffer));
        if (decoder.flight.poseAt(decoder.flight.end_s)) resolve();
      }
    };
  });
  assert.equal(decoder.flight.tables.get('/parameters')!.length, parameters);
  assert.ok(Math.abs(decoder.flight.poseAt(decoder.flight.end_s)!.p[2]) < 0.3, 'landed');
  socket.close();
  child.kill('SIGTERM');
});

test('FoxgloveClient reads and sets parameters, and the log says who did', {timeout: 120_000}, async () => {
  const {child, summary, address} = await fly(VIEW, '--view');
  const url = await address;
  const socket = new WebSocket(url.replace('http', 'ws'), [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  const client = new FoxgloveClient({ws: socket as never});
  const complaints: string[] = [];
  client.on('status', ({message}) => complaints.push(message));
  const values = (names: string[]) => new Promise<{name: string; value: unknown}[]>((resolve) => {
    client.on('parameterValues', ({parameters: found, id}) => { if (id === `get ${names}`) resolve(found as never); });
    client.getParameters(names, `get ${names}`);
  });
  await new Promise<void>((resolve) => client.on('open', () => resolve()));
  const soon = () => Promise.race([values([]), new Promise<[]>((resolve) => setTimeout(() => resolve([]), 200))]);
  let all = await soon(); // empty until the list has come over the link
  for (; all.length === 0; all = await soon());
  assert.equal(all.length, parameters);
  assert.match(complaints[0] ?? 'none are known', /none are known/);
  const done = new Promise<{value: unknown}[]>((resolve) => client.on('parameterValues', ({parameters: found, id}) => { if (id === 'set') resolve(found as never); }));
  socket.send(JSON.stringify({op: 'takeControl'})); // which Foxglove's protocol does not have
  client.setParameters([{name: 'ACC_X_TEMP_COMP', value: 0.001}], 'set');
  assert.deepEqual((await done).map(({value}) => value), [Math.fround(0.001)]);
  assert.deepEqual((await values(['ACC_X_TEMP_COMP'])).map(({value}) => value), [Math.fround(0.001)]);
  socket.send(JSON.stringify({op: 'steer', text: 'speed 50'}));
  client.close();
  const {success} = await summary;
  assert.equal(success, true);
  const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(join(scratch, String(count), 'flight.mcap')))));
  const said = flight.events.find(({source, text}) => source === 'viewer' && /sets ACC_X_TEMP_COMP 0.001/.test(text))!;
  const link = flight.tables.get('/link/param_set')!;
  const sent = link.text('name')!.lastIndexOf('ACC_X_TEMP_COMP');
  assert.ok(link.times[sent]! - said.t >= 0 && link.times[sent]! - said.t < 0.02, 'the moment of the command');
  child.kill('SIGTERM');
});

test('who does not speak the protocol, or is a foreign page, gets no WebSocket', {timeout: 120_000}, async () => {
  const {child, address} = await fly(VIEW, '--view');
  const url = await address;
  const port = Number(new URL(url).port);
  const answer = (...headers: string[]) => new Promise<string>((resolve) => {
    const socket = connectTcp(port, '127.0.0.1');
    let text = '';
    socket.on('data', (data) => {
      text += String(data);
      socket.destroy();
      resolve([text.split(' ')[1]!, ...text.match(/(?<=^Sec-WebSocket-Protocol: ).*(?=\r)/mi) ?? []].join(' '));
    });
    socket.write(`${['GET / HTTP/1.1', 'Upgrade: websocket', 'Connection: Upgrade', 'Sec-WebSocket-Version: 13',
      'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', ...headers].join('\r\n')}\r\n\r\n`);
  });
  const here = `Host: 127.0.0.1:${port}`;
  const protocol = 'Sec-WebSocket-Protocol: foxglove.websocket.v1';
  const chosen = '101 foxglove.websocket.v1';
  assert.equal(await answer(here, protocol), chosen);
  assert.equal(await answer(here, protocol, `Origin: ${url.slice(0, -1)}`), chosen);
  assert.equal(await answer(here, 'Sec-WebSocket-Protocol: foxglove.sdk.v1'), '101 foxglove.sdk.v1');
  assert.equal(await answer(here), '400');
  assert.equal(await answer(here, 'Sec-WebSocket-Protocol: other'), '400');
  assert.equal(await answer(here, protocol, 'Origin: http://example.org'), '403');
  assert.equal(await answer(here, protocol, 'Origin: null'), '403');
  assert.equal(await answer(`Host: example.org:${port}`, protocol), '421');
  child.kill('SIGKILL');
});

/** Of each address for other computers that a program prints: what stands behind it, the right to command as the server says it, and its
 * answer to a viewer who takes control. */
async function rights(said: () => string) {
  await until(() => said().includes('without the right to command'));
  const printed = [...said().matchAll(/^(http:\/\/127\.0\.0\.2:\d+\/)#([0-9a-f]{32})(.*)$/gm)];
  return Promise.all(printed.map(([, address, token, note]) => new Promise<[string, string, string]>((resolve) => {
    const socket = new WebSocket(address!.replace('http', 'ws'), PROTOCOLS);
    let right = '';
    socket.onopen = () => socket.send(JSON.stringify({op: 'token', token}));
    socket.onmessage = ({data}) => {
      if (typeof data !== 'string') return;
      const message = JSON.parse(data) as {op: string; id?: string; metadata?: {commands: string}; message?: string; results?: {text: string}[]};
      if (message.metadata) {
        right = message.metadata.commands;
        socket.send(JSON.stringify({op: 'takeControl', id: 'take'}));
      }
      const answer = message.op === 'status' ? message.message : message.id === 'take' ? message.results?.[0]?.text : undefined;
      if (answer === undefined) return;
      resolve([note!.trim(), right, answer]);
      socket.close();
    };
  })));
}
const both = (note: string) => [[note, 'yes', 'in control'],
  ['(without the right to command)', 'no', 'this address is one to look, not to command']];

test('of the two addresses for other computers one looks alone and the other commands too: fly --view', {timeout: 120_000}, async () => {
  const {said, child} = await flyWatched(running, join(scratch, String(++count)), '--mission', 'hop', '--listen', '127.0.0.2');
  assert.deepEqual(await rights(said), both(''));
  child.kill('SIGKILL');
});

test('the same of a vehicle on a link: view LINK', {timeout: 120_000}, async () => {
  const firmware = await start(running, SIL, ['sil', '--link', 'tcp:0', '--nvm', join(scratch, 'listen.nvm')], /link=(\S+)/);
  const view = await start(running, VIEW, ['view', firmware.found[1]!, '--out', join(scratch, String(++count)), '--listen', '127.0.0.2'], /http/);
  assert.deepEqual(await rights(view.printed), both('(Ctrl-C ends it)'));
});
