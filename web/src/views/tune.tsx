// SPDX-License-Identifier: BSD-3-Clause
// Step responses beside the gains that they were flown with. Gains are tried, then taken or undone; a simulated flight makes its steps here.
import autonomyKeys from '../../../docs/autonomy-keys.md';
import csv from '../../../firmware/core/parameters.csv';
import {useEffect, useMemo, useRef, useState} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import type {Result} from '../data/commands.ts';
import {changesIn, typed, type Edits} from '../data/edits.ts';
import {complaint, parseParameterTable, shortNumber} from '../data/parameter_table.ts';
import {tableOf, valuesAt, valuesOfMoment} from '../data/parameter_values.ts';
import {around, commandOf, MAX_BESIDE, similarBefore, stepFigures, type Step, type StepFigures} from '../data/step_response.ts';
import {parseKeyPage, parseSettings, settingsAt} from '../data/settings.ts';
import {axesOf, responseOf, stepsOf, type Axis, type Stick} from '../data/tune_axes.ts';
import {DEG_PER_RAD} from '../data/units.ts';
import * as state from '../state.ts';
import type {Chart} from './charts.ts';
import {ControlBar} from './control.tsx';
import {Plot} from './plot.ts';
import {useTheme} from './theme.ts';

const INFOS = parseParameterTable(csv);
const BANDS = {'5 %': 0.05, '2 %': 0.02};
/** Steps are made from this altitude above the origin on [m]. */
const MIN_ALTITUDE_M = 3;
const AUTONOMY = 'autonomy.';
const STANDARDS = new Map(parseKeyPage(autonomyKeys, 'multirotor').map(({key, standard}) => [key, standard]));

/** Gains in force at `t`. */
function gainsAt(flight: Flight, axis: Axis, t: number): ReadonlyMap<string, number> {
  if (axis.stick) return valuesOfMoment(flight, t);
  const given = parseSettings(settingsAt(flight, t));
  return new Map(axis.gains.map((gain) => [gain, Number(given.get(AUTONOMY + gain) ?? STANDARDS.get(AUTONOMY + gain))]));
}
/** P, I or D. */
const partOf = (gain: string) => /\.k([pid])_/.exec(gain)?.[1]!.toUpperCase() ?? gain.slice(-1);

export function Tune({flight}: {flight: Flight}) {
  const revision = state.revision.value;
  const axes = axesOf(flight);
  const [name, setName] = useState(axes[0]!.name);
  const [band, setBand] = useState<keyof typeof BANDS>('5 %');
  const axis = axes.find((one) => one.name === name) ?? axes[0]!;
  const now = useMemo(() => valuesAt(flight, tableOf(flight)?.length ?? 0), [flight, revision]);
  const response = useMemo(() => responseOf(flight, axis), [flight, axis, revision]);
  const steps = useMemo(() => stepsOf(flight, axis, now).map((one) => ({...one, end_s: Math.min(one.end_s, one.t + axis.shown_s)})), [flight, axis, revision]);
  const rows = response ? steps.map((step) => ({step, figures: stepFigures(response, step, BANDS[band]), values: gainsAt(flight, axis, step.t)})) : [];
  const last = rows.at(-1);
  return <section class="tune" aria-label="Tune">
    <p class="hint">Steps of a stick, of the companion, or of the altitude of its path, that stood for 0.3 s before and 0.5 s after. Rise from 10 to 90 %; overshoot of the peak over the step;
      settled when it stays within the band, &gt; where it does not while the command stands. 100 % is the command, left what is missing at the end.</p>
    <div class="tools">
      <label>Axis <select value={name} onChange={(event) => setName(event.currentTarget.value)}>{axes.map((one) => <option key={one.name}>{one.name}</option>)}</select></label>
      <label>Band <select value={band} onChange={(event) => setBand(event.currentTarget.value as typeof band)}>{Object.keys(BANDS).map((one) => <option key={one}>{one}</option>)}</select></label>
    </div>
    {state.control.value && <><ControlBar/><Gains key={axis.name} flight={flight} axis={axis} parameters={now}/></>}
    {last && response && <Responses key={axis.name} chart={chartOf(axis, last.step, similarBefore(rows.map(({step}) => step), last.step), (step) => around(response, step))}/>}
    {rows.length === 0 ? <p>No step of {axis.name.toLowerCase()} in this flight yet.</p> : <div class="wide"><table class="steps">
      <thead><tr><th class="n">at</th><th class="n">step</th><th class="n">rise</th><th class="n">overshoot</th><th class="n">settled</th><th class="n">left</th>
        {axis.gains.map((gain) => <th class="n" key={gain}>{partOf(gain)}</th>)}</tr></thead>
      <tbody>{rows.toReversed().map(({step, figures, values}) => <tr key={step.t}>
        <th scope="row" class="n"><button class="link" onClick={() => state.seek(step.t)}>{step.t.toFixed(2)} s</button></th>
        <td class="n">{(step.to - step.from).toFixed(1)} {axis.unit}</td>
        <Figures figures={figures} step={step} unit={axis.unit}/>
        {axis.gains.map((gain) => <td class="n" key={gain}>{shortNumber(values.get(gain) ?? NaN)}</td>)}</tr>)}</tbody></table></div>}
  </section>;
}

