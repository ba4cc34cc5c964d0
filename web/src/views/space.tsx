// SPDX-License-Identifier: BSD-3-Clause
import {effect} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import {FlightScene, type View} from '../scene/scene.ts';
import * as state from '../state.ts';

const VIEWS: [View, string][] = [['follow', 'Follow'], ['free', 'Whole flight'], ['above', 'From above'], ['south', 'From south'], ['east', 'From east']];

/** The scene, for tests that look where the vehicle is in the picture. */
declare global { interface Window { rosflightScene?: FlightScene } }

export function Space({flight}: {flight: Flight}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const scene = useRef<FlightScene | undefined>(undefined);
  const [view, setView] = useState<View>('follow');
  const [failure, setFailure] = useState('');
  useEffect(() => {
    try {
      scene.current ??= new FlightScene(canvas.current!);
    } catch {
      setFailure('This browser has no WebGL: the 3-D view is left out, everything else works.');
      return;
    }
    const shown = window.rosflightScene = scene.current;
    shown.show(flight);
    setView('follow');
    const stop = effect(() => shown.setTime(state.time.value));
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const restyle = () => shown.refresh();
    dark.addEventListener('change', restyle);
    document.addEventListener('themechange', restyle);
    return () => {
      stop();
      dark.removeEventListener('change', restyle);
      document.removeEventListener('themechange', restyle);
    };
  }, [flight]);
  const revision = state.revision.value;
  useEffect(() => { if (revision > 0) scene.current?.refresh(); }, [revision]);
  const look = (wanted: View) => {
    setView(wanted);
    scene.current?.setView(wanted);
  };
  return <>
    {failure ? <p class="failure" role="status">{failure}</p>
      : <canvas ref={canvas} tabIndex={0} aria-label="The vehicle and its path in space. Drag or use the arrow keys to turn or move the view."/>}
    {!failure && <div class="views" role="group" aria-label="Camera">{VIEWS.map(([name, label]) =>
      <button key={name} aria-pressed={view === name} onClick={() => look(name)}>{label}</button>)}</div>}
    <ul class="legend" aria-label="Lines">
      <li class="actual">flown</li><li class="estimate">estimate, ±3 σ</li><li class="command">setpoint</li><li class="route">plan</li>
    </ul>
  </>;
}
