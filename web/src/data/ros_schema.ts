// SPDX-License-Identifier: BSD-3-Clause
// Message definitions in the text form that MCAP calls ros2msg: the message, then every message it uses, each after a line
// of '=' and a line 'MSG: package/Name'.

export type NumberKind = 'bool' | 'int8' | 'uint8' | 'int16' | 'uint16' | 'int32' | 'uint32' | 'int64' | 'uint64'
  | 'float32' | 'float64';

export interface MessageType {
  name: string;
  fields: Field[];
}

export interface Field {
  name: string;
  type: NumberKind | 'string' | MessageType;
  /** Elements of a fixed array; 'sequence' for as many as the message says; undefined for a single value. */
  count?: number | 'sequence';
}

const ALIASES: Record<string, NumberKind> = {
  bool: 'bool', boolean: 'bool', byte: 'uint8', octet: 'uint8', char: 'uint8', int8: 'int8', uint8: 'uint8', int16: 'int16',
  uint16: 'uint16', int32: 'int32', uint32: 'uint32', int64: 'int64', uint64: 'uint64', float32: 'float32', float64: 'float64',
};
const MAX_DEPTH = 16;

/** @throws Error  a line or a message name that cannot be understood. */
export function parseSchema(name: string, text: string): MessageType {
  const texts = new Map<string, string>();
  const [own = '', ...others] = text.split(/^=+[ \t]*$/m);
  for (const other of others) {
    const match = /^\s*MSG:[ \t]*(\S+)[ \t]*$/m.exec(other);
    if (!match) throw new Error(`${name}: a part of the definition has no line 'MSG: package/Name'`);
    texts.set(shortName(match[1]!), other.slice(match.index + match[0].length));
  }
  return messageType(shortName(name), own, texts, 0);
}

function messageType(name: string, text: string, texts: Map<string, string>, depth: number): MessageType {
  if (depth > MAX_DEPTH) throw new Error(`${name}: messages nested in more than ${MAX_DEPTH} levels`);
  const fields: Field[] = [];
  for (const raw of text.split('\n')) {
    const line = raw.replace(/#.*/, '').trim();
    if (line === '' || /^\S+[ \t]+\w+[ \t]*=/.test(line)) continue; // nothing, or a constant
    const match = /^([\w/]+)(?:<=\d+)?(\[(?:<=\d+|\d*)\])?[ \t]+(\w+)/.exec(line);
    if (!match) throw new Error(`${name}: '${line}' is no field`);
    const [, typeName = '', array, field = ''] = match;
    const length = array?.slice(1, -1) ?? '';
    const count = array === undefined ? undefined : /^\d+$/.test(length) ? Number(length) : 'sequence';
    fields.push({name: field, type: fieldType(typeName, name, texts, depth), ...(count === undefined ? {} : {count})});
  }
  return {name, fields};
}

function fieldType(typeName: string, inside: string, texts: Map<string, string>, depth: number): Field['type'] {
  if (typeName === 'string') return 'string';
  const number = ALIASES[typeName];
  if (number) return number;
  const full = typeName.includes('/') ? shortName(typeName) : `${inside.split('/')[0]}/${typeName}`;
  const text = texts.get(full);
  if (text === undefined) throw new Error(`${inside}: no definition of ${typeName}`);
  return messageType(full, text, texts, depth + 1);
}

/** package/msg/Name and package/Name are the same message. */
function shortName(name: string): string {
  return name.replace('/msg/', '/');
}
