// SPDX-License-Identifier: BSD-3-Clause
// Which moment is shown: a slider over time with the states and marks for the events, and how fast it goes on.
import {useMemo} from 'preact/hooks';
import type {Flight, FlightEvent} from '../data/flight.ts';
import {lanesOf} from '../data/lanes.ts';
import * as state from '../state.ts';

export function Timeline({flight}: {flight: Flight}) {
  const lanes = useMemo(() => lanesOf(flight), [flight, state.revision.value]);
  const end = Math.max(flight.end_s, 0.1);
  const at = (t: number) => `${100 * t / end}%`;
  const t = state.time.value;
  return <section class="timeline" aria-label="Time">
    <div class="controls">
      <button class="play" onClick={() => state.play(!state.playing.value)} aria-label={state.playing.value ? 'Pause' : 'Play'}
        title="Space">{state.playing.value ? '❚❚' : '▶'}</button>
      <button onClick={() => state.stepMessage(-1)} aria-label="One step back" title=",">◂</button>
      <button onClick={() => state.stepMessage(1)} aria-label="One step on" title=".">▸</button>
      <label class="speed"><span class="sr">Speed</span>
        <select value={String(state.speed.value)} onChange={(event) => { state.speed.value = Number(event.currentTarget.value); }}>
          {state.SPEEDS.map((speed) => <option key={speed} value={String(speed)}>{speed}×</option>)}
        </select></label>
      <output class="clock">{t.toFixed(2)} s</output>
      {state.live.value === 'on' && <button aria-pressed={state.following.value} class="live"
        onClick={() => { state.following.value = true; state.play(false); }}>live</button>}
    </div>
    <div class="track">
      <input type="range" min={0} max={end} step={0.01} value={t} aria-label="Time in the flight"
        aria-valuetext={`${t.toFixed(2)} of ${end.toFixed(1)} seconds`}
        onInput={(event) => state.seek(Number(event.currentTarget.value))}/>
      <div class="marks" aria-hidden="true">{marks(flight.events).map(({t: moment, tone, text}) =>
        <button key={`${moment}${text}`} tabIndex={-1} class={`mark ${tone}`} style={{left: at(moment)}} title={`${moment.toFixed(2)} s ${text}`}
          onClick={() => state.seek(moment)}/>)}</div>
      <div class="lanes">{lanes.map(({name, spans}) => <div class="lane" key={name}>
        <span class="name">{name}</span>
        {spans.map(({from, to, label, tone}) => <span key={from} class={`span ${tone}`} title={`${label}, ${from.toFixed(2)} to ${to.toFixed(2)} s`}
          style={{left: at(from), width: `${100 * (to - from) / end}%`}}>{label}</span>)}
      </div>)}
        <div class="now" style={{left: at(t)}}/>
      </div>
    </div>
  </section>;
}

/** Enough to see where something happened: no more than a mark each thousandth of the track, the worst of each. */
function marks(events: readonly FlightEvent[]): FlightEvent[] {
  const order = ['note', 'neutral', 'good', 'warning', 'bad'];
  const at = new Map<number, FlightEvent>();
  const end = events.at(-1)?.t || 1;
  for (const event of events) {
    const place = Math.round(1000 * event.t / end);
    const there = at.get(place);
    if (!there || order.indexOf(event.tone) > order.indexOf(there.tone)) at.set(place, event);
  }
  return [...at.values()];
}
