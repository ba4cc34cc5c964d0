// SPDX-License-Identifier: BSD-3-Clause
// Parameters at the moment shown: of the firmware here, of autonomy and vehicle in settings.tsx. Where commands are allowed they can be changed, and each change says how it ended.
import csv from '../../../firmware/core/parameters.csv';
import {useComputed} from '@preact/signals';
import {useMemo, useState} from 'preact/hooks';
import type {Result} from '../data/commands.ts';
import type {Flight} from '../data/flight.ts';
import {tableOf, valuesAt} from '../data/parameter_values.ts';
import {differences, formatParameterFile, parseParameterFile, twoFiles, type Difference, type ParameterValue} from '../data/parameter_file.ts';
import {changesIn, typed, type Edits} from '../data/edits.ts';
import {allowedText, complaint, groupOf, groupsOf, parseParameterTable, sameValue, shortNumber, type ParameterInfo} from '../data/parameter_table.ts';
import * as state from '../state.ts';
import {admission} from '../token.ts';
import {ControlBar} from './control.tsx';
import {Settings} from './settings.tsx';

const INFOS = parseParameterTable(csv);

const OWNERS = {firmware: 'firmware', autonomy: 'autonomy', vehicle: 'simulated vehicle'};

export function Parameters({flight}: {flight: Flight}) {
  const [of, setOf] = useState<keyof typeof OWNERS>('firmware');
  return <>
    <div class="tools"><label>Parameters of <select value={of} onChange={(event) => setOf(event.currentTarget.value as typeof of)}>
      {Object.entries(OWNERS).map(([one, name]) => <option key={one} value={one}>{name}</option>)}</select></label></div>
    {of === 'firmware' ? <OfFirmware flight={flight}/> : <Settings key={of} flight={flight} of={of}/>}
  </>;
}

