// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/raw_motion.hpp"
#include "autonomy/multirotor/landing.hpp"

namespace rosflight::autonomy::multirotor {

/// Brings a multirotor down whose state is lost: level by the flight controller's own attitude, by thrust alone.
///
/// Vertical speed v and height z, up, from specific force f and altitude b of the barometer, by a complementary
/// filter with three equal poles w:
///
///     z' = v + 3 w e,   v' = f - g + beta + 3 w^2 e,   beta' = w^3 e,   e = b - b0 - z             (1)
///     T  = T_h limit(1 + k (v_wanted - v)),  v_wanted < 0 by Landing                                (2)
///
/// with the thrust T_h that hovered before. (1) is the third-order loop that inertial navigation steadies its
/// vertical channel with. Without the accelerometer f is that of the thrust, g T/T_h, and v_wanted is -kBlind_m_s.
/// Without the barometer e is 0: (2) holds for kIntegrates_s, as a longer integral of an accelerometer drifts, and from
/// then on T is the mean of its last 2 s less kMargin T_h, with which drag keeps the speed. Without either T is kShare of T_h.
///
/// The ground: by Landing where there are both, by the range sensor, by an altitude of the barometer that stands
/// still. Where nothing shows it T falls by kFall_1_s from the time on in which the vehicle comes down from its last
/// known height at kSlowest_m_s: one that has kept its height by a wrong T_h sinks then, and with less than kNone of
/// T_h none flies. No heap, no clock.
class LevelSink {
 public:
  static constexpr double kShare = 0.98;
  static constexpr double kIntegrates_s = 8.0;
  static constexpr double kMargin = 0.006;  ///< For a bias of 0.06 m/s^2.
  static constexpr double kBlind_m_s = 0.7;
  static constexpr double kSlowest_m_s = 0.4;
  static constexpr double kSpare_s = 15.0;  ///< On top of that time.
  static constexpr double kFall_1_s = 0.005;
  static constexpr double kNone = 0.7;

  /// The vehicle when its state was last known.
  struct Start {
    double height_m{};  ///< Above the position of take-off.
    double down_speed_m_s{};
    double hover_thrust_N{};
    double gravity_m_s2{9.81};
    std::optional<double> standing_range_m;  ///< What the range sensor read on the ground.
  };
  struct Output {
    double thrust_N{};
    bool touched{};  ///< It stands, without thrust.
  };

  /// Begins a descent. @param config  of the landing; its speeds are those of the descent.
  void start(const LandingConfig& config, const Start& from);
  /// Once a control period.
  Output step(const RawMotion& raw, std::optional<double> range_m, double dt_s);
  /// Others fly: the next step takes the height from the barometer and begins without vertical speed.
  void interrupt();

  /// Vertical speed by (1) [m/s], positive down.
  double down_speed_m_s() const { return -up_m_s_; }

 private:
  void observe(const RawMotion& raw, double dt_s);
  void correct(double baro_up_m, double dt_s);
  bool by_baro() const;
  Output land(double dt_s, bool at_ground);
  Output sink(const RawMotion& raw, double dt_s);
  void watch_ground(const RawMotion& raw, double dt_s);

  Landing landing_;
  Start from_{};
  double up_m_{};  ///< z.
  double up_m_s_{};
  double bias_m_s2_{};
  double baro_origin_m_{};
  double silent_s_{};  ///< Without the barometer.
  double since_s_{};   ///< Start of the descent.
  double at_ground_s_{};
  double still_s_{};  ///< Without a change of still_up_m_ [m], by the barometer.
  double still_up_m_{};
  double thrust_N_{};
  double steady_share_{kShare};  ///< Share of the thrust that hovers, without the barometer.
  double without_baro_s_{};      ///< How long it has been measured.
  bool baro_known_{false};       ///< baro_origin_m_ is set.
  bool interrupted_{false};
  bool unloads_{false};  ///< The thrust falls to none.
};

}  // namespace rosflight::autonomy::multirotor
