// SPDX-License-Identifier: BSD-3-Clause
// Which curves are drawn together. A curve that a flight does not have is left out, a chart without curves too.
import {alignedTo, analysisCurve, angle, derived, difference, field, groundVelocity, horizontal, unwrapped, type Curve} from '../data/curves.ts';
import {AIDS, type Flight} from '../data/flight.ts';
import {DEG_PER_RAD} from '../data/units.ts';

export type Style = 'command' | 'actual' | 'estimate' | 'numbered';
export interface Line { label: string; style: Style; curve: Curve }
export interface Chart { title: string; unit: string; lines: Line[]; band?: {label: string; low: Curve; high: Curve} }
export interface ChartGroup { name: string; charts: Chart[] }

const TRUTH = '/sim/truth_state';
const ESTIMATE = '/autonomy/estimate';
const SETPOINT = '/trajectory_command';
const VEHICLE = '/sim/truth_vehicle';
const AXES = ['x', 'y', 'z'] as const;
const POSE_Q = ['w', 'x', 'y', 'z'].map((a) => `pose.orientation.${a}`);
const ATTITUDE_Q = ['w', 'x', 'y', 'z'].map((a) => `attitude.${a}`);

type Wanted = [label: string, style: Style, curve: Curve | undefined];

function chart(title: string, unit: string, wanted: Wanted[], band?: [string, Curve | undefined, Curve | undefined]): Chart {
  const lines = wanted.flatMap(([label, style, curve]) => curve ? [{label, style, curve}] : []);
  const [name = '', low, high] = band ?? [];
  return {title, unit, lines, ...(low && high ? {band: {label: name, low, high}} : {})};
}

/** All charts of a flight that have something to show. */
export function chartGroups(flight: Flight): ChartGroup[] {
  const groups: ChartGroup[] = [
    {name: 'Position', charts: position(flight)},
    {name: 'Attitude and rates', charts: attitude(flight)},
    {name: 'Motors and battery', charts: motors(flight)},
    {name: 'Fixed wing', charts: fixedWing(flight)},
    {name: 'Estimate less truth', charts: errors(flight)},
    {name: 'Air', charts: air(flight)},
    {name: 'Receiver and firmware', charts: firmware(flight)},
  ];
  return groups.map(({name, charts}) => ({name, charts: charts.filter(({lines}) => lines.length > 0)}))
    .filter(({charts}) => charts.length > 0);
}

function position(flight: Flight): Chart[] {
  const truth = AXES.map((a, k) => field(flight, TRUTH, `pose.position.${a}`, k === 2 ? -1 : 1));
  const estimate = AXES.map((_, k) => field(flight, ESTIMATE, `position[${k}]`, k === 2 ? -1 : 1));
  const setpoint = AXES.map((_, k) => field(flight, SETPOINT, `position[${k}]`, k === 2 ? -1 : 1));
  const off = AXES.map((_, k) => difference(setpoint[k], truth[k]));
  const size = (curve: Curve | undefined) => curve && {t: curve.t, y: curve.y.map(Math.abs)};
  return [
    ...['North', 'East', 'Height'].map((name, k) => chart(name, 'm', [
      ['setpoint', 'command', setpoint[k]], ['flown', 'actual', truth[k]], ['estimate', 'estimate', estimate[k]]])),
    chart('Distance from setpoint', 'm', [['across ground', 'actual', horizontal(off[0], off[1])], ['in height', 'estimate', size(off[2])]]),
    chart('Speed over ground', 'm/s', [['flown', 'actual', groundVelocity(flight, ([n, e]) => Math.hypot(n, e))]]),
    chart('Climb', 'm/s', [['flown', 'actual', groundVelocity(flight, ([, , d]) => -d)]]),
  ];
}

/** What a channel of /command asks for: an angle or a rate, by its mode. */
function command(flight: Flight, channel: number, mode: (mode: number) => boolean): Curve | undefined {
  return derived(flight, '/command', ['mode', 'ignore', `u[${channel}]`], ([m, ignore, u]) =>
    mode(m!) && !((ignore! >> channel) & 1) ? u! * DEG_PER_RAD : NaN);
}

