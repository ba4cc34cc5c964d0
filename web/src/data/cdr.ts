// SPDX-License-Identifier: BSD-3-Clause
// Reads messages in the common data representation of ROS 2 (classic CDR): four bytes of encapsulation, then each value
// padded to a multiple of its size, counted from the end of those four. messages/cdr.hpp is the other side.
import type {Field, MessageType, NumberKind} from './ros_schema.ts';

export type Value = number | string | Value[] | {[field: string]: Value};

/** Where reading is within one message. Reading past its end throws a RangeError. */
export class CdrCursor {
  private view!: DataView;
  private bytes!: Uint8Array;
  private little = true;
  private offset = 4;

  /** @throws Error  the encapsulation is not that of classic CDR. */
  constructor(message: Uint8Array) { this.open(message); }

  /** Another message, from its start. @throws as the constructor. */
  open(message: Uint8Array) {
    this.offset = 4;
    this.bytes = message;
    this.view = new DataView(message.buffer, message.byteOffset, message.byteLength);
    const kind = this.view.getUint16(0);
    if (kind > 1) throw new Error(`encapsulation ${kind}, known are 0 and 1 (classic CDR)`);
    this.little = kind === 1;
  }

  number(kind: NumberKind): number {
    const at = this.offset = aligned(this.offset, SIZE[kind]);
    this.offset += SIZE[kind];
    switch (kind) {
      case 'float64': return this.view.getFloat64(at, this.little);
      case 'float32': return this.view.getFloat32(at, this.little);
      case 'bool': case 'uint8': return this.view.getUint8(at);
      case 'int8': return this.view.getInt8(at);
      case 'uint16': return this.view.getUint16(at, this.little);
      case 'int16': return this.view.getInt16(at, this.little);
      case 'uint32': return this.view.getUint32(at, this.little);
      case 'int32': return this.view.getInt32(at, this.little);
      case 'uint64': return Number(this.view.getBigUint64(at, this.little)); // exact to 2^53
      case 'int64': return Number(this.view.getBigInt64(at, this.little));
    }
  }

  /** @param expected  if this ASCII text is the next one, no other is made. */
  text(expected?: string): string {
    const length = this.number('uint32'); // with the NUL at the end
    const start = this.offset;
    this.skip(length, 1);
    if (expected !== undefined && this.holds(expected, start, length - 1)) return expected;
    return TEXT.decode(this.bytes.subarray(start, start + Math.max(length - 1, 0)));
  }

  private holds(text: string, start: number, length: number): boolean {
    if (text.length !== length) return false;
    for (let k = 0; k < length; ++k) {
      const byte = this.bytes[start + k]!;
      if (byte !== text.charCodeAt(k) || byte > ASCII) return false;
    }
    return true;
  }

  /** How many elements of a field follow. */
  count(field: Field): number {
    if (field.count !== 'sequence') return field.count ?? 1;
    const count = this.number('uint32');
    const size = this.view.byteLength;
    if (count > size) throw new RangeError(`message of ${size} bytes cannot hold a sequence of ${count}`);
    return count;
  }

  /** Over `count` numbers of this size. */
  skip(count: number, size: number) {
    if (count === 0) return;
    const end = aligned(this.offset, size) + count * size;
    if (end > this.view.byteLength) throw new RangeError(`message of ${this.view.byteLength} bytes ends before byte ${end}`);
    this.offset = end;
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