function OfFirmware({flight}: {flight: Flight}) {
  const rows = useComputed(() => {
    void state.revision.value; // a growing flight
    return (tableOf(state.flight.value ?? flight)?.rowAt(state.following.value ? Infinity : state.time.value) ?? -1) + 1;
  }).value;
  const values = useMemo(() => valuesAt(flight, rows), [flight, rows]);
  const [wanted, setWanted] = useState('');
  const [group, setGroup] = useState('');
  const [changedOnly, setChangedOnly] = useState(false);
  const [edits, setEdits] = useState<Edits>(new Map());
  const [results, setResults] = useState<ReadonlyMap<string, Result>>(new Map());
  const [said, setSaid] = useState('');
  const [file, setFile] = useState<{name: string; here?: string; found: Difference[]}>();
  const commands = state.hasControl() ? state.commands.value : undefined;

  const names = [...values.keys()].sort();
  const text = wanted.trim().toLowerCase();
  const isChanged = (name: string) => INFOS.has(name) && !sameValue(values.get(name)!, INFOS.get(name)!.standard);
  const shown = names.filter((name) => (group === '' || groupOf(name) === group) && (!changedOnly || isChanged(name) || edits.has(name))
    && `${name} ${INFOS.get(name)?.description}`.toLowerCase().includes(text));
  const changes = changesIn(edits, values);
  const wrong = changes.filter(([name, edit]) => complaint(edit, INFOS.get(name)));

  const send = async (sent: {name: string; value: number}[]) => {
    setSaid(`Sending ${sent.length}`);
    const ended = await commands!.set(sent);
    setResults((before) => new Map([...before, ...ended.map((one) => [one.name, one] as const)]));
    const good = ended.filter((one) => one.good);
    setEdits((before) => new Map([...before].filter(([name]) => !good.some((one) => one.name === name))));
    const general = ended.filter((one) => !one.name).map((one) => one.text);
    setSaid([`${good.length} of ${sent.length} in force`, ...general].join('; '));
    return ended;
  };
  const write = async () => {
    setSaid('Writing');
    const [ended] = await commands!.write();
    setSaid(ended ? ended.text : '');
  };
  /** One file is compared with the vehicle, two with each other. */
  const load = async (chosen: File[]) => {
    setFile(undefined);
    const read: {name: string; values: ParameterValue[]}[] = [];
    for (const one of chosen) {
      try {
        read.push({name: one.name, values: parseParameterFile(await one.text())});
      } catch (error) {
        return setSaid(`${one.name}, ${(error as Error).message}`);
      }
    }
    const [first, second] = read;
    setSaid(read.length > 2 ? 'Choose one file, or two.' : '');
    if (read.length === 1) setFile({name: first!.name, found: differences(values, first!.values)});
    if (read.length === 2) setFile({name: second!.name, here: first!.name, found: twoFiles(first!.values, second!.values)});
  };

  /** The server has them once that vehicle has sent its whole list. */
  const loadOther = async ({name, parameters}: {name: string; parameters: string}) => {
    setFile(undefined);
    const answer = await fetch(parameters, {headers: admission(), cache: 'no-store'}).catch(() => undefined);
    const there = answer?.ok ? parseParameterFile(await answer.text()) : [];
    setSaid(there.length === 0 ? `${name} has not sent its parameters yet` : '');
    if (there.length === 0) return;
    const here = [...values].map(([one, value]) => ({name: one, value, isFloat: false}));
    setFile({name, found: twoFiles(here, there)});
  };

  return <section class="parameters" aria-label="Parameters">
    <p class="hint">Values of the firmware at the moment shown.</p>
    {state.control.value && <ControlBar/>}
    <div class="tools">
      <label>Search <input type="search" value={wanted} onInput={(event) => setWanted(event.currentTarget.value)}/></label>
      <label>Group <select value={group} onChange={(event) => setGroup(event.currentTarget.value)}>
        <option value="">all</option>{groupsOf(names).map((one) => <option key={one}>{one}</option>)}</select></label>
      <label><input type="checkbox" checked={changedOnly} onChange={(event) => setChangedOnly(event.currentTarget.checked)}/> only those that differ from the default</label>
      <span class="hint">{shown.length} of {names.length}</span>
    </div>
    <div class="tools">
      <label class="button" title="Two files are compared with each other">Compare with a file<input type="file" accept=".yaml,.yml" multiple class="sr" onChange={(event) => {
        const chosen = [...event.currentTarget.files ?? []];
        if (chosen.length > 0) void load(chosen);
        event.currentTarget.value = '';
      }}/></label>
      {state.other.value && <button onClick={() => void loadOther(state.other.value!)}>Compare with {state.other.value.name}</button>}
      <button onClick={() => save(values)}>Save to a file</button>
      {commands && <button onClick={() => void write()}>Write to memory</button>}
      {commands && state.unsaved.value && <span class="badge warning">changed since the last write</span>}
      {commands && changes.length > 0 && <>
        <button disabled={wrong.length > 0} onClick={() => void send(changes.map(([name, edit]) => ({name, value: Number(edit)})))}>
          Send {changes.length} {changes.length === 1 ? 'change' : 'changes'}</button>
        <button onClick={() => setEdits(new Map())}>Discard</button></>}
    </div>
    <p class="said" role="status">{wrong.length > 0 ? `${wrong[0]![0]}: ${complaint(wrong[0]![1], INFOS.get(wrong[0]![0]))}` : said}</p>
    {file && <Differences key={file.name} {...file} send={commands && !file.here ? send : undefined} close={() => setFile(undefined)}/>}
    <table><thead><tr><th>name</th><th class="n">value</th><th class="n">default</th></tr></thead>
      <tbody>{shown.map((name) => <Row key={name} name={name} value={values.get(name)!} info={INFOS.get(name)} result={results.get(name)} edit={edits.get(name)}
        change={commands && ((edit) => setEdits((before) => typed(before, name, edit, shortNumber(values.get(name)!))))}/>)}</tbody></table>
  </section>;
}

