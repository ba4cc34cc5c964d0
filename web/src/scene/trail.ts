// SPDX-License-Identifier: BSD-3-Clause
// A line in space with a width in pixels; what lies beyond its end is left out.
import type {Vector3} from 'three';
import {Line2} from 'three/addons/lines/Line2.js';
import {LineGeometry} from 'three/addons/lines/LineGeometry.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';

export class Trail {
  readonly line: Line2;
  private readonly segments: number;

  /** @param points  At least two. */
  constructor(points: readonly Vector3[], colour: string, width_px: number) {
    const geometry = new LineGeometry();
    geometry.setPositions(points.flatMap(({x, y, z}) => [x, y, z]));
    this.segments = points.length - 1;
    this.line = new Line2(geometry, new LineMaterial({color: colour, linewidth: width_px}));
    this.line.frustumCulled = false;
  }

  /** Shows it up to a point; -1 is none of it. */
  setEnd(point: number) { this.line.geometry.instanceCount = Math.min(Math.max(point, 0), this.segments); }
}
