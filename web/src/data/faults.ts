// SPDX-License-Identifier: BSD-3-Clause
// The faults of --fault, as the program itself lists them (apps/help/fly.txt is its --help).
import help from '../../../apps/help/fly.txt';

export interface FaultKind { name: string; effect: string }

/** "  name   what happens" lines after the sentence that names the form. */
export function parseFaults(text: string): FaultKind[] {
  const start = text.indexOf('WHAT is one of');
  return [...text.slice(start).split(/\n\s*--/)[0]!.matchAll(/^ +([a-zA-Z_0-9]+(?:=[A-Z]+)?) {2,}(\S.*)$/gm)].map(([, name, effect]) => ({name: name!, effect: effect!}));
}

export const FAULTS = parseFaults(help);
