// SPDX-License-Identifier: BSD-3-Clause
// What the views share: the flight, the moment shown, how it goes on.
import {signal} from '@preact/signals';
import type {Commands, Control} from './data/commands.ts';
import type {Flight} from './data/flight.ts';
import {nextPicture} from './pictures.ts';

export const flight = signal<Flight | undefined>(undefined);
/** Moment shown [s]. */
export const time = signal(0);
export const playing = signal(false);
/** Times real time. */
export const speed = signal(1);
/** What the page is doing before there is a flight, or why there is none. */
export const loading = signal<{share: number} | undefined>(undefined);
export const failure = signal('');
/** Facts about the flight beside its log, as summary.json of its folder has them. */
export const summary = signal<Record<string, unknown> | undefined>(undefined);

/** Whether the page has an extract of the log inside it, report.html: states at 50 Hz. */
export const extract = signal(false);

/** Whether the flight comes from a server as it happens. */
export const live = signal<'off' | 'connecting' | 'on' | 'gone'>('off');
/** The moment shown is the latest. */
export const following = signal(false);
/** Counts up while a flight grows, for what is drawn seldom. */
export const revision = signal(0);

/** Over the connection with the server; undefined where nothing can be commanded. */
export const commands = signal<Commands | undefined>(undefined);
/** Of a running flight; undefined where nothing can be commanded. */
export const control = signal<Control | undefined>(undefined);
export const hasControl = () => control.value !== undefined && control.value.viewer === control.value.you;
/** This page had control when its connection ended; until it takes control again. */
export const controlEnded = signal(false);
/** Another vehicle on a link, and the address of its parameters. */
export const other = signal<{name: string; parameters: string} | undefined>(undefined);
/** Parameters have changed since they were last written to the vehicle's memory. */
export const unsaved = signal(false);

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20] as const;

/** Away from the latest moment, if the flight is live. */
export function seek(t: number) {
  following.value = false;
  const end = flight.value?.end_s ?? 0;
  time.value = Math.min(Math.max(t, 0), end);
}

export function play(on: boolean) {
  if (on === playing.value || !flight.value) return;
  if (on && time.value >= flight.value.end_s) time.value = 0;
  playing.value = on;
  if (on) nextPicture((now) => step(now, now));
}

function step(before_ms: number, now_ms: number) {
  if (!playing.value) return;
  const t = time.value + (now_ms - before_ms) / 1000 * speed.value;
  if (t >= (flight.value?.end_s ?? 0)) playing.value = false;
  else nextPicture((next_ms) => step(now_ms, next_ms));
  seek(t);
}

/** To the next message of the topic that the 3-D view follows; `direction` is 1 or -1. */
export function stepMessage(direction: 1 | -1) {
  playing.value = false;
  const table = flight.value?.tables.get(flight.value.poseTopic?.topic ?? '');
  if (!table) return;
  const slack_s = 1e-6;
  const row = table.rowAt(time.value + (direction > 0 ? slack_s : -slack_s)) + (direction > 0 ? 1 : 0);
  seek(table.times[Math.min(Math.max(row, 0), table.length - 1)] ?? 0);
}
