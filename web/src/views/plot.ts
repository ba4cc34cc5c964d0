// SPDX-License-Identifier: BSD-3-Clause
// One chart drawn by uPlot. All charts of the page share cursor, zoom and the moment shown.
import uPlot from 'uplot';
import {lastRow, shownRow} from '../data/curves.ts';
import {lastAtOrBefore} from '../data/table.ts';
import {numbered, palette} from '../scene/palette.ts';
import type {Chart, Line} from './charts.ts';

const HEIGHT = 150;

export interface PlotOptions {
  /** Spans of time to shade [s]: faults. */
  shades: readonly {from: number; to: number}[];
  /** A click asks to go there [s]. */
  onSeek: (t: number) => void;
  /** The user zoomed to this span [s]. */
  onZoom: (from: number, to: number) => void;
  /** The user wants to see all of it. */
  onAll: () => void;
}

export class Plot {
  private readonly chart: uPlot;
  private readonly marker = document.createElement('div');
  private t = 0;
  /** The row of the last sample in each column. */
  private lastRows: number[] = [];

  constructor(place: HTMLElement, chart: Chart, {shades, onSeek, onZoom, onAll}: PlotOptions) {
    const colours = palette();
    const axis = {stroke: colours.faint, grid: {stroke: colours.grid, width: 1}, ticks: {show: false}, font: '11px system-ui, sans-serif'};
    this.marker.className = 'now';
    this.chart = new uPlot({
      width: place.clientWidth, height: HEIGHT, legend: {show: true, live: true},
      cursor: {sync: {key: 'flight', setSeries: false}, dataIdx: (u, k, row) => this.rowOf(u.data, k, row), drag: {x: true, y: false}, points: {size: 6}},
      scales: {x: {time: false, min: 0, max: 1}},
      axes: [{...axis, size: 24, values: (_, ticks) => ticks.map((t) => `${t}`)}, {...axis, size: 52, values: tidy}],
      series: [{label: 's', value: (_, t) => t == null ? '' : t.toFixed(2)}, ...bandSeries(chart), ...chart.lines.map(series)],
      bands: chart.band ? [{series: [2, 1], fill: `${colours.estimate}30`}] : [],
      hooks: {
        drawClear: [(u) => shade(u, shades, `${colours.bad}28`)],
        setSelect: [({select, posToVal}) => {
          if (select.width > 2) onZoom(posToVal(select.left, 'x'), posToVal(select.left + select.width, 'x'));
        }],
        setCursor: [({cursor}) => { if (this.chart && (cursor.left ?? -1) < 0) this.readAt(this.t); }],
        setScale: [() => this.place()],
        setSize: [() => this.place()],
      },
    }, this.columns(chart), place);
    this.chart.over.append(this.marker);
    let down = 0;
    this.chart.over.addEventListener('pointerdown', (event) => { down = event.clientX; });
    this.chart.over.addEventListener('click', (event) => {
      if (Math.abs(event.clientX - down) < 3) onSeek(this.chart.posToVal(event.offsetX, 'x'));
    });
    this.chart.over.addEventListener('dblclick', onAll);
  }

  /** Marks the moment; the legend has its values unless the mouse asks for those of another one. */
  setTime(t: number) {
    this.t = t;
    this.place();
    if ((this.chart.cursor.left ?? -1) < 0) this.readAt(t);
  }

  /** Of the same curves as before, which may have grown. */
  setChart(chart: Chart) { this.chart.setData(this.columns(chart), false); }

  setSpan({from, to}: {from: number; to: number}) { this.chart.setScale('x', {min: from, max: Math.max(to, from + 0.1)}); }

  setWidth(width: number) { if (width > 0 && width !== this.chart.width) this.chart.setSize({width, height: HEIGHT}); }

  destroy() { this.chart.destroy(); }

  private readAt(t: number) {
    const [times] = this.chart.data;
    const row = Math.max(lastAtOrBefore(times, times.length, t), 0);
    this.chart.setLegend({idxs: this.chart.data.map((_, k) => this.rowOf(this.chart.data, k, row))}, false);
  }

  private columns(chart: Chart): uPlot.AlignedData {
    const data = table(chart);
    this.lastRows = data.map(lastRow);
    return data;
  }

  private rowOf(data: uPlot.AlignedData, k: number, row: number): number {
    return k === 0 ? row : shownRow(data[0], data[k]!, this.lastRows[k]!, row);
  }

  private place() {
    if (!this.chart) return; // uPlot calls hooks while it is made
    const x = this.chart.valToPos(this.t, 'x');
    const inside = x >= 0 && x <= this.chart.over.clientWidth;
    this.marker.style.display = inside ? '' : 'none';
    this.marker.style.transform = `translateX(${x}px)`;
  }
}

function shade(u: uPlot, shades: PlotOptions['shades'], colour: string) {
  const {left, top, width, height} = u.bbox;
  u.ctx.fillStyle = colour;
  for (const {from, to} of shades) {
    const [low, high] = [from, to].map((t) => Math.min(Math.max(u.valToPos(t, 'x', true), left), left + width));
    if (high! > low!) u.ctx.fillRect(low!, top, high! - low!, height);
  }
}

/** uPlot wants one column of times for all: undefined is no sample there, null a gap. */
function table({lines, band}: Chart): uPlot.AlignedData {
  const curves = [...(band ? [band.low, band.high] : []), ...lines.map(({curve}) => curve)];
  const tables = curves.map(({t, y}): uPlot.AlignedData => [t, Array.from(y, (value) => Number.isFinite(value) ? value : null)]);
  return tables.length === 1 ? tables[0]! : uPlot.join(tables, tables.map(([, ...columns]) => columns.map(() => 2 as const)));
}

function bandSeries({band}: Chart): uPlot.Series[] {
  if (!band) return [];
  const edge = {stroke: `${palette().estimate}70`, width: 1, points: {show: false}, value: rounded};
  return [{...edge, label: `−${band.label.slice(1)}`}, {...edge, label: `+${band.label.slice(1)}`}];
}

function series({label, style}: Line, k: number): uPlot.Series {
  const colours = palette();
  const stroke = style === 'numbered' ? numbered(k) : colours[style];
  return {label, stroke, width: style === 'command' ? 3.5 : 1.4, points: {show: false}, value: rounded};
}

const rounded = (_: uPlot, value: number | null) => value == null ? '' : tidyNumber(value);

function tidy(_: uPlot, ticks: number[]): string[] { return ticks.map((value) => String(+value.toPrecision(6))); }

function tidyNumber(value: number): string {
  const size = Math.abs(value);
  return size >= 1000 ? value.toFixed(0) : size >= 100 ? value.toFixed(1) : size >= 1 ? value.toFixed(2) : value.toFixed(3);
}
