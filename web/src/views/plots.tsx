// SPDX-License-Identifier: BSD-3-Clause
import {effect} from '@preact/signals';
import {useEffect, useMemo, useRef, useState} from 'preact/hooks';
import {field} from '../data/curves.ts';
import type {Flight} from '../data/flight.ts';
import * as state from '../state.ts';
import {chartGroups, type Chart} from './charts.ts';
import {Plot} from './plot.ts';

/** Span of time that all charts show. */
interface Zoom { from: number; to: number }

export function Plots({flight}: {flight: Flight}) {
  const [zoom, setZoom] = useState<Zoom>({from: 0, to: flight.end_s});
  const [own, setOwn] = useState<string[]>([]);
  const groups = useMemo(() => chartGroups(flight), [flight]);
  const chosen = useMemo(() => own.map((name) => ownChart(flight, name)), [flight, own]);
  const zoomed = zoom.from > 0 || zoom.to < flight.end_s;
  return <section class="plots" aria-label="Plots">
    <p class="hint">Click: go to that moment. Drag: zoom. Double click: all of it. Broad pale lines are commands.
      {zoomed && <button class="link" onClick={() => setZoom({from: 0, to: flight.end_s})}>show all of it</button>}</p>
    <FieldChooser flight={flight} onChoose={(name) => setOwn((names) => [...new Set([name, ...names])])}/>
    {chosen.map((chart) => <ChartFigure key={chart.title} {...{chart, flight, zoom, setZoom}}
      onRemove={() => setOwn((names) => names.filter((name) => name !== chart.title))}/>)}
    {groups.map(({name, charts}, k) => <details open={k < 3} key={name}>
      <summary><h2>{name}</h2></summary>
      <div class="charts">{charts.map((chart) => <ChartFigure key={chart.title} {...{chart, flight, zoom, setZoom}}/>)}</div>
    </details>)}
  </section>;
}

function ownChart(flight: Flight, title: string): Chart {
  const [topic = '', name = ''] = title.split(' ');
  const curve = field(flight, topic, name);
  return {title, unit: '', lines: curve ? [{label: name, style: 'actual', curve}] : []};
}

/** Every number of every topic. */
function FieldChooser({flight, onChoose}: {flight: Flight; onChoose: (name: string) => void}) {
  const names = useMemo(() => [...flight.tables].flatMap(([topic, table]) => table.names
    .filter((name) => !name.startsWith('header.')).map((name) => `${topic} ${name}`)).sort(), [flight]);
  const known = useMemo(() => new Set(names), [names]);
  return <div class="chooser">
    <label>Add a plot of any field <input list="fields" placeholder="/imu/data angular_velocity.x" onInput={(event) => {
      const input = event.currentTarget;
      if (!known.has(input.value)) return;
      onChoose(input.value);
      input.value = '';
    }}/></label>
    <datalist id="fields">{names.map((name) => <option key={name} value={name}/>)}</datalist>
  </div>;
}

interface FigureProps { chart: Chart; flight: Flight; zoom: Zoom; setZoom: (zoom: Zoom) => void; onRemove?: () => void }

/** Drawn when it first comes into sight. */
function ChartFigure({chart, flight, zoom, setZoom, onRemove}: FigureProps) {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<Plot | undefined>(undefined);
  const span = useRef(zoom);
  span.current = zoom;
  useEffect(() => {
    const element = place.current!;
    let stop = () => {};
    const seen = new IntersectionObserver(([entry]) => {
      if (!entry?.isIntersecting || plot.current) return;
      const made = plot.current = new Plot(element, chart, flight.end_s,
        {onSeek: state.seek, onZoom: (from, to) => setZoom({from, to})});
      made.setSpan(span.current.from, span.current.to);
      stop = effect(() => made.setTime(state.time.value));
    }, {rootMargin: '200px'});
    const sized = new ResizeObserver(() => plot.current?.setWidth(element.clientWidth));
    seen.observe(element);
    sized.observe(element);
    return () => {
      stop();
      seen.disconnect();
      sized.disconnect();
      plot.current?.destroy();
      plot.current = undefined;
    };
  }, [chart, flight]);
  useEffect(() => plot.current?.setSpan(zoom.from, zoom.to), [zoom]);
  return <figure>
    <figcaption>{chart.title} {chart.unit && <span class="unit">{chart.unit}</span>}
      {onRemove && <button class="link" aria-label={`remove the plot ${chart.title}`} onClick={onRemove}>remove</button>}
    </figcaption>
    <div class="plot" ref={place}/>
  </figure>;
}
