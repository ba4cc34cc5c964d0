// SPDX-License-Identifier: BSD-3-Clause
// Reads MCAP files: the index first, then one chunk after the other. A file without its end, as a power cut leaves it, is
// read from its start as far as it goes. Format: the MCAP specification; log/mcap_file.hpp writes ours.
import type {ByteSource} from './bytes.ts';
import {Fields, Place, recordsOf, type Stamp} from './mcap_records.ts';
import {unpackZstd} from './zstd.ts';

export interface Schema { id: number; name: string; encoding: string; text: string }
export interface Channel { id: number; schemaId: number; topic: string; encoding: string }
export interface Attachment { name: string; mediaType: string; bytes: Uint8Array }
interface ByteRange { offset: number; length: number }

/** Called for each message; `data` is valid during the call. */
export type UseMessage = (channel: Channel, time: Stamp, data: Uint8Array) => void;

const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
const OP = {
  footer: 2, schema: 3, channel: 4, message: 5, chunk: 6, chunkIndex: 8, attachment: 9, attachmentIndex: 10, statistics: 11, metadata: 12,
  metadataIndex: 13, dataEnd: 15,
};
const HEAD_BYTES = 9; // opcode and length of a record
const MESSAGE_HEAD_BYTES = 22; // channel, number, time of the log, time of sending
const LOG_TIME_AT = 6;
const FOOTER_BYTES = HEAD_BYTES + 20;
const MAX_CHUNK = 256 << 20;
const READ_AT_ONCE = 4 << 20;

export class McapLog {
  readonly source: ByteSource;
  readonly schemas = new Map<number, Schema>();
  readonly channels = new Map<number, Channel>();
  readonly metadata = new Map<string, Map<string, string>>();
  readonly attachments: Attachment[] = [];
  /** How many messages each channel is said to have; by a file with its end. */
  readonly counts = new Map<number, number>();
  /** Whether the file has its end. */
  complete = false;
  private chunks: ByteRange[] = [];

  private constructor(source: ByteSource) { this.source = source; }

  /** Reads what is needed before messages can be. @throws Error  unreadable, or no MCAP file. */
  static async open(source: ByteSource): Promise<McapLog> {
    const log = new McapLog(source);
    const head = await source.read(0, Math.min(source.size, MAGIC.length));
    if (!isMagic(head)) throw new Error(`${source.name}: is no MCAP file`);
    if (await log.readIndex()) log.complete = true;
    else await log.findRecords();
    return log;
  }

  /**
   * Calls `use` for every message, in the order of the file, and `progress` after each chunk with the share done.
   * @throws Error  the file is damaged. A chunk is used whole or not at all.
   */
  async readMessages(use: UseMessage, progress: (share: number) => Promise<void> | void = () => {}) {
    const blocks = this.blocks();
    const read = (k: number) => {
      const block = blocks[k];
      const bytes = block && this.source.read(block.offset, block.length);
      bytes?.catch(() => {}); // reported when it is its turn
      return bytes;
    };
    let ahead = read(0);
    let done = 0;
    for (const [k, {offset, chunks}] of blocks.entries()) {
      const bytes = await ahead!;
      ahead = read(k + 1); // comes while this one is unpacked
      for (const chunk of chunks) {
        const from = chunk.offset - offset;
        this.useRecords(await this.unpacked(bytes.subarray(from + HEAD_BYTES, from + chunk.length)), use);
        await progress(++done / this.chunks.length);
      }
    }
  }

  /** Chunks that are read at once. */
  private blocks(): (ByteRange & {chunks: ByteRange[]})[] {
    const blocks: (ByteRange & {chunks: ByteRange[]})[] = [];
    for (const chunk of this.chunks) {
      const last = blocks.at(-1);
      const length = last ? chunk.offset + chunk.length - last.offset : Infinity;
      if (last && chunk.offset >= last.offset && length <= READ_AT_ONCE) {
        last.chunks.push(chunk);
        last.length = Math.max(last.length, length);
      } else blocks.push({...chunk, chunks: [chunk]});
    }
    return blocks;
  }

