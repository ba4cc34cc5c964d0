// SPDX-License-Identifier: BSD-3-Clause
// What is known of one flight, message by message: from a log all at once, from a running one as it comes.
import type {Analysis} from './analysis.ts';
import {between, type Quaternion, type Triple} from './attitude.ts';
import {readMessage, type Value} from './cdr.ts';
import type {MessageType} from './ros_schema.ts';
import {lastAtOrBefore, Table} from './table.ts';

export type Tone = 'good' | 'note' | 'warning' | 'bad' | 'neutral';
export interface FlightEvent { t: number; tone: Tone; source: string; text: string }
export interface Pose { p: Triple; q: Quaternion }

/** Which fields of a topic are a position in north-east-down [m] and an attitude. */
export interface PoseTopic { topic: string; position: readonly string[]; attitude: readonly string[] }

/** In the order in which they are believed: the truth of a simulation, the companion's estimate, the firmware's, which has no position. */
export const POSE_TOPICS: readonly PoseTopic[] = [
  {topic: '/sim/truth_state', position: ['x', 'y', 'z'].map((a) => `pose.position.${a}`),
    attitude: ['w', 'x', 'y', 'z'].map((a) => `pose.orientation.${a}`)},
  {topic: '/autonomy/estimate', position: [0, 1, 2].map((k) => `position[${k}]`),
    attitude: [0, 1, 2, 3].map((k) => `attitude[${k}]`)},
  {topic: '/attitude', position: [], attitude: ['w', 'x', 'y', 'z'].map((a) => `attitude.${a}`)},
];
export const ESTIMATE = POSE_TOPICS[1]!;
/** What the estimate is corrected by, in the order of its fields `innovation` and `refusing`. */
export const AIDS = ['GNSS horizontal', 'GNSS altitude', 'GNSS velocity', 'barometer', 'heading', 'range', 'pitot', 'sideslip', 'rest'];

/** Bytes for other programs, which nobody plots. */
const BULK = new Set(['rosflight_log_msgs/RawFrames', 'rosflight_log_msgs/BoardInputs', 'tf2_msgs/TFMessage']);

/** The picture of the start has the vehicle in it, whose first pose comes a step later. */
const AT_START_S = 0.05;

const FIXED_WING = 1; // Heartbeat.FIXED_WING

export class Flight {
  readonly name: string;
  readonly tables = new Map<string, Table>();
  readonly events: FlightEvent[] = [];
  /** Planned paths, each from its moment on; points in north-east-down [m]. */
  readonly plans: {t: number; points: Triple[]}[] = [];
  /** Vehicle as ROS tools draw it. */
  urdf = '';
  /** The vehicle file in force, each from its moment on. */
  readonly settings: {t: number; text: string}[] = [];
  facts = new Map<string, string>();
  /** What its folder says beside the log. */
  analysis: Analysis | undefined;
  /** What the reader of the log has to say to the user, such as that it ends early. */
  readonly notes: string[] = [];
  end_s = 0;
  /** About how many messages of a topic will come, where it is known. */
  readonly expected = new Map<string, number>();

  constructor(name: string) { this.name = name; }

  /** Adds a message. @throws Error, RangeError  it is damaged. */
  add(topic: string, type: MessageType, t: number, data: Uint8Array) {
    this.end_s = Math.max(this.end_s, t);
    if (BULK.has(type.name)) return;
    if (topic === '/rosout') this.events.push(textEvent(t, readMessage(type, data)));
    else if (topic === '/robot_description') this.urdf = String(readMessage(type, data)['data'] ?? '');
    else if (topic === '/settings') this.settings.push({t, text: String(readMessage(type, data)['data'] ?? '')});
    else if (topic === '/autonomy/path') this.plans.push({t, points: pathPoints(readMessage(type, data))});
    else this.table(topic, type).add(t, data);
  }

  /** The first pose topic that the flight has. */
  get poseTopic(): PoseTopic | undefined {
    return POSE_TOPICS.find(({topic}) => (this.tables.get(topic)?.length ?? 0) > 0);
  }

  /** As its heartbeat says. */
  get fixedWing(): boolean {
    return this.tables.get('/link/heartbeat')?.column('vehicle_type')?.includes(FIXED_WING) ?? false;
  }

  /** Between the two messages around `t`; undefined long before the first one and without any. */
  poseAt(t: number, from = this.poseTopic): Pose | undefined {
    const table = from && this.tables.get(from.topic);
    if (!table || table.length === 0) return undefined;
    const row = Math.max(lastAtOrBefore(table.times, table.length, t), table.times[0]! - t < AT_START_S ? 0 : -1);
    if (row < 0) return undefined;
    const next = Math.min(row + 1, table.length - 1);
    const span = table.times[next]! - table.times[row]!;
    const share = span > 0 ? Math.min((t - table.times[row]!) / span, 1) : 0;
    const cell = (name: string, at: number) => table.column(name)?.[at] ?? NaN;
    const p = from.position.length === 0 ? [0, 0, 0] : from.position.map((name) => cell(name, row) + share * (cell(name, next) - cell(name, row)));
    const q = [row, next].map((at) => from.attitude.map((name) => cell(name, at)) as unknown as Quaternion);
    return {p: p as unknown as Triple, q: between(q[0]!, q[1]!, share)};
  }

  valueAt(topic: string, field: string, t: number): number { return this.tables.get(topic)?.valueAt(field, t) ?? NaN; }

  /** The value of the latest message, without a mean between two. */
  latest(topic: string, field: string, t: number): number {
    const table = this.tables.get(topic);
    const row = table?.rowAt(t) ?? -1;
    return row < 0 ? NaN : table?.column(field)?.[row] ?? NaN;
  }

  private table(topic: string, type: MessageType): Table {
    let table = this.tables.get(topic);
    if (!table) this.tables.set(topic, table = new Table(type, this.expected.get(topic)));
    return table;
  }
}

const LEVEL = {warning: 30, error: 40}; // rcl_interfaces/Log

function textEvent(t: number, message: {[field: string]: Value}): FlightEvent {
  const level = Number(message['level']);
  const tone = level >= LEVEL.error ? 'bad' : level >= LEVEL.warning ? 'warning' : 'note';
  return {t, tone, source: String(message['name']), text: String(message['msg'])};
}

/** nav_msgs/Path is in east-north-up. */
function pathPoints(message: {[field: string]: Value}): Triple[] {
  return (message['poses'] as Value[]).map((stamped) => {
    const at = ((stamped as {pose: {position: {x: number; y: number; z: number}}}).pose).position;
    return [at.y, at.x, -at.z];
  });
}
