// SPDX-License-Identifier: BSD-3-Clause
// What autonomy and the simulated vehicle have of the vehicle file at the moment shown. Autonomy's can be changed in a running flight.
import autonomyKeys from '../../../docs/autonomy-keys.md';
import vehicleKeys from '../../../docs/vehicle-keys.md';
import {useMemo, useState} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import type {Result} from '../data/commands.ts';
import {parseKeyPage, parseSettings, perEntry, settingsAt, type SettingInfo} from '../data/settings.ts';
import {typed, type Edits} from '../data/edits.ts';
import * as state from '../state.ts';
import {ControlBar} from './control.tsx';

const AUTONOMY = 'autonomy.';
const GROUP_PARTS = 2; // of a key of autonomy: autonomy.limits; of the vehicle: 1
const groupOf = (key: string) => key.split('.').slice(0, key.startsWith(AUTONOMY) ? GROUP_PARTS : 1).join('.');
/** Those of the estimator are read once, as a flight begins. */
const changesInFlight = (key: string) => key.startsWith(AUTONOMY) && !key.startsWith('autonomy.estimator.');

export function Settings({flight, of}: {flight: Flight; of: 'autonomy' | 'vehicle'}) {
  void state.revision.value; // a growing flight
  const yaml = settingsAt(flight, state.following.value ? Infinity : state.time.value);
  const values = useMemo(() => parseSettings(yaml), [yaml]);
  const kind = values.get('type') === 'quadplane' ? 'quad-plane' : flight.fixedWing ? 'fixed wing' : 'multirotor';
  const infos = useMemo(() => perEntry(parseKeyPage(of === 'autonomy' ? autonomyKeys : vehicleKeys, kind), values), [of, kind, values]);
  const [wanted, setWanted] = useState('');
  const [group, setGroup] = useState('');
  const [givenOnly, setGivenOnly] = useState(false);
  const [edits, setEdits] = useState<Edits>(new Map());
  const [results, setResults] = useState<ReadonlyMap<string, Result>>(new Map());
  const [said, setSaid] = useState('');
  if (yaml === '') return <p class="hint">There is no vehicle file here: a vehicle on a link does not have one, and older logs do not hold it.</p>;

  const text = wanted.trim().toLowerCase();
  const shown = infos.filter(({key, meaning}) => (group === '' || groupOf(key) === group) && (!givenOnly || values.has(key) || edits.has(key))
    && `${key} ${meaning}`.toLowerCase().includes(text));
  const simulated = state.control.value?.simulated;
  const change = of === 'autonomy' && simulated && state.commands.value && state.hasControl();
  const changes = [...edits].filter(([key, edit]) => edit.trim() !== '' && edit.trim() !== values.get(key));
  const send = async () => {
    const sent = changes;
    let good = 0;
    for (const [key, value] of sent) {
      const [ended] = await state.commands.value!.steer(`tune ${key.slice(AUTONOMY.length)} ${value.trim()}`);
      if (!ended) continue;
      if (ended.good) setEdits((before) => new Map([...before].filter(([one]) => one !== key)));
      if (ended.good) ++good;
      setResults((before) => new Map([...before, [key, ended.good ? {...ended, text: `set to ${value.trim()}`} : ended]]));
    }
    setSaid(`${good} of ${sent.length} in force`);
  };
  return <section class="parameters" aria-label={of === 'autonomy' ? 'Autonomy' : 'Simulated vehicle'}>
    <p class="hint">{of === 'autonomy' ? 'Gains and limits of estimator, guidance and control at the moment shown. Those of the estimator are read as a flight begins.'
      : 'What the simulation makes the vehicle of. It stays as it is during a flight; ./rosflight fly --set vehicle.KEY=VALUE flies another one.'}</p>
    {of === 'autonomy' && simulated && <ControlBar/>}
    <div class="tools">
      <label>Search <input type="search" value={wanted} onInput={(event) => setWanted(event.currentTarget.value)}/></label>
      <label>Group <select value={group} onChange={(event) => setGroup(event.currentTarget.value)}>
        <option value="">all</option>{[...new Set(infos.map(({key}) => groupOf(key)))].map((one) => <option key={one}>{one}</option>)}</select></label>
      <label><input type="checkbox" checked={givenOnly} onChange={(event) => setGivenOnly(event.currentTarget.checked)}/> only those that the file gives</label>
      <span class="hint">{shown.length} of {infos.length}</span>
      {changes.length > 0 && change && <>
        <button onClick={() => void send()}>Send {changes.length} {changes.length === 1 ? 'change' : 'changes'}</button>
        <button onClick={() => setEdits(new Map())}>Discard</button></>}
    </div>
    <p class="said" role="status">{said}</p>
    <table><thead><tr><th>name</th><th class="n">value</th><th class="n">default</th></tr></thead>
      <tbody>{shown.map((info) => <Row key={info.key} info={info} value={values.get(info.key)} edit={edits.get(info.key)} result={results.get(info.key)}
        change={change && changesInFlight(info.key) ? (edit) => setEdits((before) => typed(before, info.key, edit, values.get(info.key) ?? '')) : undefined}/>)}</tbody></table>
  </section>;
}

function Row({info, value, edit, result, change}: {info: SettingInfo; value: string | undefined; edit: string | undefined; result: Result | undefined;
  change: ((edit: string) => void) | undefined}) {
  return <>
    <tr class={edit === undefined ? '' : 'edited'}>
      <th scope="row" class="mono">{info.key}</th>
      <td class="n">{change ? <input aria-label={`Value of ${info.key}`} value={edit ?? value ?? ''} placeholder="default"
        onInput={(event) => change(event.currentTarget.value)}/> : value ?? 'default'}</td>
      <td class="n">{info.standard}</td></tr>
    <tr class="about"><td colSpan={3} class="hint">{[info.unit, info.allowed, info.meaning].filter(Boolean).join(' · ')}
      {result && <p class={`result ${result.good ? 'good' : 'bad'}`}>{result.good ? '✓' : '✗'} {result.text}</p>}</td></tr>
  </>;
}
