// SPDX-License-Identifier: BSD-3-Clause
// Calibrations of a vehicle at rest, as jobs: each ends with the figures of its quality, or with the one that is beyond its limit.
import {useState} from 'preact/hooks';
import type {Result} from '../data/commands.ts';
import * as state from '../state.ts';
import {hasControl} from './control.tsx';

const SENSORS = {gyro: 'Gyro', accel: 'Accelerometer', baro: 'Barometer', airspeed: 'Airspeed'};
const HOW: Record<string, string> = {gyro: 'at rest', accel: 'at rest and level', baro: 'at rest, without wind', airspeed: 'pitot tube covered'};

export function Calibrations() {
  const [results, setResults] = useState<ReadonlyMap<string, Result | undefined>>(new Map());
  const calibrate = async (sensor: string) => {
    const put = (result: Result | undefined) => setResults((before) => new Map([...before, [sensor, result]]));
    put(undefined);
    put((await state.commands.value!.calibrate(sensor))[0]);
  };
  return <section class="calibrations" aria-label="Calibrations">
    <h2>Calibrations</h2>
    <table><tbody>{Object.entries(SENSORS).map(([sensor, name]) => {
      const result = results.get(sensor);
      const runs = results.has(sensor) && !result;
      return <tr key={sensor}>
        <th scope="row">{name}</th><td><button aria-label={`Calibrate ${name.toLowerCase()}`} disabled={!hasControl() || runs}
          onClick={() => void calibrate(sensor)}>Calibrate</button></td>
        <td role="status">{runs ? 'measuring' : result ? <span class={`result ${result.good ? 'good' : 'bad'}`}>{result.good ? '✓' : '✗'} {result.text}</span>
          : <span class="hint">{HOW[sensor]}</span>}</td></tr>;
    })}</tbody></table>
    <p class="hint">They last until the next restart unless the parameters are written to memory. Magnetometer, receiver and speed controllers:{' '}
      <code>./rosflight calibrate LINK</code>.</p>
  </section>;
}
