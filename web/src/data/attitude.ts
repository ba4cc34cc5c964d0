// SPDX-License-Identifier: BSD-3-Clause
// Attitudes: quaternions (w, x, y, z) that take body coordinates (front-right-down) to north-east-down.

export type Quaternion = readonly [w: number, x: number, y: number, z: number];
export type Triple = readonly [number, number, number];

/** Roll, pitch, yaw [rad]: turned by yaw about down, then pitch about right, then roll about front. */
export function eulerAngles([w, x, y, z]: Quaternion): Triple {
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(Math.min(Math.max(2 * (w * y - z * x), -1), 1)),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ];
}

/** Between two attitudes along the shorter rotation, of unit length; `share` 0 is `a`, 1 is `b`. For attitudes close to each other. */
export function between(a: Quaternion, b: Quaternion, share: number): Quaternion {
  const sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
  const mix = a.map((value, k) => value + share * (sign * b[k]! - value));
  const norm = Math.hypot(...mix);
  return [mix[0]! / norm, mix[1]! / norm, mix[2]! / norm, mix[3]! / norm];
}

/** A vector of the body in north-east-down. */
export function turned([w, x, y, z]: Quaternion, [a, b, c]: Triple): Triple {
  // v + 2 w (r x v) + 2 r x (r x v), r the vector part
  const p = y * c - z * b, q = z * a - x * c, r = x * b - y * a;
  return [a + 2 * (w * p + y * r - z * q), b + 2 * (w * q + z * p - x * r), c + 2 * (w * r + x * q - y * p)];
}
