// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string_view>

#include "sim/environment/geodesy.hpp"

namespace rosflight::sim {

/// The earth's main field as a spherical-harmonic series of degree 12.
///
///     V = a sum_n (a/r)^(n+1) sum_m (g_nm cos m L + h_nm sin m L) P_nm(sin phi')      (1)
///     B = -grad V                                                                     (2)
///
/// with Schmidt semi-normalised P_nm, a = 6371200 m, r, phi', L geocentric, and g, h moving
/// linearly with time; the result is turned to the geodetic vertical. After A. Chulliat et al.,
/// "The US/UK World Magnetic Model for 2025-2030", NOAA/NCEI, 2025, section 1.2. Owns 6 kB, no
/// heap; one call some microseconds: call it once per position, not per step.
class MagneticModel {
 public:
  /// Reads the text of a coefficient file. Throws config::Error naming `name` and the line.
  MagneticModel(std::string_view text, std::string_view name);

  /// First and last year the coefficients are made for.
  double epoch() const { return epoch_; }
  double end() const { return epoch_ + 5.0; }

  /// Field in the local frame [T]. Right at a pole, east is where longitude says it is.
  /// @param decimal_year  outside epoch..end the linear change is continued; callers decide whether
  /// to accept it.
  Vector3 field_W_T(const Geodetic& position, double decimal_year) const;

 private:
  static constexpr int kDegree = 12;
  static constexpr std::size_t kTerms = (kDegree + 1) * (kDegree + 2) / 2;
  static constexpr std::size_t index(int n, int m) {
    const int i = n * (n + 1) / 2 + m;
    return static_cast<std::size_t>(i);
  }
  struct Term {
    double g_nT{}, h_nT{}, g_rate_nT{}, h_rate_nT{};
  };

  double epoch_{};
  std::array<Term, kTerms> terms_{};
};

/// Text of data/WMM2025.COF, built in.
extern const std::string_view kWmm2025Text;

/// The model WMM2025, parsed at the first call.
const MagneticModel& wmm2025();

/// Years and their fraction of a point in time, in the civil calendar (UTC).
double decimal_year(std::int64_t unix_s);

}  // namespace rosflight::sim
