// SPDX-License-Identifier: BSD-3-Clause
// Changes a running simulation: how it goes on, wind, faults, the pilot's transmitter, the mission. Each change is in the log with
// the step in which it entered.
import type {ComponentChildren} from 'preact';
import {useState} from 'preact/hooks';
import {FAULTS} from '../data/faults.ts';
import * as state from '../state.ts';
import {ControlBar} from './control.tsx';

type Steer = (text: string) => Promise<void>;

const SPEEDS = ['0.1', '0.25', '0.5', '1', '2', '5', '10'];
const SWITCHES = {arm: 'Arm', attitude_override: 'Attitude override', throttle_override: 'Throttle override', attitude_mode: 'Angle mode'};
const STICKS = {roll: 'Roll', pitch: 'Pitch', throttle: 'Throttle', yaw: 'Yaw'};

export function Simulation() {
  const commands = state.commands.value;
  const control = state.control.value;
  const [said, setSaid] = useState({text: '', good: true});
  if (!control?.simulated) return <p class="hint">No simulation runs here.</p>;
  const steer: Steer = async (text) => {
    const [answer] = await commands!.steer(text);
    if (answer) setSaid({text: answer.good ? `Done: ${answer.text}` : answer.text, good: answer.good});
  };
  return <section class="simulation" aria-label="Simulation">
    <ControlBar/>
    <p class={`said ${said.good ? '' : 'wrong'}`} role="status">{said.text}</p>
    <fieldset disabled={!commands || !state.hasControl()} class="steering">
      <Pace steer={steer}/><Mission steer={steer}/><Wind steer={steer}/><Faults steer={steer}/><Transmitter steer={steer}/>
    </fieldset>
  </section>;
}

const Group = ({name, children}: {name: string; children: ComponentChildren}) => <fieldset><legend>{name}</legend><div class="tools">{children}</div></fieldset>;

/** The state of the simulation that a change makes comes this much later than its answer, at most [ms]. */
const IN_FORCE_MS = 100;

function Pace({steer}: {steer: Steer}) {
  const {paused, speed} = state.control.value!;
  const [chosen, setChosen] = useState<string>(); // until it is in force: what comes from the server meanwhile is older
  const speeds = SPEEDS.includes(String(speed)) ? SPEEDS : [...SPEEDS, String(speed)];
  const choose = async (one: string) => {
    setChosen(one);
    await steer(`speed ${one}`);
    setTimeout(() => setChosen((now) => now === one ? undefined : now), IN_FORCE_MS);
  };
  return <Group name="Time">
    <button onClick={() => void steer(paused ? 'resume' : 'pause')}>{paused ? 'Resume' : 'Pause'}</button>
    <button onClick={() => void steer('step 4')}>Step 10 ms</button>
    <button onClick={() => void steer('step 400')}>Step 1 s</button>
    <label>Speed of the simulation <select value={chosen ?? String(speed)} onChange={(event) => void choose(event.currentTarget.value)}>
      {speeds.map((one) => <option key={one} value={one}>{one}×</option>)}</select></label>
    {paused && <span class="badge warning">paused</span>}
  </Group>;
}

function Mission({steer}: {steer: Steer}) {
  const [mission, setMission] = useState('');
  return <Group name="Mission">
    <button onClick={() => void steer('hold on')}>Hold before arming</button>
    <button onClick={() => void steer('hold off')}>Let the pilot arm</button>
    <button onClick={() => void steer('land')}>Land</button>
    <button onClick={() => void steer('return')}>Return and land</button>
    <label>Next mission <input value={mission} placeholder="the same" onInput={(event) => setMission(event.currentTarget.value)}/></label>
    <button onClick={() => void steer(`reset ${mission}`.trim())}>Reset</button>
  </Group>;
}

const Amount = ({name, unit, value, set}: {name: string; unit: string; value: string; set: (value: string) => void}) =>
  <label>{name} <input class="short" inputMode="decimal" value={value} onInput={(event) => set(event.currentTarget.value)}/> {unit}</label>;

function Wind({steer}: {steer: Steer}) {
  const [speed, setSpeed] = useState('5');
  const [from, setFrom] = useState('270');
  const [w20, setW20] = useState('0');
  const [seconds, setSeconds] = useState('3');
  return <Group name="Wind">
    <Amount name="Wind speed" unit="m/s" value={speed} set={setSpeed}/>
    <Amount name="From" unit="°" value={from} set={setFrom}/>
    <Amount name="Turbulence, W20" unit="m/s" value={w20} set={setW20}/>
    <button onClick={() => void steer(`wind ${speed},${from},${w20}`)}>Set wind</button>
    <Amount name="Gust lasts" unit="s" value={seconds} set={setSeconds}/>
    <button onClick={() => void steer(`gust ${speed},${from},${seconds}`)}>One gust</button>
  </Group>;
}

function Faults({steer}: {steer: Steer}) {
  const [name, setName] = useState(FAULTS[0]!.name);
  const [value, setValue] = useState('');
  const [number, setNumber] = useState('0');
  const [seconds, setSeconds] = useState('');
  const fault = FAULTS.find((one) => one.name === name)!;
  const what = fault.name.replace(/N(?=_)/, number).replace(/=.*/, `=${value}`) + (seconds.trim() === '' ? '' : `:${seconds}`);
  return <Group name="Faults">
    <label>Fault <select value={name} onChange={(event) => setName(event.currentTarget.value)}>
      {FAULTS.map((one) => <option key={one.name} value={one.name}>{one.name}</option>)}</select></label>
    {/N_/.test(fault.name) && <Amount name="Number N" unit="" value={number} set={setNumber}/>}
    {fault.name.includes('=') && <Amount name="Size" unit="" value={value} set={setValue}/>}
    <Amount name="For" unit="s, empty: to the end" value={seconds} set={setSeconds}/>
    <button onClick={() => void steer(`fault ${what}`)}>Begin fault</button>
    <button onClick={() => void steer('heal')}>End all faults</button>
    <span class="hint">{fault.effect}</span>
  </Group>;
}

function Transmitter({steer}: {steer: Steer}) {
  return <Group name="Pilot">
    {Object.entries(SWITCHES).map(([name, label]) => <span key={name} class="pair">{label}
      <button aria-label={`${label} on`} onClick={() => void steer(`switch ${name} on`)}>on</button>
      <button aria-label={`${label} off`} onClick={() => void steer(`switch ${name} off`)}>off</button></span>)}
    {Object.entries(STICKS).map(([name, label]) => <label key={name}>{label} <input type="range" min={0} max={1} step={0.01}
      defaultValue={name === 'throttle' ? '0' : '0.5'} aria-label={`Stick ${name}`} onChange={(event) => void steer(`stick ${name} ${event.currentTarget.value}`)}/></label>)}
  </Group>;
}
