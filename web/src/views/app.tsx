// SPDX-License-Identifier: BSD-3-Clause
import {useEffect, useState} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import {openFile} from '../open.ts';
import * as state from '../state.ts';
import {Events} from './events.tsx';
import {Facts} from './facts.tsx';
import {Firmware} from './firmware.tsx';
import {Bars, Instruments} from './instruments.tsx';
import {Parameters} from './parameters.tsx';
import {Plots} from './plots.tsx';
import {Preflight} from './preflight.tsx';
import {Simulation} from './simulation.tsx';
import {Space} from './space.tsx';
import {Timeline} from './timeline.tsx';
import {Tune} from './tune.tsx';

export function App() {
  useKeyboard();
  useFileDrop();
  const flight = state.flight.value;
  return <>
    <header>
      <h1>{flight ? title(flight) : 'ROSflight flight viewer'}</h1>
      <Verdict/><Paused/>
      <label class="button open">Open a log<input type="file" accept=".mcap" class="sr" onChange={(event) => {
        const file = event.currentTarget.files?.[0];
        if (file) void openFile(file);
      }}/></label>
      <button onClick={switchTheme}>Light or dark</button>
    </header>
    {state.failure.value && <p class="failure" role="alert">{state.failure.value}</p>}
    {state.live.value === 'gone' && <p class="failure" role="status">The connection to the flight is lost; trying again.</p>}
    {state.extract.value && <p class="notice" role="note">This page holds every event and 50 Hz of every field, but for the topics that repeat others for ROS tools. Its folder has the log;{' '}
      <code>./rosflight view FOLDER</code> shows all of it.</p>}
    {flight?.notes.map((note) => <p class="failure" role="status" key={note}>{note}</p>)}
    {flight ? <FlightView flight={flight}/> : <Start/>}
  </>;
}

function title(flight: Flight): string {
  const {facts} = flight;
  return facts.has('vehicle') ? `${facts.get('vehicle')} flies ${facts.get('mission')}` : flight.name;
}

function Verdict() {
  const summary = state.summary.value;
  if (!summary) return null;
  return <span class={`badge ${summary['success'] ? 'good' : 'bad'}`} title={String(summary['verdict'])}>
    {summary['success'] ? '✓ success' : '✗ failed'}</span>;
}

/** What a viewer should know in every view. */
function Paused() {
  const control = state.control.value;
  return <>{control?.paused && <span class="badge warning">simulation paused</span>}
    {control && control.viewer !== 0 && control.viewer !== control.you && <span class="badge note">viewer {control.viewer} has control</span>}</>;
}

function Start() {
  const loading = state.loading.value;
  return <main class="start">
    {state.live.value !== 'off' ? <p role="status">Waiting for the flight</p> : loading ? <p role="status">Reading the log <progress value={loading.share}>{Math.round(100 * loading.share)} %</progress></p>
      : <p>Open the log of a flight, <code>flight.mcap</code>, or drop it here. Nothing is sent anywhere.</p>}
  </main>;
}

const TABS = {plots: 'Plots', events: 'Events', preflight: 'Preflight', simulation: 'Simulation', bars: 'Receiver and outputs', firmware: 'Firmware', facts: 'Facts', parameters: 'Parameters', tune: 'Tune'};
type Tab = keyof typeof TABS;
/** A flight that was cannot be steered. */
const tabs = () => (Object.keys(TABS) as Tab[]).filter((name) => name !== 'simulation' || state.control.value?.simulated);

function FlightView({flight}: {flight: Flight}) {
  const [tab, setTab] = useState<Tab>('plots');
  void state.revision.value; // events, facts and bars of a growing flight are drawn again
  return <main class="flight">
    <div class="space"><Space flight={flight}/><Instruments flight={flight}/></div>
    <Timeline flight={flight}/>
    <div class="panel">
      <div class="tabs" role="tablist" aria-label="Views">{tabs().map((name) =>
        <button key={name} role="tab" id={`tab-${name}`} aria-controls="panel" aria-selected={tab === name}
          tabIndex={tab === name ? 0 : -1} onClick={() => setTab(name)} onKeyDown={(event) => moveTab(event, name, setTab)}>{TABS[name]}</button>)}</div>
      <div id="panel" role="tabpanel" aria-labelledby={`tab-${tab}`} tabIndex={0}>
        {tab === 'plots' && <Plots flight={flight}/>}
        {tab === 'events' && <Events flight={flight}/>}
        {tab === 'preflight' && <Preflight flight={flight}/>}
        {tab === 'simulation' && <Simulation/>}
        {tab === 'bars' && <Bars flight={flight}/>}
        {tab === 'firmware' && <Firmware flight={flight}/>}
        {tab === 'facts' && <Facts flight={flight}/>}
        {tab === 'parameters' && <Parameters flight={flight}/>}
        {tab === 'tune' && <Tune flight={flight}/>}
      </div>
    </div>
  </main>;
}

function moveTab(event: KeyboardEvent, from: Tab, setTab: (tab: Tab) => void) {
  const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
  if (step === 0) return;
  const names = tabs();
  const to = names[(names.indexOf(from) + step + names.length) % names.length]!;
  event.preventDefault();
  setTab(to);
  document.getElementById(`tab-${to}`)?.focus();
}

/** Space plays and pauses, comma and point step, unless the user is typing or on a control that uses the key. */
function useKeyboard() {
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      if (target.matches('input:not([type=range]), select, textarea') || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === ' ' && target.matches('button, summary, label')) return;
      const act: Record<string, () => void> = {
        ' ': () => state.play(!state.playing.value), ',': () => state.stepMessage(-1), '.': () => state.stepMessage(1),
      };
      const wanted = act[event.key];
      if (!wanted) return;
      event.preventDefault();
      wanted();
    };
    document.addEventListener('keydown', press);
    return () => document.removeEventListener('keydown', press);
  }, []);
}

function useFileDrop() {
  useEffect(() => {
    const over = (event: DragEvent) => event.preventDefault();
    const drop = (event: DragEvent) => {
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (file) void openFile(file);
    };
    document.addEventListener('dragover', over);
    document.addEventListener('drop', drop);
    return () => {
      document.removeEventListener('dragover', over);
      document.removeEventListener('drop', drop);
    };
  }, []);
}

function switchTheme() {
  const root = document.documentElement;
  const dark = root.dataset['theme'] ? root.dataset['theme'] === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  root.dataset['theme'] = dark ? 'light' : 'dark';
  document.dispatchEvent(new Event('themechange'));
}
