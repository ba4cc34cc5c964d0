// SPDX-License-Identifier: BSD-3-Clause
// All messages of one topic as columns: a plot needs one field of thousands of messages, never one whole message.
import {CdrCursor, SIZE, type Column} from './cdr.ts';
import type {Field, MessageType} from './ros_schema.ts';

/** Elements of a sequence that become columns. More is data that nobody plots. */
const MAX_ELEMENTS = 16;
const FIRST_ROOM = 64;

const NOTHING = new Uint8Array(4);

type Reader = (cursor: CdrCursor, row: number) => void;

/** Columns are named as in the definition: `pose.position.x`, `u[3]`. Rows are in the order in which they were added. */
export class Table {
  readonly type: MessageType;
  /** Time of each row [s], from the start of the log; longer than the table: see `length`. */
  times: Float64Array<ArrayBuffer>;
  length = 0;
  private readonly numbers = new Map<string, Column>();
  private readonly texts = new Map<string, string[]>();
  private readonly readers: Reader[];
  private readonly cursor = new CdrCursor(NOTHING);

  /** @param rows  about how many will come. */
  constructor(type: MessageType, rows = 0) {
    this.type = type;
    this.times = new Float64Array(Math.max(rows, FIRST_ROOM));
    this.readers = this.readersOf(type, '');
  }

  /** Adds a message. @throws Error, RangeError  it is damaged; the table is then as before. */
  add(time_s: number, message: Uint8Array) {
    const row = this.length;
    if (row === this.times.length) this.grow();
    const {cursor} = this;
    cursor.open(message);
    for (const read of this.readers) read(cursor, row);
    this.times[row] = time_s;
    this.length = row + 1;
  }

  /** Names of the columns with numbers, in the order of the definition. */
  get names(): string[] { return [...this.numbers.keys()]; }

  /** Values of a column, NaN where a message had no such element; undefined if there is no such column. */
  column(name: string): Float64Array | undefined { return this.numbers.get(name)?.values.subarray(0, this.length); }

  text(name: string): string[] | undefined { return this.texts.get(name); }

  /** The row at or before a time, -1 before the first. */
  rowAt(time_s: number): number { return lastAtOrBefore(this.times, this.length, time_s); }

  /** A value between rows, linear; outside the rows the first or last, NaN without any. */
  valueAt(name: string, time_s: number): number {
    const values = this.numbers.get(name)?.values;
    if (!values || this.length === 0) return NaN;
    const row = Math.max(this.rowAt(time_s), 0);
    const next = Math.min(row + 1, this.length - 1);
    const span = this.times[next]! - this.times[row]!;
    const share = span > 0 ? Math.min(Math.max((time_s - this.times[row]!) / span, 0), 1) : 0;
    return share === 0 ? values[row]! : values[row]! + share * (values[next]! - values[row]!);
  }

  private grow() {
    const room = 2 * this.times.length;
    this.times = widened(this.times, room);
    for (const column of this.numbers.values()) column.values = widened(column.values, room);
  }

  /** No number in the rows before this one. */
  private newColumn(name: string, row = 0): Column {
    const column = {values: new Float64Array(this.times.length).fill(NaN, 0, row)};
    this.numbers.set(name, column);
    return column;
  }

  private readersOf(type: MessageType, prefix: string): Reader[] {
    return type.fields.flatMap((field) => this.readersOfField(field, prefix + field.name));
  }

  private readersOfField(field: Field, path: string): Reader[] {
    const {type} = field;
    if (typeof type === 'object') {
      if (field.count === undefined) return this.readersOf(type, path + '.');
      return [(cursor) => { for (let left = cursor.count(field); left > 0; --left) pass(type, cursor); }];
    }
    if (type === 'string') {
      if (field.count !== undefined) {
        return [(cursor) => { for (let left = cursor.count(field); left > 0; --left) cursor.text(); }];
      }
      const list: string[] = [];
      this.texts.set(path, list);
      return [(cursor, row) => { list[row] = cursor.text(list[row - 1]); }];
    }
    if (field.count === undefined) {
      const column = this.newColumn(path);
      return [(cursor, row) => { column.values[row] = cursor.number(type); }];
    }
    const columns: Column[] = [];
    return [(cursor, row) => {
      const count = cursor.count(field);
      const kept = Math.min(count, MAX_ELEMENTS);
      while (columns.length < kept) columns.push(this.newColumn(`${path}[${columns.length}]`, row));
      cursor.numbers(type, columns, kept, row);
      cursor.skip(count - kept, SIZE[type]);
      for (let k = kept; k < columns.length; ++k) columns[k]!.values[row] = NaN;
    }];
  }
}

function pass(type: MessageType, cursor: CdrCursor) {
  for (const field of type.fields) {
    const inner = field.type;
    const count = cursor.count(field);
    if (typeof inner === 'object') for (let k = 0; k < count; ++k) pass(inner, cursor);
    else if (inner === 'string') for (let k = 0; k < count; ++k) cursor.text();
    else cursor.skip(count, SIZE[inner]);
  }
}

function widened(values: Float64Array, room: number): Float64Array<ArrayBuffer> {
  const wider = new Float64Array(room);
  wider.set(values);
  return wider;
}

/** Index of the last of the first `length` sorted values that is not above `value`, -1 if all are. */
export function lastAtOrBefore(sorted: ArrayLike<number>, length: number, value: number): number {
  let low = -1;
  let high = length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (sorted[middle]! <= value) low = middle;
    else high = middle;
  }
  return low;
}
