// SPDX-License-Identifier: BSD-3-Clause
// What a pilot looks at: attitude indicator, numbers, state, and bars of receiver and outputs.
import {eulerAngles} from '../data/attitude.ts';
import type {Flight} from '../data/flight.ts';
import {errorNames} from '../data/lanes.ts';
import {linkQualityAt, WINDOW_S} from '../data/link_quality.ts';
import {usesOf} from '../data/mixer.ts';
import {valuesOfMoment} from '../data/parameter_values.ts';
import {CHANNELS, endPoints} from '../data/receiver.ts';
import {DEG_PER_RAD} from '../data/units.ts';
import * as state from '../state.ts';
import {Mixer} from './mixer.tsx';

const PITCH_PX = 1.6; // for a degree

export function Instruments({flight}: {flight: Flight}) {
  const t = state.time.value;
  const pose = flight.poseAt(t);
  const [roll, pitch, yaw] = pose ? eulerAngles(pose.q).map((angle) => angle * DEG_PER_RAD) : [NaN, NaN, NaN];
  const velocity = groundSpeed(flight, t);
  return <div class="instruments">
    <AttitudeIndicator roll={roll!} pitch={pitch!}/>
    <dl>
      <Reading name="height" value={pose && flight.poseTopic?.position.length ? -pose.p[2] : NaN} unit="m" digits={1}/>
      <Reading name="speed" value={velocity} unit="m/s" digits={1}/>
      <Reading name="heading" value={(yaw! + 360) % 360} unit="°" digits={0}/>
      <Reading name="battery" value={flight.valueAt('/battery', 'voltage', t)} unit="V" digits={1}/>
    </dl>
    <StateLine flight={flight} t={t}/>
  </div>;
}

function groundSpeed(flight: Flight, t: number): number {
  // Across ground the estimate has it in north and east; truth in body axes, of which the length alone is the same.
  const body = ['x', 'y', 'z'].map((axis) => flight.valueAt('/sim/truth_state', `twist.linear.${axis}`, t));
  const length = Math.hypot(...body);
  return Number.isFinite(length) ? length : Math.hypot(...[0, 1, 2].map((k) => flight.valueAt('/autonomy/estimate', `velocity[${k}]`, t)));
}

function Reading({name, value, unit, digits}: {name: string; value: number; unit: string; digits: number}) {
  return <div><dt>{name}</dt><dd>{Number.isFinite(value) ? (value + 0).toFixed(digits).replace(/^-(0(\.0+)?)$/, '$1') : '–'} <small>{unit}</small></dd></div>;
}

/** Sky and ground as seen from the seat: rolling right turns the horizon left, pitching up moves it down. */
function AttitudeIndicator({roll, pitch}: {roll: number; pitch: number}) {
  const known = Number.isFinite(roll) && Number.isFinite(pitch);
  const text = known ? `roll ${roll.toFixed(0)} degrees, pitch ${pitch.toFixed(0)} degrees` : 'attitude unknown';
  return <svg class="horizon" viewBox="-60 -60 120 120" role="img" aria-label={text}>
    <clipPath id="round"><circle r="56"/></clipPath>
    {known && <g clip-path="url(#round)">
      <g transform={`rotate(${-roll}) translate(0 ${pitch * PITCH_PX})`}>
        <rect class="sky" x="-200" y="-400" width="400" height="400"/>
        <rect class="earth" x="-200" y="0" width="400" height="400"/>
        <path class="level" d="M-200 0H200"/>
        {[-60, -45, -30, -15, 15, 30, 45, 60].map((angle) =>
          <path key={angle} class="rung" d={`M${angle % 30 ? -9 : -16} ${-angle * PITCH_PX}h${angle % 30 ? 18 : 32}`}/>)}
      </g>
      <path class="pointer" transform={`rotate(${-roll})`} d="M0 -55l-4 8h8z"/>
    </g>}
    <path class="wings" d="M-30 0h18l6 6M30 0h-18l-6 6M-1 0h2"/>
    <circle class="rim" r="56"/>
  </svg>;
}

