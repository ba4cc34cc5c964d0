// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/fixedwing/flight_config.hpp"
#include "autonomy/fixedwing/glide.hpp"

namespace rosflight::autonomy::fixedwing {

/// Flies a glide without a motor: its path is planned again twice a second with the wind and the
/// glide ratio of now, until the vehicle is near the final part. Without a path it circles the
/// landing place, or flies straight towards it when it is out of reach.
class GlideFlight {
 public:
  struct Input {
    double t_s{};
    double dt_s{};
    const StateEstimate& state;
    const FlightConfig& config;
    Field landing{};    ///< First choice,
    Field start{};      ///< and where to when that is out of reach.
    double radius_m{};  ///< Of turns.
    bool position_lost{};
  };

  /// Forgets the glide before and the path.
  void begin(const Input& in, PathManager& path);
  /// The path to follow. Plans into `path`; a path that cannot be planned leaves the one before.
  CurrentPath step(const Input& in, PathManager& path);
  /// There is a path down, and `path` leads along it.
  bool planned() const { return glide_.has_value(); }

 private:
  void learn_ratio(const Input& in);
  void plan(const Input& in, PathManager& path);

  std::optional<GlidePath> glide_;
  double began_s_{};
  double planned_s_{};
  double ratio_{};  ///< Distance per height: of the settings, then as it is measured.
};

}  // namespace rosflight::autonomy::fixedwing
