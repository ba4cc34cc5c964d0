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
  return placesOf(bytes).map(({op, start, end}) => ({op, body: bytes.subarray(start, end)}));
}

/** Where they are. @throws RangeError  the last one is cut off. */
export function placesOf(bytes: Uint8Array): {op: number; start: number; end: number}[] {
  const HEAD_BYTES = 9;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const places = [];
  for (let at = 0; at < bytes.length;) {
    if (at + HEAD_BYTES > bytes.length) throw new RangeError('a record is cut off');
    const start = at + HEAD_BYTES;
    const end = start + view.getUint32(at + 1, true);
    if (view.getUint32(at + 5, true) !== 0 || end > bytes.length) throw new RangeError('a record is cut off');
    places.push({op: view.getUint8(at), start, end});
    at = end;
  }
  return places;
}
