// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>

#include "autonomy/fixedwing/dubins.hpp"
#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

struct GlideConfig {
  double airspeed_m_s{14.0};  ///< Sinks least, and some.
  double ratio{8.5};          ///< Distance per height in still air, straight on.
  double radius_m{50.0};      ///< Radius of turns.
  double flare_m{15.0};       ///< What the flare adds to the distance in still air.
  double beyond_m{0.0};       ///< Aimed this far beyond the field: short of it nothing helps.
  double gravity_m_s2{base::kStandardGravity_m_s2};
};

/// A landing point, and the course if only one will do.
struct Field {
  Vector3 aim_W{Vector3::Zero()};
  std::optional<double> course_rad;
};

/// How a glide comes down on a field.
struct GlidePath {
  Pose key{};  ///< Where the straight final part begins, on its course.
  Vector3 aim_W{Vector3::Zero()};
  double final_m{};  ///< From the key to the aim.
  double height_needed_m{};
  double spare_m{};  ///< Height that is left over: >= 0.
};

/// Plans glides without a motor. The path to a field is a Dubins path to the key, then straight on:
///
///     height = sum over the path of  ds V/(Vg(chi) E) n^(3/2)                                (1)
///     Vg(chi) = w.u + sqrt(V^2 - (w x u)^2)                                                 (2)
///     n^2 = 1 + (Vg^2/(g r cos c))^2,  sin c = (w x u)/V                                    (3)
///
/// with glide ratio E, wind w, direction u of the course chi, and load factor n and crab angle c in
/// turns of radius r (sink grows with n^(3/2) at the speed of least sink; straight on n is 1). The
/// key is moved along the final until (1) uses up the height there is. Beard & McLain, Small
/// Unmanned Aircraft, 2012, sec. 9.2 for (2).
/// No state, no heap; some 1300 Dubins paths a call.
class GlidePlanner {
 public:
  explicit GlidePlanner(const GlideConfig& config) : config_(config) {}

  /// Height that a path to the field takes, whose final part is `final_m` long.
  double height_needed_m(const Pose& from, const Pose& key, double final_m,
                         const Vector2& wind_m_s) const;
  /// Height that a straight final part of this length takes; its flare adds to the distance as the
  /// speed over ground does.
  double final_height_m(double final_m, double course_rad, const Vector2& wind_m_s) const;
  /// Ground distance per height along a course.
  double distance_per_height(double course_rad, const Vector2& wind_m_s) const;
  /// Height lost in one whole turn.
  double turn_height_m() const;

  /// The path down to the field at the best of 16 courses. The first one, that of the field or
  /// against the wind, is kept unless on another the height left over, and what is uncertain about
  /// it, are clearly less distance over ground.
  /// @param height_m  above the field, `from` being the vehicle.
  /// @return empty: none is within reach, or it is more than a turn too high for all.
  std::optional<GlidePath> plan(const Pose& from, double height_m, const Field& field,
                                const Vector2& wind_m_s) const;
  /// No field is within reach of this height, even straight on.
  bool out_of_reach(const Pose& from, double height_m, const Field& field,
                    const Vector2& wind_m_s) const;

 private:
  double arc_height_m(double length_m, double course_rad, const Vector2& wind_m_s) const;
  std::optional<GlidePath> on_course(const Pose& from, double height_m, const Field& field,
                                     double course_rad, const Vector2& wind_m_s) const;

  GlideConfig config_;
};

}  // namespace rosflight::autonomy::fixedwing
