// SPDX-License-Identifier: BSD-3-Clause
// Measures the page and its server on what runs. Usage: node bench/live_figures.ts VIEW SIL. Prints one JSON object.
//
// latency_ms: from an attitude sample that leaves the firmware (./rosflight sil, its bytes pass through here) to the end of the first
// picture drawn with it, less the frame period; the median. server_core_share: processor time of ./rosflight fly --view for each viewer
// that reads everything, at 60 Hz; with many viewers less with none.
import {spawn, type ChildProcess} from 'node:child_process';
import {createSocket, type Socket} from 'node:dgram';
import {readFileSync} from 'node:fs';
import {mkdtemp, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {LiveDecoder, PROTOCOLS} from '../src/data/live.ts';
import type {Flight} from '../src/data/flight.ts';
import {flightShown, newPage, startBrowser} from '../test/browser.ts';

const [VIEW = '', SIL = ''] = process.argv.slice(2);
const scratch = await mkdtemp(join(tmpdir(), 'rosflight_bench_live_'));
const started: ChildProcess[] = [];
const sockets: Socket[] = [];
const TINY = {width: 480, height: 360};
const SAMPLES_S = 8;

const median = (values: number[]) => values.sort((a, b) => a - b)[values.length >> 1]!;
const pause = (s: number) => new Promise((resolve) => setTimeout(resolve, 1000 * s));

function start(program: string, ...options: string[]) {
  const child = spawn(program, options, {stdio: ['ignore', 'pipe', 'pipe']});
  started.push(child);
  const url = new Promise<string>((resolve) => {
    for (const stream of [child.stdout, child.stderr]) stream.on('data', (data) => {
      const found = /http:\S+/.exec(String(data));
      if (found) resolve(found[0]);
    });
  });
  return {child, url};
}

async function bound() {
  const socket = createSocket('udp4');
  sockets.push(socket);
  await new Promise<void>((resolve) => socket.bind(0, '127.0.0.1', resolve));
  return socket;
}

const ATTITUDE_QUATERNION = 31; // u32 time, w, x, y, z
const HEAD = 6;

/** Calls for each frame of MAVLink 1 with its id and its payload. */
function frames(data: Buffer, use: (id: number, payload: Buffer) => void) {
  for (let at = 0; at + HEAD < data.length && data[at] === 0xfe; at += data[at + 1]! + HEAD + 2)
    use(data[at + 5]!, data.subarray(at + HEAD, at + HEAD + data[at + 1]!));
}

interface Shown { x: number; at: number }
interface Inside { flight: Flight; time: number }

async function latency(): Promise<{latency_ms: number; frame_ms: number}> {
  const [inner, outer, free] = [await bound(), await bound(), await bound()];
  const port = free.address().port;
  free.close();
  sockets.pop();
  start(SIL, 'sil', '--link', `udp:127.0.0.1:${inner.address().port}`, '--listen', '0', '--nvm', join(scratch, 'memory'));
  const sent = new Map<number, number>(); // attitude's x to the moment of its sample
  let board: {port: number; address: string} | undefined;
  inner.on('message', (data, from) => {
    board = from;
    const now = performance.timeOrigin + performance.now();
    frames(data, (id, payload) => { if (id === ATTITUDE_QUATERNION) sent.set(payload.readFloatLE(8), now); });
    outer.send(data, port, '127.0.0.1');
  });
  outer.on('message', (data) => { if (board) inner.send(data, board.port, board.address); });
  const {url} = start(VIEW, 'view', `udp:${port}`, '--out', join(scratch, 'link'));
  const browser = await startBrowser();
  const {page} = await newPage(browser, TINY);
  await page.goto(await url);
  await flightShown(page);
  const seen = await page.evaluate((seconds) => new Promise<{shown: Shown[]; periods: number[]}>((resolve) => {
    const scene = window.rosflightScene as unknown as Inside;
    const table = () => scene.flight.tables.get('/attitude')!;
    let next = table().length;
    let before = performance.now();
    const shown: Shown[] = [];
    const periods: number[] = [];
    // Called in the animation frame that has drawn: the scene counts its pictures in this attribute.
    const drawn = new MutationObserver(() => {
      const times = table().times;
      const x = table().column('attitude.x')!;
      for (; next < table().length && times[next]! <= scene.time; ++next) shown.push({x: x[next]!, at: performance.timeOrigin + performance.now()});
    });
    drawn.observe(document.querySelector('canvas[data-frames]')!, {attributeFilter: ['data-frames']});
    const end = performance.now() + 1000 * seconds;
    const count = () => {
      const now = performance.now();
      periods.push(now - before);
      before = now;
      if (now < end) requestAnimationFrame(count);
      else resolve({shown, periods});
    };
    requestAnimationFrame(count);
  }), SAMPLES_S);
  await browser.close();
  const took = seen.shown.flatMap(({x, at}) => sent.has(Math.fround(x)) ? [at - sent.get(Math.fround(x))!] : []);
  if (took.length < 50) throw new Error(`only ${took.length} of ${seen.shown.length} samples were found again`);
  const frame_ms = median(seen.periods);
  return {latency_ms: median(took) - frame_ms, frame_ms};
}

/** Processor time of a process [s]. */
function cpu(pid: number): number {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1]!.split(' ');
  const TICKS = 100; // a second, of every Linux
  return (Number(fields[11]) + Number(fields[12])) / TICKS;
}

async function coreShare(): Promise<number> {
  const VIEWERS = 8;
  const SPAN_S = 10;
  const {child, url} = start(VIEW, 'fly', '--view', '--hold', '--out', join(scratch, 'flight'));
  const address = (await url).replace('http', 'ws');
  const measured = async () => {
    const before = cpu(child.pid!);
    await pause(SPAN_S);
    return (cpu(child.pid!) - before) / SPAN_S;
  };
  await pause(12); // until the pilot holds
  const alone = await measured();
  const viewers = Array.from({length: VIEWERS}, () => {
    const decoder = new LiveDecoder('');
    const socket = new WebSocket(address, PROTOCOLS);
    socket.binaryType = 'arraybuffer';
    socket.onmessage = ({data}) => {
      const answer = typeof data === 'string' ? decoder.text(data) : undefined;
      if (answer) socket.send(answer);
    };
    return socket;
  });
  await pause(2);
  const watched = await measured();
  for (const socket of viewers) socket.close();
  return (watched - alone) / VIEWERS;
}

try {
  const share = await coreShare();
  const shown = await latency();
  console.log(JSON.stringify({...shown, server_core_share: share}));
} finally {
  for (const child of started) child.kill('SIGKILL');
  for (const socket of sockets) socket.close();
  await rm(scratch, {recursive: true});
}