function attitude(flight: Flight): Chart[] {
  return ['Roll', 'Pitch', 'Yaw'].flatMap((name, k) => {
    const axis = k as 0 | 1 | 2;
    const channel = 3 + k;
    const truth = angle(flight, TRUTH, POSE_Q, axis);
    const asked = axis < 2 ? command(flight, channel, (mode) => mode === 2) : undefined;
    const rate = command(flight, channel, (mode) => mode === 1 || (mode === 2 && axis === 2));
    return [
      chart(name, '°', [['command', 'command', asked], ['true', 'actual', truth],
        ['firmware', 'estimate', alignedTo(angle(flight, '/attitude', ATTITUDE_Q, axis), truth)]]),
      chart(`${name} rate`, '°/s', [['command', 'command', rate],
        ['true', 'actual', field(flight, TRUTH, `twist.angular.${AXES[axis]}`, DEG_PER_RAD)],
        ['firmware', 'estimate', field(flight, '/attitude', `angular_velocity.${AXES[axis]}`, DEG_PER_RAD)]]),
    ];
  });
}

/** Columns name[0], name[1], ... that a topic has and that are not zero throughout. */
function numbered(flight: Flight, topic: string, name: string, count = 14): Wanted[] {
  return Array.from({length: count}, (_, k): Wanted => {
    const curve = field(flight, topic, `${name}[${k}]`);
    return [String(k + 1), 'numbered', curve?.y.some((value) => value !== 0) ? curve : undefined];
  });
}

function motors(flight: Flight): Chart[] {
  const truth = field(flight, VEHICLE, 'battery_voltage') !== undefined;
  return [
    chart('Outputs', 'of full', numbered(flight, truth ? VEHICLE : '/output_raw', truth ? 'outputs' : 'values')),
    chart('Rotor speeds', 'rad/s', numbered(flight, VEHICLE, 'rotor_speed')),
    chart('Battery voltage', 'V', [['true', 'actual', field(flight, VEHICLE, 'battery_voltage')],
      ['measured', 'estimate', field(flight, '/battery', 'voltage')]]),
    chart('Battery current', 'A', [['true', 'actual', field(flight, VEHICLE, 'battery_current')],
      ['measured', 'estimate', field(flight, '/battery', 'current')]]),
  ];
}

const SIGMAS = 3;

function errors(flight: Flight): Chart[] {
  const within = (sigma: Curve | undefined): [string, Curve | undefined, Curve | undefined] => [
    `±${SIGMAS} σ`, sigma && {t: sigma.t, y: sigma.y.map((value) => -SIGMAS * value)},
    sigma && {t: sigma.t, y: sigma.y.map((value) => SIGMAS * value)}];
  // Across ground less the slow error of the satellites, which nothing on board can see.
  const drift = [analysisCurve(flight.analysis, 'drift_north_m'), analysisCurve(flight.analysis, 'drift_east_m')];
  const less = (error: Curve | undefined, k: number) => drift[k] ? difference(error, drift[k]) : error;
  const place = AXES.map((a, k) => chart(`Position error, ${['north', 'east', 'down'][k]}${drift[k] ? ', less GNSS drift' : ''}`, 'm', [['error', 'actual',
    less(difference(field(flight, ESTIMATE, `position[${k}]`), field(flight, TRUTH, `pose.position.${a}`)), k)]],
    within(field(flight, ESTIMATE, `position_sigma[${k}]`))));
  const velocity = AXES.map((_, k) => chart(`Velocity error, ${['north', 'east', 'down'][k]}`, 'm/s', [['error', 'actual',
    difference(field(flight, ESTIMATE, `velocity[${k}]`), groundVelocity(flight, (v) => v[k]!))]],
    within(field(flight, ESTIMATE, `velocity_sigma[${k}]`))));
  const estimateQ = [0, 1, 2, 3].map((k) => `attitude[${k}]`);
  const turn = ([0, 1, 2] as const).map((k) => {
    const truth = angle(flight, TRUTH, POSE_Q, k);
    return chart(`${['Roll', 'Pitch', 'Heading'][k]} error`, '°', [['error', 'actual',
      difference(alignedTo(angle(flight, ESTIMATE, estimateQ, k), truth), truth)]],
      within(field(flight, ESTIMATE, `attitude_sigma[${k}]`, DEG_PER_RAD)));
  });
  return [...place, ...velocity, ...turn, chart('Innovations squared over their covariance (1 is right)', '',
    AIDS.map((name, k): Wanted => [name, 'numbered', some(field(flight, ESTIMATE, `innovation[${k}]`))]))];
}

