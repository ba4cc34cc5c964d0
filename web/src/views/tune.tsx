// SPDX-License-Identifier: BSD-3-Clause
// Step responses beside the gains that they were flown with. Gains are tried, then taken or undone; a simulated flight makes its steps here.
import csv from '../../../firmware/core/parameters.csv';
import {useEffect, useMemo, useRef, useState} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import {changesIn, typed, type Edits} from '../data/edits.ts';
import {complaint, parseParameterTable, shortNumber} from '../data/parameter_table.ts';
import {tableOf, valuesAt, valuesOfMoment} from '../data/parameter_values.ts';
import {around, commandOf, MAX_BESIDE, similarBefore, stepFigures, type Step, type StepFigures} from '../data/step_response.ts';
import {AXES, responseOf, stepsOf, type Axis} from '../data/tune_axes.ts';
import {DEG_PER_RAD} from '../data/units.ts';
import * as state from '../state.ts';
import type {Chart} from './charts.ts';
import {ControlBar, hasControl} from './control.tsx';
import {Plot} from './plot.ts';
import {useTheme} from './theme.ts';

const INFOS = parseParameterTable(csv);
const BANDS = {'5 %': 0.05, '2 %': 0.02};
const MAX_S = 3;
/** Steps are made from this altitude above the origin on [m]. */
const MIN_ALTITUDE_M = 3;

