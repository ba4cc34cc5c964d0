// SPDX-License-Identifier: BSD-3-Clause
// Reads messages in the common data representation of ROS 2 (classic CDR): four bytes of encapsulation, then each value
// padded to a multiple of its size, counted from the end of those four. messages/cdr.hpp is the other side.
import type {Field, MessageType, NumberKind} from './ros_schema.ts';

export type Value = number | string | Value[] | {[field: string]: Value};

/** One field of all messages. */
export interface Column { values: Float64Array<ArrayBuffer> }

/** Where reading is within one message. Reading past its end throws a RangeError. */
export class CdrCursor {
  private view!: DataView; // of all that the bytes are part of: messages of one chunk share it
  private start = 0; // of the message
  private size = 0;
  private little = true;
  private offset = 4;

  /** @throws Error  the encapsulation is not that of classic CDR. */
  constructor(message: Uint8Array) { this.open(message); }

  /** Another message, from its start. @throws as the constructor. */
  open(message: Uint8Array) {
    if (this.view?.buffer !== message.buffer) this.view = new DataView(message.buffer);
    this.start = message.byteOffset;
    this.size = message.byteLength;
    this.offset = 0;
    const kind = this.view.getUint16(this.next(2));
    if (kind > 1) throw new Error(`encapsulation ${kind}, known are 0 and 1 (classic CDR)`);
    this.little = kind === 1;
    this.offset = 4;
  }

  number(kind: NumberKind): number {
    const {view, little} = this;
    this.offset = aligned(this.offset, SIZE[kind]);
    const at = this.next(SIZE[kind]);
    switch (kind) {
      case 'float64': return view.getFloat64(at, little);
      case 'float32': return view.getFloat32(at, little);
      case 'bool': case 'uint8': return view.getUint8(at);
      case 'int8': return view.getInt8(at);
      case 'uint16': return view.getUint16(at, little);
      case 'int16': return view.getInt16(at, little);
      case 'uint32': return view.getUint32(at, little);
      case 'int32': return view.getInt32(at, little);
      case 'uint64': return Number(view.getBigUint64(at, little)); // exact to 2^53
      case 'int64': return Number(view.getBigInt64(at, little));
    }
  }

  /** So many numbers of a kind, each into this row of its column. */
  numbers(kind: NumberKind, columns: readonly Column[], count: number, row: number) {
    if (kind !== 'float32' && kind !== 'float64') {
      for (let k = 0; k < count; ++k) columns[k]!.values[row] = this.number(kind);
    } else if (count > 0) { // most of what a log has: a loop without a choice in it
      const {view, little} = this;
      const size = SIZE[kind];
      this.offset = aligned(this.offset, size);
      let at = this.next(count * size);
      if (kind === 'float32') for (let k = 0; k < count; ++k, at += size) columns[k]!.values[row] = view.getFloat32(at, little);
      else for (let k = 0; k < count; ++k, at += size) columns[k]!.values[row] = view.getFloat64(at, little);
    }
  }

  /** Passes so many bytes. @returns where they are in the view. */
  private next(bytes: number): number {
    const at = this.start + this.offset;
    this.offset += bytes;
    if (this.offset > this.size) throw new RangeError(`message of ${this.size} bytes ends before byte ${this.offset}`);
    return at;
  }

  /** @param expected  if this ASCII text is the next one, no other is made. */
  text(expected?: string): string {
    const length = this.number('uint32'); // with the NUL at the end
    const at = this.next(length);
    if (expected !== undefined && this.holds(expected, at, length - 1)) return expected;
    return TEXT.decode(new Uint8Array(this.view.buffer, at, Math.max(length - 1, 0)));
  }

  private holds(text: string, at: number, length: number): boolean {
    if (text.length !== length) return false;
    for (let k = 0; k < length; ++k) {
      const byte = this.view.getUint8(at + k);
      if (byte !== text.charCodeAt(k) || byte > ASCII) return false;
    }
    return true;
  }

  /** How many elements of a field follow. */
  count(field: Field): number {
    if (field.count !== 'sequence') return field.count ?? 1;
    const count = this.number('uint32');
    if (count > this.size) throw new RangeError(`message of ${this.size} bytes cannot hold a sequence of ${count}`);
    return count;
  }

  /** Over `count` numbers of this size. */
  skip(count: number, size: number) {
    if (count === 0) return;
    this.offset = aligned(this.offset, size);
    this.next(count * size);
  }
}

const TEXT = new TextDecoder();
const ASCII = 0x7f;
export const SIZE: Record<NumberKind, number> = {
  bool: 1, int8: 1, uint8: 1, int16: 2, uint16: 2, int32: 4, uint32: 4, int64: 8, uint64: 8, float32: 4, float64: 8,
};

/** Sizes are powers of 2. */
function aligned(offset: number, size: number): number {
  return (offset - 4 + size - 1 & -size) + 4;
}

/** The whole message as nested objects, for what comes seldom. @throws Error, RangeError  it is damaged. */
export function readMessage(type: MessageType, message: Uint8Array): {[field: string]: Value} {
  return readFields(type, new CdrCursor(message));
}

function readFields(type: MessageType, cursor: CdrCursor): {[field: string]: Value} {
  return Object.fromEntries(type.fields.map((field) => [field.name, readField(field, cursor)]));
}

function readField(field: Field, cursor: CdrCursor): Value {
  if (field.count === undefined) return readOne(field.type, cursor);
  const values: Value[] = []; // grows with what is there: a count alone reserves nothing
  for (let left = cursor.count(field); left > 0; --left) values.push(readOne(field.type, cursor));
  return values;
}

function readOne(type: Field['type'], cursor: CdrCursor): Value {
  if (type === 'string') return cursor.text();
  return typeof type === 'string' ? cursor.number(type) : readFields(type, cursor);
}
