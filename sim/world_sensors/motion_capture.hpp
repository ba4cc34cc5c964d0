// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/vector_errors.hpp"
#include "sim/world_sensors/make_world_sensor.hpp"

namespace rosflight::sim {

/// Times when something fails by itself: intervals and durations are exponential with these means.
class DropOuts {
 public:
  struct Parameters {
    double interval_s{};  ///< Mean time between drop-outs; 0: none.
    double duration_s{};  ///< Mean; > 0 where there are drop-outs.
  };
  DropOuts(const Parameters& parameters, RandomStream stream);
  /// Call it with times that do not go back.
  bool active(Time now);

 private:
  Time random_duration(double mean_s);
  Parameters parameters_;
  RandomStream stream_;
  bool active_{false};
  Time change_{};  ///< Next change of active_.
};

/// Cameras around a room that measure the pose of the vehicle's body, from outside and without its help:
///
///     p = p_W + e_p,   q = q_WB * (1, e_B/2)/|(1, e_B/2)|                                     (1)
///
/// e_p along north, east and down, e_B about the body's axes, both by the laws of sim/noise.hpp. p_W is the body's
/// centre of mass in the local frame of the vehicle file. Its message is geometry_msgs/PoseStamped in the frame `map` (x east, y
/// north, z up) of base_link (x forward, y left, z up), stamped with the time of measurement; it arrives `delay_us` later.
/// There is no sample in a drop-out, nor farther than max_m from the origin.
class MotionCapture {
 public:
  using Sample = PoseSample;

  struct Config {
    Timing timing{true, Time{10'000}, Time{0}, Time{0}};
    sensors::VectorErrorParameters position_m;
    sensors::VectorErrorParameters attitude_rad;
    double max_m{1000.0};
    DropOuts::Parameters dropouts;
  };
  /// Its keys in a vehicle file, with units and limits.
  static config::Table<Config> parameters();

  MotionCapture(const Config& config, const WorldSensorSite& site);
  /// (1). @returns false in a drop-out and outside the room.
  bool measure(const Truth& truth, Sample& sample);

 private:
  Config config_;
  sensors::VectorErrorModel position_;
  sensors::VectorErrorModel attitude_;
  DropOuts dropouts_;
};

}  // namespace rosflight::sim
