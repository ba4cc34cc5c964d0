// SPDX-License-Identifier: BSD-3-Clause
// A running flight as it comes over a WebSocket in the Foxglove protocol v1: channels with the same definitions and the same
// bytes as in a log.
import {Flight} from './flight.ts';
import {Fields, secondsBetween, type Stamp} from './mcap_records.ts';
import {parseSchema, type MessageType} from './ros_schema.ts';

export const PROTOCOLS = ['foxglove.websocket.v1', 'foxglove.sdk.v1'];
const MESSAGE_DATA = 1;

interface Advertised { id: number; topic: string; encoding: string; schemaName: string; schema: string; schemaEncoding?: string }

/** Makes a flight of what the server sends. One for each connection. */
export class LiveDecoder {
  readonly flight: Flight;
  private readonly channels = new Map<number, {topic: string; type: MessageType}>();
  private start: Stamp | undefined;

  constructor(name: string) { this.flight = new Flight(name); }

  /** @returns what to answer, if anything. @throws Error  it is no message of the protocol. */
  text(message: string): string | undefined {
    const {op, channels} = JSON.parse(message) as {op?: string; channels?: Advertised[]};
    if (op !== 'advertise' || !channels) return undefined;
    const readable = channels.filter(({encoding, schemaEncoding}) => encoding === 'cdr' && (schemaEncoding ?? 'ros2msg') === 'ros2msg');
    for (const {id, topic, schemaName, schema} of readable) this.channels.set(id, {topic, type: parseSchema(schemaName, schema)});
    // The subscription has the number of its channel.
    return JSON.stringify({op: 'subscribe', subscriptions: readable.map(({id}) => ({id, channelId: id}))});
  }

  /** @throws Error, RangeError  it is damaged. */
  binary(message: Uint8Array) {
    const fields = new Fields(message);
    if (fields.byte() !== MESSAGE_DATA) return;
    const channel = this.channels.get(fields.word());
    const time = fields.stamp();
    this.start ??= time;
    if (channel) this.flight.add(channel.topic, channel.type, secondsBetween(this.start, time), fields.rest());
  }
}
