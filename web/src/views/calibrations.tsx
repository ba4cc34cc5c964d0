// SPDX-License-Identifier: BSD-3-Clause
// Calibrations as jobs: each ends with the figures of its quality, or with the one that is beyond its limit. Those that a person does
// say what to do, line by line.
import {useState} from 'preact/hooks';
import type {Result} from '../data/commands.ts';
import {calibrationLines} from '../data/calibration_lines.ts';
import type {Flight} from '../data/flight.ts';
import * as state from '../state.ts';

const SENSORS = {gyro: 'Gyro', accel: 'Accelerometer', baro: 'Barometer', airspeed: 'Airspeed'};
/** With the vehicle or the transmitter in the hands of a person. */
const BY_HAND = {mag: 'Magnetometer', rc: 'Receiver', esc_props_off: 'Speed controllers'};
const HOW: Record<string, string> = {gyro: 'at rest', accel: 'at rest and level', baro: 'at rest, without wind', airspeed: 'pitot tube covered',
  mag: 'turn the vehicle onto each of its six faces', rc: 'move the sticks to all their ends, then release them',
  esc_props_off: 'both ends of the throttle go to all motors; the transmitter arms'};

export function Calibrations({flight}: {flight: Flight}) {
  void state.revision.value;
  const [noProps, setNoProps] = useState(false);
  const [runs, setRuns] = useState('');
  const [results, setResults] = useState<ReadonlyMap<string, Result | undefined>>(new Map());
  const calibrate = async (sensor: string) => {
    const put = (result: Result | undefined) => setResults((before) => new Map([...before, [sensor, result]]));
    put(undefined);
    if (sensor in BY_HAND) setRuns(sensor);
    put((await state.commands.value!.calibrate(sensor))[0]);
    if (sensor in BY_HAND) setRuns('');
  };
  const lines = calibrationLines(flight);
  return <section class="calibrations" aria-label="Calibrations">
    <h2>Calibrations</h2>
    <table><tbody>{Object.entries({...SENSORS, ...state.control.value?.simulated ? {} : BY_HAND}).map(([sensor, name]) => {
      const result = results.get(sensor);
      const measures = results.has(sensor) && !result;
      const byHand = sensor in BY_HAND;
      return <tr key={sensor}>
        <th scope="row">{name}</th><td><button aria-label={`Calibrate ${name.toLowerCase()}`} disabled={!state.hasControl() || measures || runs !== '' || sensor === 'esc_props_off' && !noProps}
          onClick={() => void calibrate(sensor)}>Calibrate</button>{byHand && measures && <button onClick={() => void state.commands.value?.calibrate('stop')}>Stop</button>}</td>
        <td role="status">{measures ? byHand ? lines.at(-1) ?? 'begins' : 'measuring' : result ? <span class={`result ${result.good ? 'good' : 'bad'}`}>{result.good ? '✓' : '✗'} {result.text}</span>
          : <span class="hint">{HOW[sensor]}</span>}
          {sensor === 'esc_props_off' && <label><input type="checkbox" checked={noProps} onChange={(event) => setNoProps(event.currentTarget.checked)}/> Propellers are off</label>}</td></tr>;
    })}</tbody></table>
    {lines.length > 0 && <ol class="calibration-lines" aria-label="Steps of the calibration">{lines.map((line, k) => <li key={k}>{line}</li>)}</ol>}
    <p class="hint">They last until the next restart unless the parameters are written to memory.</p>
  </section>;
}
