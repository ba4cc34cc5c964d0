// SPDX-License-Identifier: BSD-3-Clause
// ./rosflight view, and ./rosflight fly --view with a viewer that steers it, for tests.
import {spawn, type ChildProcess} from 'node:child_process';
import {Commands, type Control} from '../src/data/commands.ts';
import {LiveDecoder, PROTOCOLS} from '../src/data/live.ts';
import {VIEW} from './flights.ts';

/** Starts ./rosflight view; returns the address that it prints. */
export async function view(running: ChildProcess[], input: string, ...options: string[]): Promise<string> {
  const program = spawn(VIEW, ['view', input, ...options], {stdio: ['ignore', 'pipe', 'inherit']});
  running.push(program);
  for await (const line of program.stdout) return String(line).split(' ')[0]!;
  throw new Error('./rosflight view printed nothing');
}

/** Starts a program; `found` is what it printed that has the pattern, `printed` all so far. */
export async function start(running: ChildProcess[], program: string, words: string[], pattern: RegExp) {
  const child = spawn(program, words, {stdio: ['pipe', 'pipe', 'inherit']});
  running.push(child);
  let printed = '';
  const found = await new Promise<RegExpExecArray>((resolve, reject) => {
    child.on('exit', (code) => reject(new Error(`${program} ${words.join(' ')} ended with ${code}: ${printed}`)));
    child.stdout.on('data', (data) => {
      printed += String(data);
      const match = pattern.exec(printed);
      if (match) resolve(match);
    });
  });
  return {child, found, printed: () => printed};
}

/** The line that ./rosflight fly --view prints on standard error; with --listen a token stands behind the address. */
export const ADDRESS = /^(http:\/\/127\.0\.0\.(?:1:\d+\/|2:\d+\/#[0-9a-f]{32}))\n/m;

/** A flight that is watched; `printed` and `said` have what it wrote so far. */
export async function flyWatched(running: ChildProcess[], folder: string, ...options: string[]) {
  const child = spawn(VIEW, ['fly', '--view', '--json', '--out', folder, ...options], {stdio: ['ignore', 'pipe', 'pipe']});
  running.push(child);
  let said = '';
  let printed = '';
  child.stdout.on('data', (data) => { printed += String(data); });
  const url = await new Promise<string>((resolve) => child.stderr.on('data', (data) => {
    said += String(data);
    const found = ADDRESS.exec(said);
    if (found) resolve(found[1]!);
  }));
  return {child, url, printed: () => printed, said: () => said};
}

/** A viewer: its commands, the flight as it has it, and the newest state of the simulation. */
export async function viewer(url: string) {
  const socket = new WebSocket(url.replace('http', 'ws'), PROTOCOLS);
  socket.binaryType = 'arraybuffer';
  const commands = new Commands((text) => socket.send(text));
  const decoder = new LiveDecoder('');
  const seen: {control?: Control} = {};
  socket.onmessage = ({data}) => {
    if (typeof data !== 'string') return decoder.binary(new Uint8Array(data as ArrayBuffer));
    const answer = decoder.text(data);
    if (answer) return socket.send(answer);
    const message = JSON.parse(data) as {op?: string; control?: Control};
    commands.answered(message);
    if (message.control) seen.control = message.control;
  };
  await new Promise((resolve) => { socket.onopen = resolve; });
  const steer = async (text: string) => (await commands.steer(text))[0]!;
  const until = async (what: (control: Control) => boolean) => {
    while (!seen.control || !what(seen.control)) await new Promise((resolve) => setTimeout(resolve, 10));
  };
  return {socket, commands, flight: decoder.flight, seen, steer, until};
}

export const until = async (what: () => boolean) => { while (!what()) await new Promise((resolve) => setTimeout(resolve, 20)); };
