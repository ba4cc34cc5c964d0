// SPDX-License-Identifier: BSD-3-Clause
// How good the link between companion and firmware is: ten times a second the companion asks for the firmware's time, and the firmware
// echoes the time of the request, so each request has an answer or has none.
import type {Flight} from './flight.ts';

export const TIME_SYNC = '/link/time_sync';
/** Requests of this long are counted. */
export const WINDOW_S = 5;
/** Without an answer for so long the companion says "link lost" (companion::Session, connection_timeout). */
export const TIMEOUT_S = 2;
/** An answer that takes longer counts as lost: requests of a serial cable are answered within some hundredths. */
export const WAIT_S = 0.3;
const WEAK_SHARE = 0.05; // of unanswered requests

export interface LinkQuality {
  state: 'good' | 'weak' | 'lost';
  /** Of the last WINDOW_S, each at least WAIT_S ago. */
  requests: number;
  unanswered: number;
  /** Of the last request that was seen with its answer, NaN if there is none. */
  roundTrip_ms: number;
  /** Of the last answer, NaN before the first. */
  age_s: number;
}

/** At `t`, by what had come until then; undefined before the first request and without any. */
export function linkQualityAt(flight: Flight, t: number): LinkQuality | undefined {
  const table = flight.tables.get(TIME_SYNC);
  const direction = table?.column('direction');
  const sent = table?.column('ts1');
  if (!table || !direction || !sent) return undefined;
  const newest = table.rowAt(t);
  if (newest < 0) return undefined;
  const answers = new Map<number, number>(); // when each came, by the time of its request
  const due = (at: number) => at >= t - WINDOW_S && at <= t - WAIT_S;
  let [requests, unanswered] = [0, 0];
  let answered_s: number | undefined;
  let roundTrip_s: number | undefined;
  for (let row = newest; row >= 0 && (table.times[row]! >= t - WINDOW_S || answered_s === undefined); --row) {
    const at = table.times[row]!;
    if (direction[row] !== TO_FCU) {
      answers.set(sent[row]!, at);
      answered_s ??= at;
      continue;
    }
    const answer = answers.get(sent[row]!);
    answers.delete(sent[row]!);
    if (answer !== undefined) roundTrip_s ??= answer - at;
    if (!due(at)) continue;
    ++requests;
    if (answer === undefined || answer - at > WAIT_S) ++unanswered;
  }
  // To a page that is late the server sends the newest of both: of the oldest an answer may be without its request.
  for (const at of answers.values()) if (due(at)) ++requests;
  const silent_s = t - (answered_s ?? table.times[0]!);
  const state = silent_s > TIMEOUT_S ? 'lost' : unanswered > WEAK_SHARE * requests ? 'weak' : 'good';
  return {state, requests, unanswered, roundTrip_ms: 1000 * (roundTrip_s ?? NaN), age_s: answered_s === undefined ? NaN : silent_s};
}

const TO_FCU = 1; // RawFrames.COMPANION_TO_FCU
