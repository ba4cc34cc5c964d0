// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "sim/environment/dryden.hpp"

namespace rosflight::sim {

/// Discrete gusts, off while mean_interval_s is 0.
struct GustParameters {
  double mean_interval_s{0.0};
  double magnitude_mean_m_s{0.15};  ///< Mean of the normal law; negative draws are drawn again.
  double magnitude_std_m_s{0.3};
  double direction_std{0.1};  ///< Per axis, added to the unit vector of the steady wind.
  double min_s{0.5};
  double max_s{5.0};
};

struct WindParameters {
  Vector3 steady_W_m_s{Vector3::Zero()};
  Vector3 random_std_W_m_s{Vector3::Zero()};  ///< Drawn once a run, added to the steady part.
  double turbulence_w20_m_s{0.0};             ///< 0: no turbulence.
  GustParameters gusts;
};

/// Velocity of the air over ground: steady + Dryden turbulence + one-minus-cosine gusts,
///
///     gust(t) = A/2 (1 - cos(2 pi t/T)) u,   0 <= t <= T         (F. W. Leahy, NASA, 2008)
///
/// that start as a Poisson process, add up, have A >= 0 and T uniform in its range; u is
/// the direction of the steady wind with some spread, any direction without steady wind. Turbulence
/// axes: along the steady wind (north without), to its right, down. The number of gusts at a time
/// is bounded (kMaxGusts); no heap in step().
class Wind {
 public:
  /// @param source  of the random part, turbulence and gusts.
  Wind(const WindParameters& parameters, const RandomSource& source);

  /// Advances by dt_s. @param height_m  above ground. @param airspeed_m_s  of the vehicle.
  const Vector3& step(double dt_s, double height_m, double airspeed_m_s);
  const Vector3& velocity_W() const { return velocity_W_; }
  /// No turbulence and no gusts: step() changes nothing.
  bool calm() const { return calm_ && gusts_.empty(); }

  /// From now on another steady wind and turbulence (0: none); gusts of the parameters stay.
  /// @param source  of the turbulence, which starts again.
  void set(const Vector3& steady_W_m_s, double w20_m_s, const RandomSource& source);
  /// One gust that starts now. @param duration_s  > 0.
  void add_gust(const Vector3& peak_W_m_s, double duration_s);

 private:
  static constexpr std::size_t kMaxGusts = 16;
  struct Gust {
    Vector3 peak_W;
    double duration_s;
    double age_s;
  };
  void set_steady(const Vector3& steady_W);
  void step_gusts(double dt_s);
  Gust draw_gust(double age_s);

  GustParameters gust_parameters_;
  Vector3 steady_W_;
  Vector3 direction_W_{Vector3::Zero()};  ///< Direction of the steady wind; zero without.
  Vector3 along_W_{Vector3::UnitX()};     ///< Horizontal.
  std::optional<DrydenTurbulence> turbulence_;
  RandomStream gust_stream_;
  double next_gust_s_{0.0};
  std::vector<Gust> gusts_;
  bool calm_;
  Vector3 velocity_W_;
};

}  // namespace rosflight::sim
