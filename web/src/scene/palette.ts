// SPDX-License-Identifier: BSD-3-Clause
// Colours of what is drawn on a canvas, from the style sheet, so that light and dark are said once.

const NAMES = ['paper', 'ink', 'faint', 'grid', 'ground', 'sky', 'actual', 'estimate', 'command', 'route', 'good', 'bad',
  'body', 'gear', 'blade', 'rotor', 'wing', 'front'] as const;
export type Palette = Record<typeof NAMES[number], string>;

/** As they are now, #rrggbb. */
export function palette(): Palette { return Object.fromEntries(NAMES.map((name) => [name, colour(name)])) as Palette; }

/** Of numbered curves, such as motors. */
export function numbered(k: number): string { return colour(`c${k % 10}`); }

/** A property may depend on the scheme: only a computed colour is one. */
function colour(name: string): string {
  const probe = document.createElement('i');
  probe.style.color = `var(--${name})`;
  document.body.append(probe);
  const parts = getComputedStyle(probe).color.match(/\d+/g) ?? ['128', '128', '128'];
  probe.remove();
  return `#${parts.slice(0, 3).map((part) => Number(part).toString(16).padStart(2, '0')).join('')}`;
}
