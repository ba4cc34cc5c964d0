// SPDX-License-Identifier: BSD-3-Clause
// Wing and tail of a fixed wing with surfaces that turn about their hinges, in proportion to the wing's chord and span: a vehicle's
// description has no tail.
import {BoxGeometry, CylinderGeometry, Group, Mesh, type Material, type Object3D} from 'three';
import type {Part} from '../data/surfaces.ts';

/** Turns about its x, by a positive angle when the trailing edge goes down; that of a rudder to the left. */
export type Hinges = Map<Part, Object3D>;
export interface Materials { fixed: Material; moving: Material; boom: Material }

const THICKNESS = 0.05; // of the chord
const AILERON = {chord: 0.25, from: 0.45}; // of the wing's chord, of half the span
const TAIL = {chord: 0.6, span: 0.28, height: 0.7, arm: 2.8}; // of the wing's chord, of its span, of its chord twice
const MOVING = 0.4; // of the chord of the tail

/** @param thickness  of the wing [m]. */
export function wing(chord: number, span: number, thickness: number, hinges: Hinges, {fixed, moving}: Materials): Group {
  const rear = AILERON.chord * chord;
  const inner = AILERON.from * span;
  const outer = (span - inner) / 2;
  const front = new Mesh(new BoxGeometry(span, thickness, chord - rear), fixed);
  front.position.z = -rear / 2;
  const middle = new Mesh(new BoxGeometry(inner, thickness, rear), fixed);
  middle.position.z = (chord - rear) / 2;
  const group = new Group().add(front, middle);
  for (const [part, side] of [['left aileron', -1], ['right aileron', 1]] as const) {
    const hinge = flap(outer, thickness, rear, moving);
    hinge.position.set(side * (inner + outer) / 2, 0, chord / 2 - rear);
    group.add(hinge);
    hinge.name = part;
    hinges.set(part, hinge);
  }
  return group;
}

/** A level tail and a fin behind one boom, or an inverted V behind two. */
export function tail(chord: number, span: number, invertedV: boolean, hinges: Hinges, materials: Materials): Group {
  const arm = TAIL.arm * chord;
  const half = TAIL.span * span / 2;
  const height = TAIL.height * chord;
  const group = new Group();
  const add = (part: Part, width: number, x: number, y: number, roll: number) => {
    const one = panel(width, TAIL.chord * chord, THICKNESS * chord, part, hinges, materials);
    one.position.set(x, y, arm);
    one.rotation.z = roll;
    group.add(one);
  };
  for (const side of invertedV ? [-1, 1] : [0]) {
    const boom = new Mesh(new CylinderGeometry(0.1 * chord, 0.16 * chord, arm + chord, 12), materials.boom);
    boom.rotation.x = Math.PI / 2;
    boom.position.set(side * half, 0, 0.4 * arm);
    if (invertedV) boom.scale.set(0.6, 1, 0.6);
    group.add(boom);
  }
  if (invertedV) {
    const lean = Math.atan2(height, half);
    const width = Math.hypot(height, half);
    add('right tail', width, half / 2, height / 2, -lean);
    add('left tail', width, -half / 2, height / 2, lean);
  } else {
    add('elevator', 2 * half, 0, 0, 0);
    add('rudder', height, 0, height / 2, -Math.PI / 2); // what was down is left
  }
  return group;
}

/** Span along x, its upper side towards y, its rear turns. */
function panel(width: number, chord: number, thickness: number, part: Part, hinges: Hinges, {fixed, moving}: Materials): Group {
  const rear = MOVING * chord;
  const front = new Mesh(new BoxGeometry(width, thickness, chord - rear), fixed);
  front.position.z = -rear / 2;
  const hinge = flap(width, thickness, rear, moving);
  hinge.position.z = chord / 2 - rear;
  hinge.name = part;
  hinges.set(part, hinge);
  return new Group().add(front, hinge);
}

function flap(width: number, thickness: number, chord: number, material: Material): Group {
  const plate = new Mesh(new BoxGeometry(0.97 * width, 0.8 * thickness, chord), material);
  plate.position.z = chord / 2;
  return new Group().add(plate);
}
