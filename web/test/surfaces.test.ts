// SPDX-License-Identifier: BSD-3-Clause
// Control surfaces: from outputs to angles, and to where trailing edges are in the model (front -z, right x, up y).
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {Box3, Group, MeshBasicMaterial} from 'three';
import {bytesSource} from '../src/data/bytes.ts';
import type {Flight} from '../src/data/flight.ts';
import {parseParameterFile} from '../src/data/parameter_file.ts';
import {readLog} from '../src/data/read_log.ts';
import {deflections, surfacesOf, surfacesOfFile, surfacesOfMixer, type Part, type Surface} from '../src/data/surfaces.ts';
import type {Palette} from '../src/scene/palette.ts';
import {tail, wing, type Hinges} from '../src/scene/surfaces.ts';
import {vehicleModel, type Kind} from '../src/scene/vehicle_model.ts';
import {FIXED_WING, logOf} from './flights.ts';

const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(FIXED_WING)))));
const file = await readFile(join(FIXED_WING, 'vehicle.yaml'), 'utf8');

/** From hinge to middle of a surface of the tail, whose chord is 0.6 of the wing's, of which 0.4 moves. */
const TAIL_MIDDLE_M = 0.235 * 0.6 * 0.4 / 2;

/** Angles with output k at `values[k]` of its travel, from -1 to 1: 0 to 1 on the link. */
function anglesAt(surfaces: Surface[], values: number[]): Map<Part, number> {
  const still = {latest: (topic: string, field: string) => topic === '/output_raw' ? 0.5 + 0.5 * (values[Number(/\d+/.exec(field)![0])] ?? 0) : NaN};
  return deflections(still as unknown as Flight, surfaces, 0);
}

/** A model with these deflections; place of the trailing edge of a part: its rearmost points. */
function model(angles: Map<Part, number>) {
  const hinges: Hinges = new Map();
  const plain = new MeshBasicMaterial();
  const materials = {fixed: plain, moving: plain, boom: plain};
  const invertedV = angles.has('left tail');
  const group = new Group().add(wing(0.235, 2.08, 0.01, hinges, materials), tail(0.235, 2.08, invertedV, hinges, materials));
  const middle = (part: Part) => new Box3().setFromObject(hinges.get(part)!.children[0]!, true);
  group.updateMatrixWorld(true);
  const before = new Map([...hinges.keys()].map((part) => [part, middle(part)]));
  for (const [part, angle] of angles) hinges.get(part)!.rotation.x = angle;
  group.updateMatrixWorld(true);
  /** How far the middle of a surface has moved [m]. */
  const moved = (part: Part) => {
    const [was, is] = [before.get(part)!, middle(part)];
    return {x: (is.min.x + is.max.x - was.min.x - was.max.x) / 2, y: (is.min.y + is.max.y - was.min.y - was.max.y) / 2};
  };
  return {moved, middle: (part: Part) => before.get(part)!};
}

test('a command to roll right moves the right aileron up and the left one down, by the travel of the vehicle file', () => {
  const angles = anglesAt(surfacesOfFile(file), [0.5]); // output 0 drives the ailerons: 40 degrees at 1
  const {moved, middle} = model(angles);
  assert.ok(middle('right aileron').min.x > 0 && middle('left aileron').max.x < 0);
  // The middle of an aileron is half of its chord, an eighth of the wing's, behind its hinge.
  const up_m = 0.235 / 8 * Math.sin(20 * Math.PI / 180);
  assert.ok(Math.abs(moved('right aileron').y - up_m) < 1e-4 && Math.abs(moved('left aileron').y + up_m) < 1e-4, `${moved('right aileron').y}, ${up_m}`);
  assert.equal(model(anglesAt(surfacesOfFile(file), [0])).moved('right aileron').y, 0);
});

test('both halves of an inverted V-tail go up to pitch up, and to the right to yaw right', () => {
  const surfaces = surfacesOfFile(file);
  // Left: elevator -1 and rudder 1, right: 1 and 1, where a positive elevator pitches down and a positive rudder yaws left.
  const up = model(anglesAt(surfaces, [0, 0.5, -0.5]));
  const right = model(anglesAt(surfaces, [0, -0.5, -0.5]));
  assert.ok(up.middle('right tail').max.x > 0 && up.middle('left tail').min.x < 0);
  for (const part of ['left tail', 'right tail'] as const) {
    assert.ok(up.moved(part).y > 0.004, `${part} goes up: ${up.moved(part).y}`);
    assert.ok(right.moved(part).x > 0.004, `${part} goes right: ${right.moved(part).x}`);
    const {x, y} = up.moved(part);
    assert.ok(Math.abs(Math.hypot(x, y) - TAIL_MIDDLE_M * Math.sin(20 * Math.PI / 180)) < 1e-6);
  }
  assert.ok(Math.abs(up.moved('left tail').x + up.moved('right tail').x) < 1e-9, 'no rudder');
  assert.ok(Math.abs(right.moved('left tail').y + right.moved('right tail').y) < 1e-9, 'no elevator');
});