export function Tune({flight}: {flight: Flight}) {
  const revision = state.revision.value;
  const [name, setName] = useState(AXES[0]!.name);
  const [band, setBand] = useState<keyof typeof BANDS>('5 %');
  const axis = AXES.find((one) => one.name === name)!;
  const now = useMemo(() => valuesAt(flight, tableOf(flight)?.length ?? 0), [flight, revision]);
  const response = useMemo(() => responseOf(flight, axis), [flight, axis, revision]);
  const steps = useMemo(() => stepsOf(flight, axis, now).map((one) => ({...one, end_s: Math.min(one.end_s, one.t + MAX_S)})), [flight, axis, revision]);
  const rows = response ? steps.map((step) => ({step, figures: stepFigures(response, step, BANDS[band]), values: valuesOfMoment(flight, step.t)})) : [];
  const last = rows.at(-1);
  return <section class="tune" aria-label="Tune">
    <p class="hint">Steps of a stick, or of the companion, that stood for 0.3 s before and 0.5 s after. Rise from 10 to 90 %; overshoot of the peak over the step;
      settled when it stays within the band, &gt; where it does not while the command stands. 100 % is the command, left what is missing at the end.</p>
    <div class="tools">
      <label>Axis <select value={name} onChange={(event) => setName(event.currentTarget.value)}>{AXES.map((one) => <option key={one.name}>{one.name}</option>)}</select></label>
      <label>Band <select value={band} onChange={(event) => setBand(event.currentTarget.value as typeof band)}>{Object.keys(BANDS).map((one) => <option key={one}>{one}</option>)}</select></label>
    </div>
    {state.control.value && <><ControlBar/><Gains key={axis.name} flight={flight} axis={axis} now={now}/></>}
    {last && response && <Responses key={axis.name} chart={chartOf(axis, last.step, similarBefore(rows.map(({step}) => step), last.step), (step) => around(response, step))}/>}
    {rows.length === 0 ? <p>No step of {axis.name.toLowerCase()} in this flight yet.</p> : <table class="steps">
      <thead><tr><th class="n">at</th><th class="n">step</th><th class="n">rise</th><th class="n">overshoot</th><th class="n">settled</th><th class="n">left</th>
        {axis.gains.map((gain) => <th class="n" key={gain}>{gain.slice(-1)}</th>)}</tr></thead>
      <tbody>{rows.toReversed().map(({step, figures, values}) => <tr key={step.t}>
        <th scope="row" class="n"><button class="link" onClick={() => state.seek(step.t)}>{step.t.toFixed(2)} s</button></th>
        <td class="n">{(step.to - step.from).toFixed(1)} {axis.unit}</td>
        <Figures figures={figures} step={step} unit={axis.unit}/>
        {axis.gains.map((gain) => <td class="n" key={gain}>{shortNumber(values.get(gain) ?? NaN)}</td>)}</tr>)}</tbody></table>}
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
function Gains({flight, axis, now}: {flight: Flight; axis: Axis; now: ReadonlyMap<string, number>}) {
  const [edits, setEdits] = useState<Edits>(new Map());
  const [before, setBefore] = useState<ReadonlyMap<string, number>>(new Map());
  const [size, setSize] = useState('10');
  const [said, setSaid] = useState('');
  const [steps, setSteps] = useState(false);
  const commands = state.commands.value;
  const {fixedWing} = flight;
  const high = -(flight.poseAt(state.time.value)?.p[2] ?? 0) >= MIN_ALTITUDE_M;
  const simulated = state.control.value!.simulated;
  const changes = changesIn(edits, now);
  const wrong = changes.map(([gain, text]) => [gain, complaint(text, INFOS.get(gain))] as const).find(([, why]) => why);
  const max = (now.get(axis.maxParameter) ?? NaN) * DEG_PER_RAD;
  const share = Number(size) / max / 2;
  const set = async (values: {name: string; value: number}[]) => {
    const ended = await commands!.set(values);
    setSaid(ended.map(({text}) => text).join('; '));
    return ended.every(({good}) => good);
  };
  const attempt = async () => {
    const old = changes.map(([gain]) => [gain, now.get(gain)!] as const);
    if (!await set(changes.map(([gain, text]) => ({name: gain, value: Number(text)})))) return;
    setBefore(new Map([...old, ...before])); // the oldest
    setEdits(new Map());
  };
  const undo = async () => { if (await set([...before].map(([gain, value]) => ({name: gain, value})))) setBefore(new Map()); };
  const step = async () => {
    const flown = async (s: number) => {
      const end = state.flight.value!.end_s + s;
      while (state.live.value === 'on' && state.flight.value!.end_s < end) await new Promise((resolve) => setTimeout(resolve, 20));
    };
    setSaid('The pilot takes the sticks');
    const keeps = (on: boolean) => fixedWing ? [] : [[`keep_altitude ${on ? 'on' : 'off'}`, 0] as const];
    const centred = [[`stick ${axis.stick} 0.5`, 0], ['switch attitude_override off', 0], ...keeps(false)] as const;
    let why = '';
    for (const [text, s] of [...keeps(true), ['switch attitude_override on', 1.5], [`stick ${axis.stick} ${0.5 + share}`, 2], [`stick ${axis.stick} 0.5`, 1.2]] as const) {
      const [moved] = await commands!.steer(text);
      if (!moved?.good) why ||= moved?.text ?? 'no answer';
      if (why) break;
      await flown(s);
    }
    for (const [text] of centred) await commands!.steer(text); // whatever happened before
    setSaid(why || 'The pilot gave the sticks back');
  };
  return <fieldset class="gains" disabled={!commands || !hasControl()}><legend>Gains</legend><div class="tools">
    {axis.gains.map((gain) => <label key={gain}>{gain} <input inputMode="decimal" value={edits.get(gain) ?? shortNumber(now.get(gain) ?? NaN)}
      aria-invalid={wrong?.[0] === gain} onInput={(event) => {
        const text = event.currentTarget.value;
        setEdits((all) => typed(all, gain, text, shortNumber(now.get(gain) ?? NaN)));
      }}/></label>)}
    <button disabled={changes.length === 0 || wrong !== undefined} onClick={() => void attempt()}>Try</button>
    <button disabled={before.size === 0} onClick={() => void undo()}>Undo</button>
    <button disabled={before.size === 0} onClick={() => {
      setBefore(new Map());
      setSaid('Taken. Parameters has the button that writes them to memory.');
    }}>Take</button></div>
    {before.size > 0 && <p class="hint">Before: {[...before].map(([gain, value]) => `${gain} ${shortNumber(value)}`).join(', ')}</p>}
    {simulated && <div class="tools"><label>Step of the stick [{axis.unit}] <input inputMode="decimal" value={size} onInput={(event) => setSize(event.currentTarget.value)}/></label>
      <button disabled={!(Math.abs(share) <= 0.5) || !high || steps} onClick={() => {
        setSteps(true);
        void step().finally(() => setSteps(false));
      }}>Step for 2 s</button>
      <span class="hint">The pilot has the sticks for 5 s{fixedWing ? '' : ' and keeps the altitude'}; the vehicle drifts meanwhile.{!high && ` From ${MIN_ALTITUDE_M} m above the take-off on.`}</span></div>}
    <p class="said" role="status">{wrong ? `${wrong[0]}: ${wrong[1]}` : said}</p>
  </fieldset>;
}