function Figures({figures, step, unit}: {figures: StepFigures | undefined; step: Step; unit: string}) {
  if (!figures) return <td class="n" colSpan={4}>samples are missing</td>;
  if (figures.beside > MAX_BESIDE) return <td class="n" colSpan={4}>began {(figures.beside * Math.abs(step.to - step.from)).toFixed(1)} {unit} beside the command</td>;
  return <><td class="n">{seconds(figures.rise_s, step)}</td><td class="n">{percent(figures.overshoot)}</td>
    <td class="n">{seconds(figures.settling_s, step)}</td><td class="n">{percent(figures.left)}</td></>;
}

const percent = (share: number) => `${(100 * share).toFixed(1)} %`;
const seconds = (value: number, {t, end_s}: Step) => Number.isFinite(value) ? `${value.toFixed(3)} s` : `> ${(end_s - t).toFixed(1)} s`;

function chartOf(axis: Axis, last: Step, before: Step | undefined, cut: (step: Step) => Chart['lines'][number]['curve']): Chart {
  return {title: `${axis.name} after the step`, unit: axis.unit, lines: [
    {label: 'command', style: 'command', curve: commandOf(last)},
    ...(before ? [{label: 'such a step before', style: 'estimate' as const, curve: cut(before)}] : []),
    {label: 'measured', style: 'actual', curve: cut(last)}]};
}

function Responses({chart}: {chart: Chart}) {
  const place = useRef<HTMLDivElement>(null);
  const theme = useTheme();
  const key = chart.lines.map(({curve}) => `${curve.t.length} ${curve.y.at(-1)}`).join();
  useEffect(() => {
    const span = {from: chart.lines[0]!.curve.t[0]!, to: chart.lines[0]!.curve.t.at(-1)!};
    const plot = new Plot(place.current!, chart, {shades: [], onSeek: () => {}, onZoom: (from, to) => plot.setSpan({from, to}), onAll: () => plot.setSpan(span)});
    plot.setSpan(span);
    plot.setTime(span.to);
    const sized = new ResizeObserver(() => plot.setWidth(place.current!.clientWidth));
    sized.observe(place.current!);
    return () => {
      sized.disconnect();
      plot.destroy();
    };
  }, [key, theme]);
  return <figure><figcaption>{chart.title} <span class="unit">{chart.unit}</span></figcaption><div class="plot" ref={place}/></figure>;
}

/** What was tried is kept beside what was before, until it is taken or undone. */
function Gains({flight, axis, parameters}: {flight: Flight; axis: Axis; parameters: ReadonlyMap<string, number>}) {
  const [edits, setEdits] = useState<Edits>(new Map());
  const [before, setBefore] = useState<ReadonlyMap<string, number>>(new Map());
  const [said, setSaid] = useState('');
  const commands = state.commands.value;
  const {stick} = axis;
  const now = stick ? parameters : gainsAt(flight, axis, Infinity);
  const changes = changesIn(edits, now);
  const wrong = changes.map(([gain, text]) => [gain, complaint(text, INFOS.get(gain))] as const).find(([, why]) => why);
  const set = async (values: {name: string; value: number}[]) => {
    const ended = stick ? await commands!.set(values) : await tuned(values);
    setSaid(ended.map(({text}) => text).join('; '));
    return ended.every(({good}) => good);
  };
  /** One after the other, until one is refused. */
  const tuned = async (values: {name: string; value: number}[]) => {
    const ended: Result[] = [];
    for (const {name, value} of values) {
      const [result] = await commands!.steer(`tune ${name} ${value}`);
      if (result) ended.push(result.good ? {...result, text: `set to ${value}`} : result);
      if (!result?.good) break;
    }
    return ended;
  };
  const attempt = async () => {
    const old = changes.map(([gain]) => [gain, now.get(gain)!] as const);
    if (!await set(changes.map(([gain, text]) => ({name: gain, value: Number(text)})))) return;
    setBefore(new Map([...old, ...before])); // the oldest
    setEdits(new Map());
  };
  const undo = async () => { if (await set([...before].map(([gain, value]) => ({name: gain, value})))) setBefore(new Map()); };
  return <fieldset class="gains" disabled={!commands || !state.hasControl()}><legend>Gains</legend><div class="tools">
    {axis.gains.map((gain) => <label key={gain}>{gain} <input inputMode="decimal" value={edits.get(gain) ?? shortNumber(now.get(gain) ?? NaN)}
      aria-invalid={wrong?.[0] === gain} onInput={(event) => {
        const text = event.currentTarget.value;
        setEdits((all) => typed(all, gain, text, shortNumber(now.get(gain) ?? NaN)));
      }}/></label>)}
    <button disabled={changes.length === 0 || wrong !== undefined} onClick={() => void attempt()}>Try</button>
    <button disabled={before.size === 0} onClick={() => void undo()}>Undo</button>
    <button disabled={before.size === 0} onClick={() => {
      setBefore(new Map());
      setSaid(stick ? 'Taken. Parameters has the button that writes them to memory.' : 'Taken for this flight. A next one has what its vehicle file says.');
    }}>Take</button></div>
    {before.size > 0 && <p class="hint">Before: {[...before].map(([gain, value]) => `${gain} ${shortNumber(value)}`).join(', ')}</p>}
    {state.control.value!.simulated && <StepButton flight={flight} axis={axis} parameters={parameters} say={setSaid}/>}
    <p class="said" role="status">{wrong ? `${wrong[0]}: ${wrong[1]}` : said}</p>
  </fieldset>;
}

