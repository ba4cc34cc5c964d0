// SPDX-License-Identifier: BSD-3-Clause
// Texts of number fields as a person types them.
import {sameValue} from './parameter_table.ts';

/** By the name of what the field is of. */
export type Edits = ReadonlyMap<string, string>;

/** A text stays as it is typed, also one that stands for the value that is there: `1.` on the way from 1 to 1.5. Only the text that
 * the field shows by itself is no edit. */
export function typed(before: Edits, name: string, text: string, shown: string): Edits {
  const after = new Map(before);
  if (text === shown) after.delete(name);
  else after.set(name, text);
  return after;
}

/** Those that are not the value that is there; an empty text is not. */
export function changesIn(edits: Edits, values: ReadonlyMap<string, number>): [name: string, text: string][] {
  return [...edits].filter(([name, text]) => text.trim() === '' || !sameValue(Number(text), values.get(name) ?? NaN));
}
