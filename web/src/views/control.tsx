// SPDX-License-Identifier: BSD-3-Clause
// Who has control of the vehicle. It belongs to one viewer at a time, who may take it from another.
import {useState} from 'preact/hooks';
import * as state from '../state.ts';

export function ControlBar() {
  const commands = state.commands.value;
  const control = state.control.value;
  const [said, setSaid] = useState('');
  if (!control) return null;
  const mine = state.hasControl();
  return <div class="tools control-bar">
    <span class={`badge ${mine ? 'good' : 'note'}`} role="status">{mine ? `You have control (viewer ${control.you})`
      : control.viewer ? `Viewer ${control.viewer} has control` : 'Nobody has control'}</span>
    {commands && !mine && <button onClick={async () => {
      const [answer] = await commands.takeControl();
      setSaid(answer?.good ? '' : answer?.text ?? '');
    }}>{control.viewer ? 'Take over control' : 'Take control'}</button>}
    {!commands && <span class="hint">This address is one to look, not to command.</span>}
    <span role="alert">{said || (state.controlEnded.value ? 'Control ended with the connection.' : '')}</span>
  </div>;
}
