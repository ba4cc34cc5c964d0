// SPDX-License-Identifier: BSD-3-Clause
// Turns one motor while a button is held. The page repeats the request; the firmware stops the motor 0.3 s after the last one,
// whatever became of the page, the server or the link.
import {useEffect, useRef, useState} from 'preact/hooks';
import type {Flight} from '../data/flight.ts';
import * as state from '../state.ts';

const REPEAT_MS = 100;
const MAX_VALUE = 0.3; // of the firmware
const OUTPUTS = 10;

/** Repeats `send` from start() to stop(); stops by itself when the page is not in front. */
function useHeld(send: () => void, end: () => void) {
  const [held, setHeld] = useState(false);
  const timer = useRef<ReturnType<typeof setInterval> | undefined>(undefined);
  const now = useRef({send, end});
  now.current = {send, end};
  const stop = () => {
    if (timer.current === undefined) return;
    clearInterval(timer.current);
    timer.current = undefined;
    setHeld(false);
    now.current.end();
  };
  const start = () => {
    if (timer.current !== undefined) return;
    timer.current = setInterval(() => now.current.send(), REPEAT_MS);
    setHeld(true);
    now.current.send();
  };
  useEffect(() => {
    const hidden = () => { if (document.hidden) stop(); };
    document.addEventListener('visibilitychange', hidden);
    window.addEventListener('blur', stop);
    return () => {
      document.removeEventListener('visibilitychange', hidden);
      window.removeEventListener('blur', stop);
      stop();
    };
  }, []);
  return {held, start, stop};
}

export function MotorTest({flight}: {flight: Flight}) {
  const [motor, setMotor] = useState(0);
  const [value, setValue] = useState(0.1);
  const [free, setFree] = useState(false);
  const [said, setSaid] = useState('');
  const allowed = state.hasControl() && free;
  const {held, start, stop} = useHeld(async () => {
    const [answer] = await state.commands.value?.testMotor(motor, value) ?? [];
    setSaid(answer && !answer.good ? answer.text : '');
  }, () => void state.commands.value?.testMotor(motor, 0));
  useEffect(() => { if (!allowed) stop(); }, [allowed]);

  const output = flight.latest('/output_raw', `values[${motor}]`, state.time.value);
  return <section class="motor-test" aria-label="Motor test">
    <h2>Motor test</h2>
    <div class="tools">
      <label><input type="checkbox" checked={free} onChange={(event) => setFree(event.currentTarget.checked)}/> No propeller is mounted</label>
      <label>Output <select value={String(motor)} disabled={held} onChange={(event) => setMotor(Number(event.currentTarget.value))}>
        {Array.from({length: OUTPUTS}, (_, k) => <option key={k} value={String(k)}>{k}</option>)}</select></label>
      <label>Value {value.toFixed(2)} <input type="range" min={0.02} max={MAX_VALUE} step={0.01} value={value} disabled={held} aria-label="Value of the motor test"
        onInput={(event) => setValue(Number(event.currentTarget.value))}/></label>
      <button class={held ? 'held' : ''} disabled={!allowed} aria-pressed={held}
        onPointerDown={(event) => { event.currentTarget.setPointerCapture(event.pointerId); start(); }}
        onPointerUp={stop} onPointerCancel={stop} onLostPointerCapture={stop} onContextMenu={(event) => event.preventDefault()}
        onKeyDown={(event) => {
          if (event.key !== ' ' && event.key !== 'Enter') return;
          event.preventDefault();
          start();
        }} onKeyUp={stop} onBlur={stop}>Hold to turn the motor</button>
      <span class="mono" role="status">output {motor}: {Number.isFinite(output) ? output.toFixed(2) : '–'}</span>
    </div>
    <p class="hint">It turns while the button is held, disarmed, at {MAX_VALUE} at most. It stops within 0.3 s without the page, the server or the link.</p>
    <p class="said wrong" role="alert">{said}</p>
  </section>;
}