/** Texts of flight/steering.hpp, each with how long the flight then goes on [s]. */
type Move = readonly [text: string, s: number];

/** A step of a stick and back; `end` is done whatever happened before. */
function movesOfStick(stick: Stick, share: number, fixedWing: boolean): {moves: readonly Move[]; end: readonly string[]} {
  const keeps = (on: boolean) => fixedWing ? [] : [`keep_altitude ${on ? 'on' : 'off'}`];
  return {
    moves: [...keeps(true).map((text) => [text, 0] as const), ['switch attitude_override on', 1.5], [`stick ${stick.name} ${0.5 + share}`, 2], [`stick ${stick.name} 0.5`, 1.2]],
    end: [`stick ${stick.name} 0.5`, 'switch attitude_override off', ...keeps(false)],
  };
}

const MAX_OFFSET_M = 3; // flight/steering.cpp
const ALTITUDE_S = 5; // of the offset, and again without it: a slow answer has settled by then
const movesOfAltitude = (size: number): {moves: readonly Move[]; end: readonly string[]} =>
  ({moves: [[`altitude_offset ${size}`, ALTITUDE_S], ['altitude_offset 0', ALTITUDE_S]], end: ['altitude_offset 0']});

/** Makes steps in a simulated flight. */
function StepButton({flight, axis, parameters, say}: {flight: Flight; axis: Axis; parameters: ReadonlyMap<string, number>; say: (text: string) => void}) {
  const {stick, unit} = axis;
  const {fixedWing} = flight;
  const [size, setSize] = useState(stick ? '10' : '1');
  const [steps, setSteps] = useState(false);
  const altitude_m = -(flight.poseAt(state.time.value)?.p[2] ?? 0);
  const high = altitude_m + Math.min(stick ? 0 : Number(size), 0) >= MIN_ALTITUDE_M;
  const share = Number(size) / ((parameters.get(stick?.maxParameter ?? '') ?? NaN) * DEG_PER_RAD) / 2;
  const possible = size.trim() !== '' && (stick ? Math.abs(share) <= 0.5 : Math.abs(Number(size)) <= MAX_OFFSET_M);
  const step = async () => {
    const commands = state.commands.value!;
    const {moves, end} = stick ? movesOfStick(stick, share, fixedWing) : movesOfAltitude(Number(size));
    say(stick ? 'The pilot takes the sticks' : 'The mission is flown at another altitude');
    let why = '';
    for (const [text, s] of moves) {
      const [moved] = await commands.steer(text);
      if (!moved?.good) why ||= moved?.text ?? 'no answer';
      if (why) break;
      const until = state.flight.value!.end_s + s;
      while (state.live.value === 'on' && state.flight.value!.end_s < until) await new Promise((resolve) => setTimeout(resolve, 20));
    }
    for (const text of end) await commands.steer(text);
    say(why || (stick ? 'The pilot gave the sticks back' : 'The mission is flown as it is'));
  };
  return <div class="tools"><label>Step of the {stick ? 'stick' : 'altitude'} [{unit}] <input inputMode="decimal" value={size} onInput={(event) => setSize(event.currentTarget.value)}/></label>
    <button disabled={!possible || !high || steps} onClick={() => {
      setSteps(true);
      void step().finally(() => setSteps(false));
    }}>Step for {stick ? 2 : ALTITUDE_S} s</button>
    <span class="hint">{stick ? `The pilot has the sticks for 5 s${fixedWing ? '' : ' and keeps the altitude'}; the vehicle drifts meanwhile.`
      : 'While the vehicle follows its path. A path that stands still shows the step alone.'}{!high && ` From ${MIN_ALTITUDE_M} m above the take-off on.`}</span></div>;
}
