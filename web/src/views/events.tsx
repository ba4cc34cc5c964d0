// SPDX-License-Identifier: BSD-3-Clause
import {useEffect, useRef} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import {lastAtOrBefore} from '../data/table.ts';
import * as state from '../state.ts';

const WORDS = {good: 'ok', note: 'info', warning: 'warning', bad: 'error', neutral: 'info'};

/** Every text of the flight; the latest at the moment shown is marked. */
export function Events({flight}: {flight: Flight}) {
  const {events} = flight;
  const now = lastAtOrBefore(events.map(({t}) => t), events.length, state.time.value);
  const list = useRef<HTMLTableSectionElement>(null);
  useEffect(() => {
    if (state.playing.value) list.current?.children[now]?.scrollIntoView({block: 'nearest'});
  }, [now]);
  return <section aria-label="Events" class="events">
    <table>
      <thead><tr><th class="n">time, s</th><th>kind</th><th>from</th><th>text</th></tr></thead>
      <tbody ref={list}>{events.map(({t, tone, source, text}, k) =>
        <tr key={k} class={k === now ? 'now' : k > now ? 'ahead' : ''} aria-current={k === now ? 'time' : undefined}>
          <td class="n"><button class="link" onClick={() => state.seek(t)}>{t.toFixed(2)}</button></td>
          <td><span class={`badge ${tone}`}>{WORDS[tone]}</span></td><td>{source}</td><td class="wrap">{text}</td>
        </tr>)}</tbody>
    </table>
    {events.length === 0 && <p class="hint">The log has no texts.</p>}
  </section>;
}
