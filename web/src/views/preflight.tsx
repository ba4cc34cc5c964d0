// SPDX-License-Identifier: BSD-3-Clause
// Whether the vehicle would arm at the moment shown, and for each reason against it what to do.
import {useState} from 'preact/hooks';
import {checksAt, linesAt, refusalAt, wayOut, type Verdict} from '../data/checks.ts';
import type {Flight} from '../data/flight.ts';
import * as state from '../state.ts';
import {Calibrations} from './calibrations.tsx';
import {ControlBar} from './control.tsx';
import {MotorTest} from './motor_test.tsx';

const WORDS: Record<Verdict, [word: string, tone: string]> = {pass: ['✓ pass', 'good'], warning: ['! warning', 'warning'], refuses: ['✗ refuses', 'bad']};

export function Preflight({flight}: {flight: Flight}) {
  const t = state.time.value;
  const commands = state.commands.value;
  const [said, setSaid] = useState('');
  const list = checksAt(flight, t);
  const lines = linesAt(flight, t);
  const refused = refusalAt(flight, t);
  const later = !list && state.live.value === 'off' ? checksAt(flight, Infinity) : undefined;
  const armed = flight.latest('/status', 'armed', t) === 1;
  const against = lines?.filter(({verdict}) => verdict === 'refuses').length ?? 0;
  const ask = async () => {
    const [answer] = await commands!.checks();
    setSaid(answer && !answer.good ? answer.text : '');
  };
  return <section class="preflight" aria-label="Preflight">
    <p class={`verdict ${armed || !lines ? 'note' : against > 0 ? 'bad' : 'good'}`} role="status">
      {armed ? 'The vehicle is armed.' : !lines ? 'The vehicle has not sent its state yet.'
        : against > 0 ? `Arming is refused for ${against} ${against === 1 ? 'reason' : 'reasons'}.` : 'Nothing refuses arming.'}</p>
    <div class="tools">{commands && <button onClick={() => void ask()}>Check now</button>}
      <span class="hint">{list ? `All checks of the firmware, as of ${list.t.toFixed(1)} s; flags of the status as they are now.`
        : 'Flags of the status alone; the firmware was not asked for all of its checks.'}</span>
      {later && <button onClick={() => state.seek(later.t)}>All checks at {later.t.toFixed(1)} s</button>}
      <span role="status">{said}</span></div>
    {refused && <div class="refusal"><h2>Attempt to arm at {refused.t.toFixed(1)} s, refused</h2>
      <ul>{refused.reasons.map((reason) => <li key={reason}>{reason}</li>)}</ul></div>}
    {lines && <table class="checks"><thead><tr><th>check</th><th>result</th><th>reason, and what to do</th></tr></thead>
      <tbody>{lines.map(({name, verdict, reason}) => <tr key={name}>
        <th scope="row">{name}</th><td><span class={`badge ${WORDS[verdict][1]}`}>{WORDS[verdict][0]}</span></td>
        <td>{verdict !== 'pass' && <>{reason && <strong>{reason}. </strong>}{wayOut(name)}</>}</td></tr>)}</tbody></table>}
    {commands && state.control.value && <><ControlBar/><Calibrations flight={flight}/><MotorTest flight={flight}/></>}
  </section>;
}
