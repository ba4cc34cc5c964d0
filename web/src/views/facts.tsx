// SPDX-License-Identifier: BSD-3-Clause
// What the flight was and how it went: facts of the log, and those of summary.json where the folder has one.
import type {Flight} from '../data/flight.ts';
import * as state from '../state.ts';

interface Waypoint { reached: boolean; measure: string; truth_distance_m: number | null; estimate_distance_m: number | null; time_s: number | null }

export function Facts({flight}: {flight: Flight}) {
  const summary = state.summary.value;
  const waypoints = (summary?.['waypoints'] ?? []) as Waypoint[];
  return <section class="facts" aria-label="Facts">
    {summary && <p class={`verdict ${summary['success'] ? 'good' : 'bad'}`}>
      <strong>{summary['success'] ? '✓ Success' : '✗ Failed'}</strong> <span>{String(summary['verdict'])}</span></p>}
    <table><tbody>
      {[...flight.facts].filter(([, value]) => value !== '').map(([name, value]) => <Row key={name} name={name} value={value}/>)}
      {summary && FIGURES.map(([key, name, unit]) => typeof summary[key] === 'number'
        && <Row key={key} name={name} value={`${+summary[key].toFixed(3)} ${unit}`}/>)}
      {flight.analysis && <tr><th scope="row">to fly it again</th><td class="wrap"><code>{flight.analysis.command_line}</code></td></tr>}
      {typeof summary?.['log_sha256'] === 'string' && <Row name="identity of the log" value={summary['log_sha256']}/>}
    </tbody></table>
    {waypoints.length > 0 && <WaypointTable waypoints={waypoints} radius_m={Number(summary?.['score_radius_m'])}/>}
    <h2>{state.extract.value ? 'Contents of this page' : 'Contents of the log'}</h2>
    <table><thead><tr><th>topic</th><th>type</th><th class="n">messages</th></tr></thead>
      <tbody>{[...flight.tables].map(([topic, table]) =>
        <tr key={topic}><td class="mono">{topic}</td><td class="mono">{table.type.name}</td><td class="n">{table.length}</td></tr>)}</tbody></table>
  </section>;
}

const FIGURES: [key: string, name: string, unit: string][] = [
  ['sim_time_s', 'simulated time', 's'], ['flight_time_s', 'flight time', 's'], ['tracking_rms_m', 'tracking error, rms', 'm'],
  ['tracking_max_m', 'tracking error, largest', 'm'], ['own_tracking_rms_m', 'across ground, less GNSS drift, rms', 'm'],
  ['straight_rms_m', 'cross-track on straights, rms', 'm'], ['arc_rms_m', 'cross-track on arcs, rms', 'm'],
  ['height_rms_m', 'height, rms', 'm'], ['airspeed_rms_m_s', 'airspeed, rms', 'm/s'],
  ['touchdown_speed_m_s', 'touchdown speed', 'm/s'], ['touchdown_distance_m', 'touchdown from the aim', 'm'],
  ['gyro_latency_ms', 'delay of the gyro filters', 'ms'], ['warnings', 'warnings', ''], ['errors', 'errors', ''],
  ['frames_dropped', 'frames lost by the cable', ''],
];

function Row({name, value}: {name: string; value: string}) {
  return <tr><th scope="row">{name.replace('_', ' ')}</th><td class="wrap">{value}</td></tr>;
}

function WaypointTable({waypoints, radius_m}: {waypoints: Waypoint[]; radius_m: number}) {
  const cell = (value: number | null, digits: number) => value === null ? '–' : value.toFixed(digits);
  return <>
    <h2>Waypoints</h2>
    <p class="hint">Within {radius_m} m in truth counts as reached.</p>
    <table><thead><tr><th class="n">#</th><th class="n">passed, s</th><th class="n">in truth, m</th><th class="n">by the estimate, m</th><th>measured to</th></tr></thead>
      <tbody>{waypoints.map(({reached, measure, truth_distance_m, estimate_distance_m, time_s}, k) => <tr key={k}>
        <td class="n">{k + 1}</td>
        <td class="n">{reached && time_s !== null ? <button class="link" onClick={() => state.seek(time_s)}>{time_s.toFixed(1)}</button>
          : <span class="badge bad">missed</span>}</td>
        <td class="n">{cell(truth_distance_m, 2)}</td><td class="n">{cell(estimate_distance_m, 2)}</td><td>{measure}</td>
      </tr>)}</tbody></table>
  </>;
}
