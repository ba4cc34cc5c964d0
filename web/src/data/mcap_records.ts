// SPDX-License-Identifier: BSD-3-Clause
// Records of MCAP and what they consist of: little-endian numbers, texts with their length.

/** A moment as in the file [ns since 1970], exact, which one double is not. */
export interface Stamp { high: number; low: number }

/** @returns seconds from one moment to another, exact to the nanosecond within 100 days. */
export function secondsBetween(from: Stamp, to: Stamp): number {
  return ((to.high - from.high) * 2 ** 32 + (to.low - from.low)) / 1e9;
}

/** Reads the fields of a record one after the other. Reading past its end throws a RangeError. */
export class Fields {
  private readonly all: Uint8Array;
  private readonly view: DataView;
  private offset = 0;

  constructor(bytes: Uint8Array) {
    this.all = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  byte(): number { return this.view.getUint8(this.advance(1)); }
  short(): number { return this.view.getUint16(this.advance(2), true); }
  word(): number { return this.view.getUint32(this.advance(4), true); }
  stamp(): Stamp {
    const low = this.word();
    return {low, high: this.word()};
  }
  /** A 64-bit length or offset. @throws RangeError  larger than any file. */
  size(): number {
    const {low, high} = this.stamp();
    if (high >= 2 ** 20) throw new RangeError('a length of more than 2^52 bytes');
    return high * 2 ** 32 + low;
  }
  text(): string { return TEXT.decode(this.bytes(this.word())); }
  textMap(): Map<string, string> {
    const end = this.word() + this.offset;
    const map = new Map<string, string>();
    while (this.offset < end) map.set(this.text(), this.text());
    return map;
  }
  bytes(length: number): Uint8Array {
    const start = this.advance(length);
    return this.all.subarray(start, start + length);
  }
  rest(): Uint8Array { return this.all.subarray(this.offset); }
  skip(length: number) { this.advance(length); }

  private advance(length: number): number {
    const start = this.offset;
    if (start + length > this.all.length) throw new RangeError(`record of ${this.all.length} bytes ends too early`);
    this.offset = start + length;
    return start;
  }
}

const TEXT = new TextDecoder();

/** The records in a piece of a file. @throws RangeError  the last one is cut off. */
export function recordsOf(bytes: Uint8Array): {op: number; body: Uint8Array}[] {
  const records = [];
  for (const place = new Place(bytes); place.next();) records.push({op: place.op, body: bytes.subarray(place.start, place.end)});
  return records;
}

/** Goes from record to record, a million of them in a long flight, and makes no object for each. */
export class Place {
  op = 0;
  start = 0;
  end = 0;
  readonly view: DataView;

  constructor(bytes: Uint8Array) { this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength); }

  /** @returns whether there is one more. @throws RangeError  it is cut off. */
  next(): boolean {
    const HEAD_BYTES = 9;
    const {view, end: at} = this;
    if (at === view.byteLength) return false;
    if (at + HEAD_BYTES > view.byteLength) throw new RangeError('a record is cut off');
    this.op = view.getUint8(at);
    this.start = at + HEAD_BYTES;
    this.end = this.start + view.getUint32(at + 1, true);
    if (view.getUint32(at + 5, true) !== 0 || this.end > view.byteLength) throw new RangeError('a record is cut off');
    return true;
  }
}