  /** @returns whether there is one. */
  private async readIndex(): Promise<boolean> {
    const {source} = this;
    if (source.size < 2 * MAGIC.length + FOOTER_BYTES) return false;
    const end = await source.read(source.size - FOOTER_BYTES - MAGIC.length, FOOTER_BYTES + MAGIC.length);
    if (!isMagic(end.subarray(FOOTER_BYTES)) || end[0] !== OP.footer) return false;
    const start = new Fields(end.subarray(HEAD_BYTES)).size();
    const summaryEnd = source.size - FOOTER_BYTES - MAGIC.length;
    if (start === 0 || start > summaryEnd) return false;
    const others: ByteRange[] = [];
    for (const {op, body} of recordsOf(await source.read(start, summaryEnd - start))) {
      const fields = new Fields(body);
      if (op === OP.chunkIndex) {
        fields.skip(16);
        this.chunks.push({offset: fields.size(), length: fields.size()});
      } else if (op === OP.attachmentIndex || op === OP.metadataIndex) {
        others.push({offset: fields.size(), length: fields.size()});
      } else this.take(op, body);
    }
    for (const {offset, length} of others) {
      for (const {op, body} of recordsOf(await source.read(offset, length))) this.take(op, body);
    }
    return true;
  }

  /** Goes through a file without index, from record to record, until it ends. */
  private async findRecords() {
    const {source} = this;
    let offset = MAGIC.length;
    while (offset + HEAD_BYTES <= source.size) {
      const head = new Fields(await source.read(offset, HEAD_BYTES));
      const op = head.byte();
      const length = head.size();
      if (offset + HEAD_BYTES + length > source.size) break;
      if (op === OP.chunk) this.chunks.push({offset, length: HEAD_BYTES + length});
      else if (op === OP.dataEnd) this.complete = true; // it has all its messages, only no index
      else if (op === OP.attachment || op === OP.metadata) this.take(op, await source.read(offset + HEAD_BYTES, length));
      offset += HEAD_BYTES + length;
    }
  }

  private useRecords(records: Uint8Array, use: UseMessage) {
    for (const all = new Place(records); all.next();); // a damaged one is found before the first is used
    const place = new Place(records);
    const {view} = place;
    while (place.next()) {
      const {op, start, end} = place;
      if (op !== OP.message) {
        this.take(op, records.subarray(start, end));
        continue;
      }
      if (end - start < MESSAGE_HEAD_BYTES) throw new RangeError(`record of ${end - start} bytes ends too early`);
      const channel = this.channels.get(view.getUint16(start, true));
      const time = {low: view.getUint32(start + LOG_TIME_AT, true), high: view.getUint32(start + LOG_TIME_AT + 4, true)};
      if (channel) use(channel, time, records.subarray(start + MESSAGE_HEAD_BYTES, end));
    }
  }

  private take(op: number, body: Uint8Array) {
    const fields = new Fields(body);
    if (op === OP.schema) {
      const id = fields.short();
      this.schemas.set(id, {id, name: fields.text(), encoding: fields.text(), text: fields.text()});
    } else if (op === OP.channel) {
      const id = fields.short();
      this.channels.set(id, {id, schemaId: fields.short(), topic: fields.text(), encoding: fields.text()});
    } else if (op === OP.statistics) {
      const BEFORE = 42; // number of each kind of record, the first and the last time
      fields.skip(BEFORE);
      const ENTRY = 10;
      for (let left = Math.floor(fields.word() / ENTRY); left > 0; --left) this.counts.set(fields.short(), fields.size());
    } else if (op === OP.metadata) {
      this.metadata.set(fields.text(), fields.textMap());
    } else if (op === OP.attachment) {
      fields.skip(16);
      this.attachments.push({name: fields.text(), mediaType: fields.text(), bytes: fields.bytes(fields.size())});
    }
  }

  private async unpacked(chunk: Uint8Array): Promise<Uint8Array> {
    const fields = new Fields(chunk);
    fields.skip(16);
    const size = fields.size();
    fields.skip(4);
    const compression = fields.text();
    const packed = fields.bytes(fields.size());
    if (size > MAX_CHUNK) throw new Error(`${this.source.name}: a chunk of ${size} bytes, at most ${MAX_CHUNK}`);
    if (compression === '') return packed;
    if (compression !== 'zstd') throw new Error(`${this.source.name}: compressed by '${compression}', known are none and zstd`);
    const records = (await unpackZstd())(packed, size);
    if (records.length !== size) throw new Error(`${this.source.name}: a chunk is damaged`);
    return records;
  }
}

function isMagic(bytes: Uint8Array): boolean {
  return bytes.length >= MAGIC.length && MAGIC.every((value, k) => bytes[k] === value);
}
