// SPDX-License-Identifier: BSD-3-Clause
// The ground as a grid with round steps, and the letters of the compass at its edges.
import {BufferGeometry, CanvasTexture, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  PlaneGeometry, Sprite, SpriteMaterial, SRGBColorSpace, type Box3} from 'three';
import type {Palette} from './palette.ts';

const STEPS_M = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
const MAX_LINES = 24;

export interface Ground { group: Group; step_m: number }

/** Covers the box and half as much around it. @param height  of the ground, in the frame of three.js. */
export function ground(around: Box3, height: number, colours: Palette): Ground {
  const width = Math.max(around.max.x - around.min.x, around.max.z - around.min.z, 8) * 1.8;
  const step_m = STEPS_M.find((step) => width / step <= MAX_LINES) ?? 10000;
  const half = Math.ceil(width / 2 / step_m) * step_m;
  const middle = (low: number, high: number) => Math.round((low + high) / 2 / step_m) * step_m;
  const x = middle(around.min.x, around.max.x);
  const z = middle(around.min.z, around.max.z);
  const group = new Group();
  group.position.set(x, height, z);
  // Drawn first and without depth: that of a plane of kilometres is wrong by more than the height of a wing above its wheels.
  const plane = new Mesh(new PlaneGeometry(80 * half, 80 * half), new MeshBasicMaterial({color: colours.ground, depthWrite: false}));
  plane.renderOrder = -2;
  plane.rotation.x = -Math.PI / 2;
  plane.position.y = -0.02;
  group.add(plane, grid(half, step_m, colours.grid));
  for (const [name, dx, dz] of [['N', 0, -1], ['E', 1, 0], ['S', 0, 1], ['W', -1, 0]] as const) {
    const letter = label(name, colours.faint, 0.06 * half);
    letter.position.set(dx * 1.06 * half, 0.03 * half, dz * 1.06 * half);
    group.add(letter);
  }
  return {group, step_m};
}

function grid(half: number, step: number, colour: string): LineSegments {
  const ends: number[] = [];
  for (let at = -half; at <= half + step / 2; at += step) ends.push(at, 0, -half, at, 0, half, -half, 0, at, half, 0, at);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(ends, 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({color: colour, depthWrite: false}));
  lines.renderOrder = -1;
  return lines;
}

/** A text that faces the viewer. @param height  in metres. */
export function label(text: string, colour: string, height: number): Sprite {
  const sprite = picture((pen) => {
    pen.fillStyle = colour;
    pen.fillText(text, MIDDLE, MIDDLE + 2);
  });
  sprite.scale.setScalar(height);
  return sprite;
}

/** A number in a disc that faces the viewer, of the same size at any distance. */
export function marker(text: string, colours: Palette): Sprite {
  const sprite = picture((pen) => {
    pen.fillStyle = colours.command;
    pen.beginPath();
    pen.arc(MIDDLE, MIDDLE, MIDDLE - 2, 0, 2 * Math.PI);
    pen.fill();
    pen.fillStyle = '#1b1206';
    pen.fillText(text, MIDDLE, MIDDLE + 2);
  });
  sprite.material.sizeAttenuation = false;
  sprite.material.depthTest = false; // readable in front of lines
  sprite.renderOrder = 1;
  sprite.scale.setScalar(0.035);
  return sprite;
}

const MIDDLE = 32;

function picture(draw: (pen: CanvasRenderingContext2D) => void): Sprite {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 2 * MIDDLE;
  const pen = canvas.getContext('2d')!;
  pen.font = '600 40px system-ui, sans-serif';
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  draw(pen);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  return new Sprite(new SpriteMaterial({map, transparent: true, depthWrite: false, fog: false}));
}
