// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/fixedwing/flight_config.hpp"
#include "autonomy/fixedwing/glide.hpp"

namespace rosflight::autonomy::fixedwing {

/// Flies a glide without a motor: its path is planned again twice a second with the wind and the
/// glide ratio of now, until the vehicle is near the final part. Without a path it circles the
/// landing point, or flies straight towards it when it is out of reach.
///
/// Height that is left over at the end of the path is used up by airspeed, whose drag grows:
///
///     V = V0 (1 + 2 s/h),  s = h + (V^2 - V0^2)/2g - needed,  V <= 1.4 V0                   (1)
///
/// and no faster than the last metres take back: V^2 <= V0^2 + g (h - 3 m).
class GlideFlight {
 public:
  struct Input {
    double t_s{};
    double dt_s{};
    const StateEstimate& state;
    const FlightConfig& config;
    Field landing{};        ///< First choice,
    Field start{};          ///< and where to when that is out of reach.
    double radius_m{};      ///< Radius of turns.
    double airspeed_m_s{};  ///< V0 of (1): of the settings, and more in gusts.
    bool position_lost{};
  };

  /// Forgets the glide before and the path.
  void begin(const Input& in, PathManager& path);
  /// The path to follow. Plans into `path`; a path that cannot be planned leaves the one before.
  CurrentPath step(const Input& in, PathManager& path);
  /// (1): the airspeed to hold.
  double airspeed_m_s(const Input& in) const;
  /// There is a path down, and `path` leads along it.
  bool planned() const { return glide_.has_value(); }

 private:
  void learn_ratio(const Input& in);
  void plan(const Input& in, PathManager& path);

  std::optional<GlidePath> glide_;
  double began_s_{};
  double planned_s_{};
  double spare_m_{};  ///< s of (1).
  double ratio_{};    ///< Distance per height: of the settings, then as it is measured.
};

}  // namespace rosflight::autonomy::fixedwing
