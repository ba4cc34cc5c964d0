// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <optional>
#include <string>

#include "base/constants.hpp"

namespace rosflight_common {

namespace base = rosflight::base;

/// Waveforms of the signal generators. With A half of the magnitude, c = base + A and x the number
/// of periods since the start:
///
///     step      c + A while it is switched up, else c - A                     (1)
///     square    c - A in the first half of a period, c + A in the second      (2)
///     sawtooth  c + 2A (x - floor x - 1/2)                                    (3)
///     triangle  up from c - A to c + A in the first half, down in the second  (4)
///     sine      c - A cos(2 pi x)                                             (5)
///
/// so that all but the step begin at `base`, the lower end (ROSflight 2.x, tuning packages).
enum class Waveform { kStep, kSquare, kSawtooth, kTriangle, kSine };

inline std::optional<Waveform> waveform_named(const std::string& name) {
  if (name == "step") return Waveform::kStep;
  if (name == "square") return Waveform::kSquare;
  if (name == "sawtooth") return Waveform::kSawtooth;
  if (name == "triangle") return Waveform::kTriangle;
  if (name == "sine") return Waveform::kSine;
  return {};
}

inline constexpr const char* kWaveformNames = "step, square, sawtooth, triangle or sine";

/// @param periods  x of (2) to (5), >= 0.
/// @param up  that of (1).
inline double sample(Waveform form, double base, double magnitude, double periods, bool up) {
  const double amplitude = 0.5 * magnitude;
  const double centre = base + amplitude;
  const double phase = periods - std::floor(periods);  // 0 to 1
  const double half = 2.0 * periods - std::floor(2.0 * periods);
  const bool second = phase >= 0.5;
  switch (form) {
    case Waveform::kStep:
      return up ? centre + amplitude : centre - amplitude;
    case Waveform::kSquare:
      return second ? centre + amplitude : centre - amplitude;
    case Waveform::kSawtooth:
      return centre + 2.0 * amplitude * (phase - 0.5);
    case Waveform::kTriangle:
      return centre + (second ? -1.0 : 1.0) * 2.0 * amplitude * (half - 0.5);
    case Waveform::kSine:
      return centre - amplitude * std::cos(2.0 * base::kPi * periods);
  }
  return base;
}

}  // namespace rosflight_common