/** Beside its name. */
const outcome = ({name, text}: Result) => text.startsWith(`${name}: `) ? text.slice(name.length + 2) : text;

function Row({name, value, info, result, edit, change}: {name: string; value: number; info: ParameterInfo | undefined; result: Result | undefined;
  edit: string | undefined; change: ((edit: string) => void) | undefined}) {
  const isWrong = edit !== undefined && complaint(edit, info) !== '';
  const about = [info?.unit, info && allowedText(info), info?.description].filter(Boolean).join(' · ');
  return <>
    <tr class={edit === undefined ? '' : 'edited'}>
      <th scope="row" class="mono">{name}</th>
      <td class="n">{change ? <input inputMode="decimal" aria-label={`Value of ${name}`} aria-invalid={isWrong} value={edit ?? shortNumber(value)}
        onInput={(event) => change(event.currentTarget.value)}/> : shortNumber(value)}</td>
      <td class="n">{info && shortNumber(info.standard)}</td></tr>
    <tr class="about"><td colSpan={3} class="hint">{about}
      {result && <p class={`result ${result.good ? 'good' : 'bad'}`}>{result.good ? '✓' : '✗'} {outcome(result)}</p>}</td></tr>
  </>;
}

/** What a file has otherwise: a box for each, and what became of those that were sent. */
function Differences({name, here, found, send, close}: {name: string; here?: string; found: Difference[]; send: ((values: {name: string; value: number}[]) => Promise<Result[]>) | undefined;
  close: () => void}) {
  const [left, setLeft] = useState<ReadonlySet<string>>(new Set());
  const [results, setResults] = useState<ReadonlyMap<string, Result>>(new Map());
  const canSend = (one: Difference) => one.here !== undefined && !Number.isNaN(one.there);
  const chosen = found.filter((one) => canSend(one) && !left.has(one.name));
  const choose = (one: string, on: boolean) => setLeft((before) => new Set(on ? [...before].filter((other) => other !== one) : [...before, one]));
  return <section class="differences" aria-label="Differences from the file">
    <h2>{found.length === 0 ? `${name} has the same values` : `${found.length} ${found.length === 1 ? 'difference' : 'differences'} ${here ? `between ${here} and` : 'from'} ${name}`}</h2>
    {found.length > 0 && <table><thead><tr>{send && <th>send</th>}<th>name</th><th class="n">{here ?? 'here'}</th><th class="n">{here ? name : 'in the file'}</th>{results.size > 0 && <th>result</th>}</tr></thead>
      <tbody>{found.map((one) => <tr key={one.name}>
        {send && <td><input type="checkbox" aria-label={`Send ${one.name}`} disabled={!canSend(one)} checked={canSend(one) && !left.has(one.name)}
          onChange={(event) => choose(one.name, event.currentTarget.checked)}/></td>}
        <td class="mono">{one.name}</td><td class="n">{one.here === undefined ? 'no such parameter' : shortNumber(one.here)}</td><td class="n">{Number.isNaN(one.there) ? 'no such parameter' : shortNumber(one.there)}</td>
        {results.size > 0 && <td>{results.has(one.name) && outcome(results.get(one.name)!)}</td>}</tr>)}</tbody></table>}
    <div class="tools">
      {send && found.length > 0 && <button disabled={chosen.length === 0} onClick={async () => {
        const ended = await send(chosen.map((one) => ({name: one.name, value: one.there})));
        setResults(new Map(ended.map((one) => [one.name, one])));
      }}>Send {chosen.length} from the file</button>}
      <button onClick={close}>Close</button></div>
  </section>;
}

function save(values: ReadonlyMap<string, number>) {
  const all = [...values].map(([name, value]) => ({name, value, isFloat: INFOS.get(name)?.isFloat ?? !Number.isInteger(value)}));
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([formatParameterFile(all)], {type: 'application/yaml'}));
  link.download = 'parameters.yaml';
  link.click();
  URL.revokeObjectURL(link.href);
}