test('a plain tail has an elevator that goes up and a rudder that goes left', () => {
  const plain = file.replace(/ {2}layout:\n(?: {4}.*\n)*/, '  layout:\n    -\n      output: 1\n      travel_deg: 30\n      elevator: 1\n'
    + '    -\n      output: 2\n      travel_deg: 20\n      rudder: 1\n');
  const angles = anglesAt(surfacesOfFile(plain), [0, -1, 1]);
  assert.deepEqual([...angles].map(([part, angle]) => [part, Math.round(angle * 180 / Math.PI)]), [['elevator', -30], ['rudder', 20]]);
  const {moved} = model(angles);
  assert.ok(Math.abs(moved('elevator').y - TAIL_MIDDLE_M * Math.sin(30 * Math.PI / 180)) < 1e-6);
  assert.ok(Math.abs(moved('rudder').x + TAIL_MIDDLE_M * Math.sin(20 * Math.PI / 180)) < 1e-6 && Math.abs(moved('rudder').y) < 1e-6);
});

test('elevons go up together to pitch up, and the right one to roll right', () => {
  const elevons = file.replace(/ {2}layout:\n(?: {4}.*\n)*/, '  layout:\n    -\n      output: 0\n      travel_deg: 30\n      aileron: 0.5\n      elevator: 0.5\n'
    + '    -\n      output: 1\n      travel_deg: 30\n      aileron: -0.5\n      elevator: 0.5\n');
  assert.ok(anglesAt(surfacesOfFile(elevons), [-1, -1]).get('right aileron')! < 0);
  const roll = anglesAt(surfacesOfFile(elevons), [1, -1]);
  assert.ok(roll.get('right aileron')! < 0 && roll.get('left aileron')! > 0);
});

test('a vehicle whose derivatives count the other way round moves as its effect says', () => {
  // vehicles/xflr5_anaconda.yaml: C_ell_delta_a < 0; its REV_AILERON negates the command to roll right.
  const other = file.replace(/^( {2}roll:\n(?: {4}.*\n)*? {4}aileron:) .*$/m, '$1 -0.34438');
  assert.notEqual(other, file);
  assert.ok(anglesAt(surfacesOfFile(other), [-1]).get('right aileron')! < 0);
});

test('in a flight each surface does what the companion commands: roll right, pitch up, yaw right', async () => {
  const surfaces = surfacesOf(flight);
  const command = flight.tables.get('/command')!;
  const armed = flight.tables.get('/status')!;
  const travel = 40 * Math.PI / 180;
  const off: number[][] = [[], [], []];
  for (let row = 0; row < command.length; ++row) {
    const t = command.times[row]!;
    if (!armed.column('armed')![armed.rowAt(t)]) continue;
    const angles = deflections(flight, surfaces, t);
    const [right, left] = [angles.get('right tail')! / travel, angles.get('left tail')! / travel];
    assert.equal(angles.get('left aileron')! + angles.get('right aileron')!, 0);
    const shown = [angles.get('left aileron')! / travel, -(right + left), -(right - left)]; // roll right, pitch up, yaw right
    shown.forEach((value, k) => {
      const commands = command.column(`u[${3 + k}]`)!;
      const wanted = commands[row]!;
      off[k]!.push(value - wanted);
      const turned = !(commands[row - 1]! * wanted > 0); // a nose that is raised: not through link and mixer yet
      if (Math.abs(wanted) > 0.25 && !turned) assert.ok(value * wanted > 0, `${t} s, axis ${k}: ${value} for ${wanted}`);
    });
  }
  // The log has every other command, and one takes some milliseconds through link and mixer.
  for (const [k, all] of off.entries()) {
    const rms = Math.sqrt(all.reduce((sum, one) => sum + one * one, 0) / all.length);
    assert.ok(all.length > 5000 && rms < 0.02, `axis ${k}: ${rms} of ${all.length}`);
  }
});

test('without a vehicle file the servos of the mixer move by the assumed travel', async () => {
  const values = new Map(parseParameterFile(await readFile(join(FIXED_WING, 'parameters.yaml'), 'utf8')).map(({name, value}) => [name, value]));
  const sides = (surfaces: Surface[]) => surfaces.map(({output, parts}) => [output, parts]);
  assert.deepEqual(sides(surfacesOfMixer(values)), sides(surfacesOfFile(file)));
  assert.ok(Math.abs(anglesAt(surfacesOfMixer(values), [1]).get('right aileron')! + 30 * Math.PI / 180) < 1e-12);
});

test('a fixed wing without a description has wing and tail, another vehicle has none', () => {
  const colours = new Proxy({}, {get: () => '#808080'}) as Palette;
  const parts = (kind: Kind) => [...vehicleModel('', kind, colours).hinges.keys()].sort();
  assert.deepEqual(parts({fixedWing: true, invertedV: true}), ['left aileron', 'left tail', 'right aileron', 'right tail']);
  assert.deepEqual(parts({fixedWing: true, invertedV: false}), ['elevator', 'left aileron', 'right aileron', 'rudder']);
  assert.deepEqual(parts({fixedWing: false, invertedV: false}), []);
});
