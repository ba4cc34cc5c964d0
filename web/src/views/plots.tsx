// SPDX-License-Identifier: BSD-3-Clause
import {effect} from '@preact/signals';
import {useEffect, useMemo, useRef, useState} from 'preact/hooks';
import {faultsOf} from '../data/analysis.ts';
import {field} from '../data/curves.ts';
import type {Flight} from '../data/flight.ts';
import * as state from '../state.ts';
import {chartGroups, type Chart} from './charts.ts';
import {Plot, type PlotOptions} from './plot.ts';
import {useTheme} from './theme.ts';

/** Span of time that all charts show. */
interface Zoom { from: number; to: number }

export function Plots({flight}: {flight: Flight}) {
  const [zoom, setZoom] = useState<Zoom | null>(null);
  const revision = state.revision.value;
  const [own, setOwn] = useState<string[]>([]);
  const groups = useMemo(() => chartGroups(flight), [flight, revision]);
  const chosen = useMemo(() => own.map((name) => ownChart(flight, name)), [flight, own, revision]);
  const end_s = flight.end_s;
  const shades = useMemo(() => faultsOf(flight.facts, flight.end_s), [flight, revision]);
  /** Half of the span, about the moment shown: dragging needs a mouse. */
  const zoomIn = () => {
    const quarter_s = (zoom ? zoom.to - zoom.from : end_s) / 4;
    const middle_s = Math.min(Math.max(state.time.value, quarter_s), end_s - quarter_s);
    setZoom({from: middle_s - quarter_s, to: middle_s + quarter_s});
  };
  return <section class="plots" aria-label="Plots">
    <p class="hint">Click: go to that moment. Drag: zoom. Double click: all of it. Broad pale lines are commands.
      {shades.length > 0 && ' A fault is in force where a plot is shaded.'}</p>
    <div class="tools"><button onClick={zoomIn}>Zoom in</button>{zoom && <button onClick={() => setZoom(null)}>Show all of it</button>}</div>
    <FieldChooser flight={flight} onChoose={(name) => setOwn((names) => [...new Set([name, ...names])])}/>
    {chosen.map((chart) => <ChartFigure key={chart.title} {...{chart, shades, end_s, zoom, setZoom}}
      onRemove={() => setOwn((names) => names.filter((name) => name !== chart.title))}/>)}
    {groups.map(({name, charts}, k) => <details open={k < 3} key={name}>
      <summary><h2>{name}</h2></summary>
      <div class="charts">{charts.map((chart) => <ChartFigure key={chart.title} {...{chart, shades, end_s, zoom, setZoom}}/>)}</div>
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
  void state.revision.value; // a running flight gets topics, and fields of sequences, as it goes on
  const columns = [...flight.tables.values()].reduce((sum, table) => sum + table.names.length, 0);
  const names = useMemo(() => [...flight.tables].flatMap(([topic, table]) => table.names
    .filter((name) => !name.startsWith('header.')).map((name) => `${topic} ${name}`)).sort(), [flight, columns]);
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

interface FigureProps { chart: Chart; shades: PlotOptions['shades']; end_s: number; zoom: Zoom | null; setZoom: (zoom: Zoom | null) => void; onRemove?: () => void }

/** Drawn when it first comes into sight, and again when its chart or the span shown has changed. */
function ChartFigure({chart, shades, end_s, zoom, setZoom, onRemove}: FigureProps) {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<Plot | undefined>(undefined);
  const latest = useRef({chart, end_s, zoom});
  latest.current = {chart, end_s, zoom};
  const theme = useTheme();
  const kinds = chart.lines.map(({label}) => label).join();
  useEffect(() => {
    const element = place.current!;
    let stop = () => {};
    const seen = new IntersectionObserver(([entry]) => {
      if (!entry?.isIntersecting || plot.current) return;
      const {chart, zoom, end_s} = latest.current;
      const made = plot.current = new Plot(element, chart, {shades, onSeek: state.seek, onZoom: (from, to) => setZoom({from, to}), onAll: () => setZoom(null)});
      made.setSpan(zoom ?? {from: 0, to: end_s});
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
  }, [kinds, theme]);
  useEffect(() => plot.current?.setChart(chart), [chart]);
  useEffect(() => plot.current?.setSpan(zoom ?? {from: 0, to: end_s}), [zoom, end_s]);
  return <figure>
    <figcaption>{chart.title} {chart.unit && <span class="unit">{chart.unit}</span>}
      {onRemove && <button class="link" aria-label={`remove the plot ${chart.title}`} onClick={onRemove}>remove</button>}
    </figcaption>
    <div class="plot" ref={place}/>
  </figure>;
}
