// SPDX-License-Identifier: BSD-3-Clause
import type {ByteSource} from './bytes.ts';
import {Flight} from './flight.ts';
import {McapLog, type Channel} from './mcap.ts';
import {secondsBetween, type Stamp} from './mcap_records.ts';
import {parseSchema, type MessageType} from './ros_schema.ts';

/** [B] Compressed; ours have 90. A file that says it has more messages than fit into it is not believed: the room for them grows then as they come. */
const SMALLEST_MESSAGE = 16;

/**
 * A whole log as a flight. What cannot be read of it is left out and said in Flight.notes.
 * @throws Error  it is no MCAP file, or has no message that the page can read.
 */
export async function readLog(source: ByteSource, progress?: (share: number) => Promise<void> | void): Promise<Flight> {
  const log = await McapLog.open(source);
  const flight = new Flight(source.name);
  const types = new Map<number, MessageType | null>();
  const unread = new Set<string>();
  const said = [...log.counts.values()].reduce((sum, count) => sum + count, 0);
  for (const [id, count] of said * SMALLEST_MESSAGE <= source.size ? log.counts : []) {
    const topic = log.channels.get(id)?.topic;
    if (topic) flight.expected.set(topic, (flight.expected.get(topic) ?? 0) + count);
  }
  let start: Stamp | undefined;
  let count = 0;
  try {
    await log.readMessages((channel, time, data) => {
      start ??= time;
      const type = typeOf(log, channel, types);
      if (!type) {
        unread.add(channel.topic);
        return;
      }
      flight.add(channel.topic, type, secondsBetween(start, time), data);
      ++count;
    }, progress);
  } catch (error) {
    if (count === 0) throw error;
    flight.notes.push(`The log is damaged after ${flight.end_s.toFixed(1)} s: ${(error as Error).message}.`);
  }
  if (count === 0) throw new Error(`${source.name}: has no ROS 2 message (cdr, ros2msg)`);
  if (!log.complete) flight.notes.push(`The log has no end: it was read as far as it goes, ${flight.end_s.toFixed(1)} s.`);
  if (unread.size > 0) flight.notes.push(`Not read, in another encoding: ${[...unread].join(', ')}.`);
  flight.facts = log.metadata.get('flight') ?? new Map();
  return flight;
}

function typeOf(log: McapLog, channel: Channel, known: Map<number, MessageType | null>): MessageType | null {
  const found = known.get(channel.id);
  if (found !== undefined) return found;
  const schema = log.schemas.get(channel.schemaId);
  const readable = schema && channel.encoding === 'cdr' && schema.encoding === 'ros2msg';
  const type = readable ? parseSchema(schema.name, schema.text) : null;
  known.set(channel.id, type);
  return type;
}
