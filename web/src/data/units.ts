// SPDX-License-Identifier: BSD-3-Clause
// Factors between units.

export const DEG_PER_RAD = 180 / Math.PI;
