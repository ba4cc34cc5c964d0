// SPDX-License-Identifier: BSD-3-Clause
// What the firmware counted, and what its filters do to the gyro.
import {useEffect, useRef} from 'preact/hooks';
import uPlot from 'uplot';
import type {GyroSpectrum} from '../data/analysis.ts';
import type {Flight} from '../data/flight.ts';
import {linkQualityAt, WAIT_S, WINDOW_S} from '../data/link_quality.ts';
import {DEG_PER_RAD} from '../data/units.ts';
import {palette} from '../scene/palette.ts';
import * as state from '../state.ts';
import {useTheme} from './theme.ts';

const COUNTERS = '/link/counters';
const NAMES: [field: string, name: string][] = [
  ['passes', 'Passes of the main loop'], ['longest_pass', 'Longest pass, µs'], ['pass_budget', 'Budget of a pass, µs'],
  ['passes_over_budget', 'Passes over the budget'], ['frames_dropped', 'Frames received and not understood'],
  ['tx_dropped', 'Frames not sent for want of room'], ['texts_lost', 'Texts lost'],
];
/** Bins of the firmware's histogram of late and early samples, core::PassCounters. */
const JITTER = ['below 10 µs', '10 to 30 µs', '30 to 100 µs', '100 to 300 µs', '300 to 1000 µs', '1000 to 3000 µs', '3000 to 10000 µs',
  '10000 µs and more'];
const REJECTED = ['not a number, or no measurement', 'IMU: timestamp moved backwards', 'IMU: stamp far from its arrival', 'IMU: stuck',
  'pressure out of range', 'other sensor out of range', 'external attitude rejected', 'gyro clipped, used'];

export function Firmware({flight}: {flight: Flight}) {
  const gyro = flight.analysis?.gyro;
  const counted = flight.tables.get(COUNTERS);
  const at = (field: string) => flight.latest(COUNTERS, field, state.time.value);
  const first = counted && counted.length > 0 ? counted.times[0]! : Infinity;
  return <section class="firmware" aria-label="Firmware">
    {gyro && gyro.frequency_Hz.length > 0 && <Spectrum gyro={gyro}/>}
    <Link flight={flight}/>
    {!counted ? <p class="hint">The log has no counters of the firmware.</p>
      : state.time.value < first ? <p class="hint">The firmware first reports its counters after {first.toFixed(1)} s.</p> : <>
        <h2>Counters at the moment shown</h2>
        <table><tbody>{NAMES.map(([field, name]) => <Row key={field} name={name} value={at(field)}/>)}</tbody></table>
        <h2>IMU sample late or early</h2>
        <Bins names={JITTER} value={(k) => at(`imu_jitter[${k}]`)}/>
        <h2>Rejected samples</h2>
        <Bins names={REJECTED} value={(k) => at(`rejected[${k}]`)}/>
      </>}
  </section>;
}

/** The companion asks for the firmware's time ten times a second. */
function Link({flight}: {flight: Flight}) {
  const link = linkQualityAt(flight, state.time.value);
  if (!link) return null;
  return <section aria-label="Link">
    <h2>Link to the firmware: {link.state}</h2>
    <table><tbody>
      <Row name={`Time requests in ${WINDOW_S} s`} value={link.requests}/>
      <Row name={`Not answered within ${WAIT_S} s`} value={link.unanswered}/>
      <Row name="Round trip of the last answer, ms" value={+link.roundTrip_ms.toFixed(1)}/>
      <Row name="Age of the last answer, s" value={+link.age_s.toFixed(1)}/>
    </tbody></table>
  </section>;
}

function Row({name, value}: {name: string; value: number}) {
  return <tr><th scope="row">{name}</th><td class="n">{Number.isFinite(value) ? value : '–'}</td></tr>;
}

function Bins({names, value}: {names: string[]; value: (k: number) => number}) {
  return <table><tbody>{names.map((name, k) => <Row key={name} name={name} value={value(k)}/>)}</tbody></table>;
}

function Spectrum({gyro}: {gyro: GyroSpectrum}) {
  const place = useRef<HTMLDivElement>(null);
  const theme = useTheme();
  useEffect(() => {
    const element = place.current!;
    const colours = palette();
    const axis = {stroke: colours.faint, grid: {stroke: colours.grid, width: 1}, ticks: {show: false}, font: '11px system-ui, sans-serif'};
    const value = (_: uPlot, y: number | null) => y == null ? '' : y.toPrecision(3);
    const density = (values: number[]) => values.map((y) => y > 0 ? y * DEG_PER_RAD : null);
    const plot = new uPlot({
      width: element.clientWidth, height: 170, scales: {x: {time: false}, y: {distr: 3}},
      axes: [{...axis, size: 24}, {...axis, size: 52}],
      series: [{label: 'Hz'}, {label: 'sensor', stroke: colours.command, width: 3.5, points: {show: false}, value},
        {label: 'to the controller', stroke: colours.actual, width: 1.4, points: {show: false}, value}],
    }, [gyro.frequency_Hz, density(gyro.sensor_rad_s_rtHz), density(gyro.controller_rad_s_rtHz)], element);
    return () => plot.destroy();
  }, [gyro, theme]);
  return <figure>
    <figcaption>Gyro, density by frequency <span class="unit">°/s per √Hz over Hz</span></figcaption>
    <p class="hint">In the air, three axes together.{gyro.latency_s !== null
      && ` The filters delay slow motion by ${(1000 * gyro.latency_s).toFixed(2)} ms.`}</p>
    <div class="plot" ref={place}/>
  </figure>;
}
