// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Elementary functions built from +, -, *, / and the square root (exact by IEEE 754) alone: every
/// compiler and processor gives the same bits, so the firmware flies the same flight in a process
/// and on a microcontroller. The C libraries' own differ in the last bit.
///
/// Polynomials are minimax fits of ours. Errors against the exact value: 2.4e-7 relative (atan2),
/// 3e-7 (asin), 1.5e-7 (pow), 1.2e-7 absolute (sine and cosine, |x| <= 1000 rad). A NaN gives a
/// NaN.
namespace rosflight::core {

struct SinCos {
  float sin;
  float cos;
};
/// NaN for infinities and beyond 1e6 rad.
SinCos sin_cos(float angle_rad);

/// Angle of the point (x, y) from the x axis, -pi..pi; 0 for the origin.
float atan2(float y, float x);

/// -pi/2..pi/2; NaN outside -1..1.
float asin(float sine);

/// x^y; NaN for negative x, 0 for x = 0 and below the normal numbers (y > 0). For |y log2 x| < 120.
float pow(float x, float y);

}  // namespace rosflight::core
