// SPDX-License-Identifier: BSD-3-Clause
// From the project's frames to those of three.js, where x is right, y up and z towards the viewer: north is -z, east x.
import {Quaternion as Rotation, Vector3} from 'three';
import type {Quaternion, Triple} from '../data/attitude.ts';

/** A point in north-east-down. */
export function fromNed([n, e, d]: Triple): Vector3 { return new Vector3(e, -d, -n); }

/**
 * An attitude that takes front-right-down to north-east-down, for a model whose front is -z and whose right is x. Both
 * frames change by the same rotation, so the axis of the attitude does too.
 */
export function attitudeFromNed([w, x, y, z]: Quaternion): Rotation { return new Rotation(y, -z, -x, w); }

/** A point of a model in front-left-up, as ROS has them. */
export function fromFlu([x, y, z]: Triple): Vector3 { return new Vector3(-y, z, -x); }
