// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace rosflight::companion {

/// Correction of a magnetometer from samples in many attitudes at one undisturbed position.
///
/// The strength F of the true field is the same in all attitudes. Permanent magnets (hard iron b) and
/// magnetisable parts (soft iron) near the sensor turn this sphere into an ellipsoid. The fit
/// determines b and the symmetric A with
///
///     m_cal = A (m - b),   |m_cal| = F for all samples,   det A = 1                       (1)
///
/// which is the form that the firmware applies (MAG_X_BIAS.., MAG_CAL_A00..). It starts with the
/// quadric of the smallest algebraic residual (Gander, Golub & Strebel, BIT 34 (1994) 558: least
/// squares under |v| = 1), on centred and scaled samples. This is biased by noise, so
/// Levenberg-Marquardt then minimises
///
///     sum_k ( |W (m_k - b)| - 1 )^2   over W = A/F, b                                     (2)
///
/// Field strengths do not show a rotation of the sensor; a symmetric A adds none.
struct MagFit {
  using Vector = std::array<double, 3>;

  enum class Status : std::uint8_t {
    kOk,
    kTooFewSamples,
    kNotFinite,
    kUndetermined,  ///< Attitudes too similar: some of the nine unknowns are free
                    ///< (Limits::determination).
    kNoEllipsoid,   ///< The best quadric is no ellipsoid, or (2) does not converge.
    kPoorFit        ///< Residual above the limit: disturbed field, moved magnets.
  };

  struct Limits {
    std::size_t min_samples{100};
    /// Smallest eigenvalue of the mean normal matrix of (2), all unknowns scaled to 1. Samples all
    /// over the sphere have 0.11; six full turns, each body axis up and down, 0.14 in a field
    /// inclined by 65 deg and 0.008 by 85 deg; half a sphere has 0.002, a single turn 0.
    double determination{0.003};
    double max_residual{0.05};
  };

  Status status{Status::kTooFewSamples};
  Vector bias{};                   ///< b, unit of the samples.
  std::array<Vector, 3> matrix{};  ///< A, rows.
  double field{};                  ///< F, unit of the samples.
  double residual{};               ///< Root of the mean of (2): relative error of the strength.
  double raw_residual{};           ///< The same without correction, for comparison.
  double determination{};          ///< See Limits.
  double coverage{};               ///< Fraction of 72 equal cells of the sphere with a sample.

  /// (1) for one sample, in its unit.
  Vector corrected(const Vector& sample) const;
};

/// One line for a person.
const char* mag_fit_status_text(MagFit::Status status);

/// Fits (1) to samples of the raw field, in any unit. Costs a few ms for 5000 samples.
MagFit fit_magnetometer(std::span<const MagFit::Vector> samples, const MagFit::Limits& limits = {});

}  // namespace rosflight::companion
