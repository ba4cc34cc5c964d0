// SPDX-License-Identifier: BSD-3-Clause
// The vehicle as a model: its front is -z, its right x, up y (frames.ts).
import {BoxGeometry, CylinderGeometry, DoubleSide, Euler, Group, Mesh, MeshStandardMaterial, Quaternion, SphereGeometry, Vector3,
  type Object3D} from 'three';
import {fromFlu} from './frames.ts';
import type {Palette} from './palette.ts';
import {tail, wing, type Hinges} from './surfaces.ts';
import {shapesOf, type Shape} from './urdf.ts';

/** Materials of the description that have a colour of their own here; others have the body's. */
const MATERIALS = ['body', 'rotor', 'wing', 'gear'] as const;
const UP = new Vector3(0, 1, 0);

export interface VehicleModel {
  group: Group;
  /** One for each rotor, in the order of the firmware's outputs: turns about its y. */
  rotors: Object3D[];
  /** Of the control surfaces of a fixed wing. */
  hinges: Hinges;
  /** Of a sphere around it [m]. */
  radius: number;
}

/** What a description does not say. */
export interface Kind { fixedWing: boolean; invertedV: boolean }

export function vehicleModel(urdf: string, {fixedWing, invertedV}: Kind, colours: Palette): VehicleModel {
  const described = shapesOf(urdf);
  const shapes = described.length > 0 ? described : fixedWing ? [PLAIN, PLAIN_WING] : [PLAIN];
  const group = new Group();
  const rotors: Object3D[] = [];
  const hinges: Hinges = new Map();
  let radius = 0.3;
  for (const shape of shapes) {
    if (shape.link === 'wing') {
      const [chord = 0.2, span = 1, thickness = 0.01] = shape.size;
      const materials = {fixed: matter(colours.wing), moving: matter(colours.rotor), boom: matter(colours.body)};
      group.add(wing(chord, span, thickness, hinges, materials), tail(chord, span, invertedV, hinges, materials));
      radius = Math.max(radius, reach(shape));
      continue;
    }
    const part = shape.link.startsWith('rotor_') ? rotor(shape, colours) : solid(shape, colours);
    part.position.copy(fromFlu(shape.position));
    part.quaternion.copy(turn(shape));
    radius = Math.max(radius, part.position.length() + reach(shape));
    group.add(part);
    if (shape.link.startsWith('rotor_')) {
      const turning = part.children[0]!;
      turning.name = `rotor ${rotors.length}`;
      rotors.push(turning);
      const arm = beam(part.position, colours);
      if (arm) group.add(arm);
    }
  }
  group.add(nose(shapes.find((shape) => shape.link === 'base_link') ?? PLAIN, colours));
  return {group, rotors, hinges, radius};
}

/** A vehicle without a description. */
const PLAIN: Shape = {link: 'base_link', kind: 'box', size: [0.4, 0.25, 0.1], position: [0, 0, 0], rpy: [0, 0, 0], material: 'body'};
const PLAIN_WING: Shape = {link: 'wing', kind: 'box', size: [0.25, 1.5, 0.01], position: [0, 0, 0], rpy: [0, 0, 0], material: 'wing'};

/** Turned about the fixed axes x, y, z in this order, in front-left-up, then into the frame of the model. */
function turn({rpy}: Shape): Quaternion {
  const q = new Quaternion().setFromEuler(new Euler(rpy[0], rpy[1], rpy[2], 'ZYX'));
  return new Quaternion(-q.y, q.z, -q.x, q.w);
}

function solid(shape: Shape, colours: Palette): Mesh {
  const [a = 0, b = 0, c = 0] = shape.size;
  const geometry = shape.kind === 'box' ? new BoxGeometry(b, c, a)
    : shape.kind === 'sphere' ? new SphereGeometry(a, 16, 12) : new CylinderGeometry(a, a, b, 32);
  return new Mesh(geometry, matter(colours[MATERIALS.find((name) => name === shape.material) ?? 'body']));
}

/** A pale disc, and in it what turns: two blades and a hub. */
function rotor(shape: Shape, colours: Palette): Group {
  const [radius = 0.1, thickness = 0.01] = shape.size;
  const turning = new Group();
  const blades = new Mesh(new BoxGeometry(2 * radius, 0.6 * thickness, 0.14 * radius), matter(colours.blade));
  const hub = new Mesh(new CylinderGeometry(0.12 * radius, 0.15 * radius, 4 * thickness, 16), matter(colours.blade));
  turning.add(blades, hub);
  const disc = new Mesh(new CylinderGeometry(radius, radius, 0.2 * thickness, 48),
    new MeshStandardMaterial({color: colours.rotor, transparent: true, opacity: 0.28, side: DoubleSide, depthWrite: false}));
  const group = new Group();
  group.add(turning, disc);
  return group;
}

function beam(end: Vector3, colours: Palette): Mesh | undefined {
  const length = end.length();
  if (length < 0.05) return undefined;
  const mesh = new Mesh(new CylinderGeometry(0.04 * length, 0.04 * length, length, 10), matter(colours.body));
  mesh.position.copy(end).multiplyScalar(0.5);
  mesh.quaternion.setFromUnitVectors(UP, end.clone().normalize());
  return mesh;
}

/** Where the front is, also from far away. */
function nose({size: [length = 0.4, width = 0.2, height = 0.1]}: Shape, colours: Palette): Mesh {
  const mesh = new Mesh(new BoxGeometry(0.7 * width, 0.7 * height, 0.25 * length), matter(colours.front));
  mesh.position.z = -0.55 * length;
  return mesh;
}

function reach({kind, size: [a = 0, b = 0]}: Shape): number {
  return kind === 'box' ? Math.hypot(a, b) / 2 : a;
}

function matter(color: string): MeshStandardMaterial { return new MeshStandardMaterial({color, roughness: 0.75, metalness: 0.05}); }