function StateLine({flight, t}: {flight: Flight; t: number}) {
  const flag = (name: string) => flight.latest('/status', name, t);
  const armed = flag('armed');
  if (!Number.isFinite(armed)) return <p class="state"><span class="badge neutral">no state yet</span> <LinkBadge flight={flight} t={t}/></p>;
  const errors = errorNames(flag('error_code'));
  return <p class="state">
    <span class={`badge ${flag('failsafe') ? 'bad' : armed ? 'good' : 'neutral'}`}>{flag('failsafe') ? 'failsafe' : armed ? 'armed' : 'disarmed'}</span>
    {errors.map((error) => <span key={error} class="badge bad">{error}</span>)}
    <LinkBadge flight={flight} t={t}/>
  </p>;
}

function LinkBadge({flight, t}: {flight: Flight; t: number}) {
  const link = linkQualityAt(flight, t);
  if (!link) return null;
  const {state, requests, unanswered, roundTrip_ms, age_s} = link;
  const lost = unanswered > 0 ? `, ${(100 * unanswered / requests).toFixed(0)} % lost` : '';
  const title = `${unanswered} of ${requests} time requests in ${WINDOW_S} s without an answer`
    + (age_s >= 0 ? `; the last one came ${age_s.toFixed(1)} s ago` : '') + (roundTrip_ms >= 0 ? `, after ${roundTrip_ms.toFixed(1)} ms` : '');
  return <span class={`badge ${{good: 'good', weak: 'warning', lost: 'bad'}[state]}`} title={title}>link {state}{lost}</span>;
}

/** Receiver channels (1000 to 2000 us) and outputs (0 to 1, servos 0.5 at their centre). */
export function Bars({flight}: {flight: Flight}) {
  const t = state.time.value;
  const parameters = valuesOfMoment(flight, state.following.value ? Infinity : t);
  const channels = values(flight, '/rc_raw', 'values', CHANNELS, t);
  const outputs = values(flight, '/output_raw', 'values', 14, t);
  const used = outputs.findLastIndex((_, k) => flight.tables.get('/output_raw')?.column(`values[${k}]`)?.some((value) => value !== 0));
  return <section class="bars" aria-label="Receiver and outputs">
    <h2>Receiver</h2>
    {channels.map((value, k) => {
      const ends = endPoints(flight, k, t);
      return <Bar key={k} name={`channel ${k}`} share={travelOf(value)} text={`${value.toFixed(0)} µs`} ends={ends && [travelOf(ends.low_us), travelOf(ends.high_us)]}
        use={[...usesOf(parameters, k), ...(ends ? [`${ends.low_us.toFixed(0)}\u00a0to\u00a0${ends.high_us.toFixed(0)}\u00a0µs`] : [])].join(', ')}/>;
    })}
    {channels.length === 0 ? <p class="hint">The log has no receiver channels.</p>
      : <p class="hint">Use by the parameters RC_*_CHN, then the end points: smallest and largest pulse until the moment shown. Full travel is 1000 to 2000 µs.</p>}
    <h2>Outputs</h2>
    {outputs.slice(0, used + 1).map((value, k) => <Bar key={k} name={`output ${k}`} share={value} text={`${(100 * value).toFixed(0)} %`}/>)}
    {outputs.length === 0 && <p class="hint">The log has no outputs.</p>}
    <Mixer flight={flight} values={parameters}/>
  </section>;
}

function values(flight: Flight, topic: string, name: string, count: number, t: number): number[] {
  return Array.from({length: count}, (_, k) => flight.latest(topic, `${name}[${k}]`, t)).filter(Number.isFinite);
}

/** Of a pulse of the receiver [us]: 0 to 1. */
const travelOf = (pulse_us: number) => (pulse_us - 1000) / 1000;

/** @param ends  Marked in the bar, as shares of it. */
function Bar({name, use = '', share, text, ends = []}: {name: string; use?: string; share: number; text: string; ends?: number[] | undefined}) {
  const size = Math.min(Math.abs(share), 1);
  const half = share < 0;
  return <div class="bar" role="meter" aria-label={name} aria-valuenow={Math.round(100 * share)} aria-valuemin={-100} aria-valuemax={100} aria-valuetext={text}>
    <span class="name">{name}</span>
    <span class="gauge"><span class={half ? 'fill below' : 'fill'} style={{width: `${100 * size}%`}}/>
      {ends.map((end, k) => <i key={k} class="end" style={{left: `${100 * Math.min(Math.max(end, 0), 1)}%`}}/>)}</span>
    <span class="value">{text}</span>
    {use && <span class="use">{use}</span>}
  </div>;
}