/** What a fixed wing follows. */
function fixedWing(flight: Flight): Chart[] {
  const {analysis} = flight;
  if (!analysisCurve(analysis, 'aileron')) return [];
  const course = courseOf(flight);
  return [
    chart('Cross-track error, right of the path', 'm', [['total', 'estimate', analysisCurve(analysis, 'cross_track_total_m')],
      ['less GNSS drift', 'actual', analysisCurve(analysis, 'cross_track_m')]]),
    chart('Height above the ramped reference', 'm', [['error', 'actual', analysisCurve(analysis, 'height_error_m')]]),
    chart('Airspeed and its command', 'm/s', [['command', 'command', analysisCurve(analysis, 'airspeed_command_m_s')],
      ['estimate', 'estimate', some(field(flight, ESTIMATE, 'airspeed'))], ['measured', 'actual', field(flight, '/airspeed', 'velocity')]]),
    chart('Course over ground', '°', [['command', 'command', alignedTo(course && unwrapped(analysisCurve(analysis, 'course_command_rad', DEG_PER_RAD)), course)],
      ['true', 'actual', course]]),
    chart('Surfaces, by effect', 'of full', ['aileron', 'elevator', 'rudder'].map((name): Wanted => [name, 'numbered', analysisCurve(analysis, name)])),
  ];
}

/** True course [deg], where the vehicle moves. */
function courseOf(flight: Flight): Curve | undefined {
  const minSpeed_m_s = 2;
  return unwrapped(groundVelocity(flight, ([n, e]) => Math.hypot(n, e) > minSpeed_m_s ? Math.atan2(e, n) * DEG_PER_RAD : NaN));
}

function some(curve: Curve | undefined): Curve | undefined {
  return curve?.y.some((value) => Number.isFinite(value) && value !== 0) ? curve : undefined;
}

function air(flight: Flight): Chart[] {
  return [
    ...['north', 'east'].map((name, k) => chart(`Wind, to the ${name}`, 'm/s', [
      ['true', 'actual', field(flight, VEHICLE, `wind.${AXES[k]}`)],
      ['estimate', 'estimate', some(field(flight, ESTIMATE, `wind[${k}]`))]])),
    chart('Airspeed', 'm/s', [['measured', 'actual', field(flight, '/airspeed', 'velocity')],
      ['estimate', 'estimate', some(field(flight, ESTIMATE, 'airspeed'))]]),
    chart('Barometer', 'Pa', [['pressure', 'actual', field(flight, '/baro', 'pressure')]]),
  ];
}

function firmware(flight: Flight): Chart[] {
  return [
    chart('Receiver channels', 'µs', numbered(flight, '/rc_raw', 'values', 8)),
    chart('Duration of the control part of a pass', 'µs', [['pass', 'actual', field(flight, '/status', 'loop_time_us')]]),
    chart('Gyro', '°/s', AXES.map((a): Wanted => [a, 'numbered', field(flight, '/imu/data', `angular_velocity.${a}`, DEG_PER_RAD)])),
    chart('Accelerometer', 'm/s²', AXES.map((a): Wanted => [a, 'numbered', field(flight, '/imu/data', `linear_acceleration.${a}`)])),
  ];
}
