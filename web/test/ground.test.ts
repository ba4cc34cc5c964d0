// SPDX-License-Identifier: BSD-3-Clause
// The ground: a grid whose lines lie on round metres of the map, and letters where its directions are.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Box3, LineSegments, Sprite, Vector3} from 'three';
import {fromNed} from '../src/scene/frames.ts';
import {ground} from '../src/scene/ground.ts';
import type {Palette} from '../src/scene/palette.ts';
import {random} from './random.ts';

/** What was written on canvases, in order: Node has none. */
const written: string[] = [];
const pen = {fillText: (text: string) => written.push(text)};
Object.assign(globalThis, {document: {createElement: () => ({getContext: () => pen})}});

const COLOURS = {grid: '#888', ground: '#eee', faint: '#999'} as Palette;

function made(box: Box3) {
  written.length = 0;
  const {group, step_m} = ground(box, 0, COLOURS);
  group.updateMatrixWorld(true);
  const all = group.children;
  const lines = all.find((child) => child instanceof LineSegments) as LineSegments;
  const letters = all.filter((child) => child instanceof Sprite).map((child, k) => [written[k]!, child.position] as const);
  return {step_m, lines: new Box3().setFromObject(lines), ends: lines.geometry.getAttribute('position').count, letters: new Map(letters)};
}

test('each letter of the compass stands beyond the grid where its direction is', () => {
  const {letters, lines} = made(new Box3(new Vector3(-40, 0, -90), new Vector3(10, 20, 30)));
  const half = (lines.max.x - lines.min.x) / 2;
  for (const [name, n, e] of [['N', 1, 0], ['E', 0, 1], ['S', -1, 0], ['W', 0, -1]] as const) {
    const direction = fromNed([n, e, 0]);
    const along = letters.get(name)!.dot(direction);
    assert.ok(along > half && along < 1.2 * half, `${name}: ${along} of ${half}`);
    const aside = letters.get(name)!.clone().addScaledVector(direction, -along).setY(0);
    assert.ok(aside.length() < 1e-9, `${name} is ${aside.length()} m aside`);
  }
  assert.equal(letters.size, 4);
});

test('lines lie on round metres, are few, and cover what was flown', () => {
  const whole = random(18);
  const next = () => whole() / 2147483647;
  for (let k = 0; k < 300; ++k) {
    const size = 10 ** (4 * next() - 1);
    const corner = new Vector3(1e4 * (next() - 0.5), 0, 1e4 * (next() - 0.5));
    const box = new Box3(corner, corner.clone().add(new Vector3(size * next(), 0, size * next())));
    const {step_m, lines, ends} = made(box);
    assert.match(step_m.toExponential(), /^[125]e\+\d$/);
    for (const at of [lines.min.x, lines.max.z]) assert.ok(Math.abs(at / step_m - Math.round(at / step_m)) < 1e-6, `${at} m, step ${step_m} m`);
    assert.ok(ends / 4 <= 27, `${ends / 4} lines each way`);
    assert.ok(lines.min.x <= box.min.x && lines.max.x >= box.max.x && lines.min.z <= box.min.z && lines.max.z >= box.max.z);
  }
});
