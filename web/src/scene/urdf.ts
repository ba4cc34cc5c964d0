// SPDX-License-Identifier: BSD-3-Clause
// What the page draws of a vehicle's URDF: links with one shape each, fixed to base_link. Frames are front-left-up.
import type {Triple} from '../data/attitude.ts';

export interface Shape {
  link: string;
  kind: 'box' | 'cylinder' | 'sphere';
  /** Box: edges; cylinder: radius and length along its z; sphere: radius [m]. */
  size: readonly number[];
  position: Triple;
  /** About fixed axes: roll, pitch, yaw [rad]. */
  rpy: Triple;
  material: string;
}

/** @returns none for a text that is no URDF. */
export function shapesOf(urdf: string): Shape[] {
  if (urdf.trim() === '') return []; // the parser's complaint about nothing has a style of its own, which the page forbids
  const robot = new DOMParser().parseFromString(urdf, 'application/xml').querySelector('robot');
  if (!robot) return [];
  const origins = new Map<string, {position: Triple; rpy: Triple}>();
  for (const joint of robot.querySelectorAll('joint')) {
    const origin = joint.querySelector('origin');
    origins.set(joint.querySelector('child')?.getAttribute('link') ?? '',
      {position: triple(origin?.getAttribute('xyz')), rpy: triple(origin?.getAttribute('rpy'))});
  }
  return [...robot.querySelectorAll('link')].flatMap((link) => {
    const name = link.getAttribute('name') ?? '';
    const at = origins.get(name) ?? {position: [0, 0, 0], rpy: [0, 0, 0]};
    const material = link.querySelector('visual > material')?.getAttribute('name') ?? '';
    const shape = link.querySelector('visual > geometry')?.firstElementChild;
    const size = shape && sizeOf(shape);
    return size ? [{link: name, ...size, ...at, material}] : [];
  });
}

function sizeOf(shape: Element): Pick<Shape, 'kind' | 'size'> | undefined {
  const number = (name: string) => Number(shape.getAttribute(name));
  switch (shape.tagName) {
    case 'box': return {kind: 'box', size: triple(shape.getAttribute('size'))};
    case 'cylinder': return {kind: 'cylinder', size: [number('radius'), number('length')]};
    case 'sphere': return {kind: 'sphere', size: [number('radius')]};
    default: return undefined;
  }
}

function triple(text: string | null | undefined): Triple {
  const [x = 0, y = 0, z = 0] = (text ?? '').trim().split(/\s+/).map(Number).filter(Number.isFinite);
  return [x, y, z];
}
