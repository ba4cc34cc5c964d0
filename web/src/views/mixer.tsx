// SPDX-License-Identifier: BSD-3-Clause
// The airframe as the firmware's mixer has it, from above: where each motor is, which way it yaws, its shares and its output.
import type {Flight} from '../data/flight.ts';
import {mixedOutputs, placeOf} from '../data/mixer.ts';
import * as state from '../state.ts';

const ARM = 70;
const ROTOR = 24;

export function Mixer({flight, values}: {flight: Flight; values: ReadonlyMap<string, number>}) {
  const outputs = mixedOutputs(values);
  if (outputs.length === 0) return <><h2>Mixer</h2><p class="hint">The parameters of the mixer are not known.</p></>;
  const motors = outputs.filter(({isMotor}) => isMotor);
  // A fixed wing pulls ahead and has no thrust upwards.
  const columns = (['thrust', 'ahead', 'roll', 'pitch', 'yaw'] as const).filter((name) => !['thrust', 'ahead'].includes(name) || outputs.some((one) => one[name] !== 0));
  const now = (k: number) => flight.latest('/output_raw', `values[${k}]`, state.time.value);
  const percent = (value: number) => Number.isFinite(value) ? `${(100 * value).toFixed(0)} %` : '–';
  return <section class="mixer" aria-label="Mixer">
    <h2>Mixer</h2>
    <div class="mixer-row">
      {motors.length > 1 && <svg viewBox="-110 -110 220 220" role="img" aria-label={`Airframe from above, ${motors.length} motors`}>
        <path class="nose" d="M0 -26l-8 14h16z"/>
        {motors.map((motor) => {
          const {front, right} = placeOf(motor, motors);
          const [x, y] = [ARM * right, -ARM * front];
          const output = Math.min(Math.max(now(motor.output) || 0, 0), 1);
          return <g key={motor.output} class="motor" data-output={motor.output}>
            <path class="arm" d={`M0 0L${x} ${y}`}/>
            <circle class="disc" cx={x} cy={y} r={ROTOR}/>
            <circle class="turning" cx={x} cy={y} r={ROTOR * Math.sqrt(output)}/>
            <text x={x} y={y + 4}>{motor.output} {motor.yaw > 0 ? '↻' : motor.yaw < 0 ? '↺' : ''}</text>
          </g>;
        })}
      </svg>}
      <table><thead><tr><th>output</th>{columns.map((name) => <th key={name} class="n">{name === 'ahead' ? 'thrust ahead' : name}</th>)}<th class="n">now</th></tr></thead>
        <tbody>{outputs.map((one) => <tr key={one.output}><th scope="row">{one.output} {one.isMotor ? 'motor' : 'servo'}</th>
          {columns.map((name) => <td key={name} class="n">{one[name].toFixed(2)}</td>)}
          <td class="n">{percent(now(one.output))}</td></tr>)}</tbody></table>
    </div>
    <p class="hint">Shares are those of the firmware's mixer; ↻ and ↺: its torque turns the nose right or left. Discs fill with the output.</p>
  </section>;
}
