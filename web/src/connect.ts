// SPDX-License-Identifier: BSD-3-Clause
// Keeps the page connected with the running flight of its server.
import {batch} from '@preact/signals';
import {Commands, type Control, type Result} from './data/commands.ts';
import type {Flight} from './data/flight.ts';
import {LiveDecoder, PROTOCOLS} from './data/live.ts';
import {nextPicture} from './pictures.ts';
import * as state from './state.ts';
import {admission, firstMessage, WHOLE_ADDRESS} from './token.ts';

const AGAIN_MS = 1000;
/** How often what is slow to draw (plots, trails, states) is drawn again. */
const REVISION_MS = 1000;
/** The picture is this late, one period of the server, so that it lies between two messages. */
const DELAY_MS = 1000 / 60;
/** After so long without news there is nothing to lie between: the latest is shown. */
const QUIET_MS = 200;

interface ServerMessage { op?: string; metadata?: Record<string, string>; unsaved?: boolean; control?: Control; id?: string; results?: Result[] }

/** What is no message of the flight. */
function onServer(message: ServerMessage, commands: Commands) {
  if (message.op === 'serverInfo' && message.metadata?.['commands'] === 'yes') state.commands.value = commands;
  if (message.unsaved !== undefined) state.unsaved.value = message.unsaved;
  if (message.control) {
    state.control.value = message.control;
    if (state.hasControl()) state.controlEnded.value = false;
  }
  commands.answered(message);
  if (message.results) ++state.revision.value; // what is in force has come before them
}

/** Shows the flight as it grows, with each picture, until another one is shown or the connection is lost. */
function follow(flight: Flight) {
  let revised = 0;
  let newest = {end_s: -1, at_ms: 0};
  let shown_s = 0;
  const show = () => {
    if (state.live.value !== 'on' || state.flight.value !== flight) return;
    nextPicture(show);
    const now = performance.now();
    const {end_s} = flight;
    if (end_s > newest.end_s) newest = {end_s, at_ms: now};
    const quiet = now - newest.at_ms > QUIET_MS;
    // Between two messages time goes on as in the simulation, and never back.
    const behind_s = (DELAY_MS - (now - newest.at_ms)) / 1000 * (state.control.value?.speed ?? 1);
    shown_s = quiet ? end_s : Math.max(shown_s, end_s - Math.max(behind_s, 0));
    batch(() => {
      if (state.following.value) state.time.value = Math.max(shown_s, 0);
      if (now - revised > REVISION_MS) {
        revised = now;
        ++state.revision.value;
      }
    });
  };
  nextPicture(show);
}

/** What belongs to a connection alone. */
function withoutServer() {
  state.commands.value = undefined;
  state.control.value = undefined;
}

/** Of the connection there is, or of the wait for the next one. */
let end = () => {};

/** The page shows something else from now on: the user has opened a log. */
export function disconnect() {
  if (state.live.value === 'off') return;
  end();
  batch(() => {
    withoutServer();
    state.controlEnded.value = false;
    state.other.value = undefined;
    state.unsaved.value = false;
    state.following.value = false;
    state.live.value = 'off';
  });
}

/** Whether the server that is there now, started again, has another token. */
async function wantsOtherToken(): Promise<boolean> {
  return (await fetch('offer.json', {headers: admission()}).catch(() => undefined))?.status === 401;
}

export function connect(name: string) {
  if (state.live.value === 'off') state.live.value = 'connecting';
  const socket = new WebSocket(location.href.replace(/^http/, 'ws').replace(/[?#].*/, ''), PROTOCOLS);
  socket.binaryType = 'arraybuffer';
  const decoder = new LiveDecoder(name);
  const commands = new Commands((text) => socket.send(text));
  let greeted = false;
  socket.onopen = () => {
    const first = firstMessage();
    if (first) socket.send(first);
  };
  socket.onmessage = ({data}) => {
    if (typeof data === 'string') {
      greeted = true;
      const answer = decoder.text(data);
      if (answer) socket.send(answer);
      else onServer(JSON.parse(data) as ServerMessage, commands);
      return;
    }
    try {
      decoder.binary(new Uint8Array(data as ArrayBuffer));
    } catch (error) {
      state.failure.value = `A message of the flight cannot be read: ${(error as Error).message}`;
    }
    if (state.flight.value === decoder.flight) return;
    state.flight.value = decoder.flight;
    state.following.value = true;
    state.live.value = 'on';
    follow(decoder.flight);
  };
  let over = false;
  const again = async () => {
    const refused = !greeted && firstMessage() !== undefined && await wantsOtherToken();
    if (over) return;
    if (!refused) return connect(name);
    state.failure.value = WHOLE_ADDRESS;
    state.live.value = 'off';
  };
  let timer: ReturnType<typeof setTimeout> | undefined;
  socket.onclose = () => {
    commands.lost();
    if (state.hasControl()) state.controlEnded.value = true;
    withoutServer();
    state.live.value = 'gone';
    timer = setTimeout(() => void again(), AGAIN_MS);
  };
  end = () => {
    over = true;
    clearTimeout(timer);
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
    commands.lost();
  };
}
