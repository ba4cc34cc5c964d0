// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "firmware/core/test/flight_coverage.hpp"
#include "firmware/core/test/watched_firmware.hpp"

namespace rosflight::core {

/// Watches a firmware and its twin through one flight. The twin gets the same input but for
/// messages to another system, and a companion with another id.
class FlightInvariants {
 public:
  explicit FlightInvariants(const RandomFlight& flight);

  /// After each pass. @returns false once firmware and twin differ: nothing more can be said.
  bool check(const PassInputs& in, const WatchedFirmware& watched, const WatchedFirmware& twin);

  /// The first of each kind.
  const std::vector<Violation>& violations() const { return violations_; }
  const Coverage& coverage() const { return coverage_; }

 private:
  using Values = std::array<std::uint32_t, kParamCount>;

  void take_note(const PassInputs& in, const WatchedFirmware& watched);
  void note_frame(const hal::RcFrame& frame, const Firmware& firmware);
  void note_restart(const PassInputs& in, const WatchedFirmware& watched);
  void note_state(const WatchedFirmware& watched);
  void count(const PassInputs& in, const WatchedFirmware& watched);

  void check_motors(const WatchedFirmware& watched);
  void check_idle_after_arming(const WatchedFirmware& watched);
  void check_motor_test(const WatchedFirmware& watched);
  void check_imu(const WatchedFirmware& watched);
  void check_receiver(const WatchedFirmware& watched);
  void check_companion(const WatchedFirmware& watched);
  void check_command(const WatchedFirmware& watched);
  void check_arming(const WatchedFirmware& watched);
  void check_disarming(const WatchedFirmware& watched);
  void check_work(const WatchedFirmware& watched);
  void check_state(const WatchedFirmware& watched);
  void check_parameters(const WatchedFirmware& watched);
  void check_twin(const WatchedFirmware& watched, const WatchedFirmware& twin);

  void fail(const char* invariant, const std::string& detail);
  bool is_motor(const Firmware& firmware, std::size_t channel) const;

  std::vector<Violation> violations_;
  Coverage coverage_;
  std::uint64_t seed_;
  bool has_foreign_;
  bool differs_{false};

  static constexpr Time kNever = hal::milliseconds(-3'600'000);
  Time now_{};
  State before_{State::kInit};
  bool armed_before_{false}, failsafe_before_{false};
  Time armed_at_{kNever}, disarmed_at_{kNever};
  bool on_ground_{true};  ///< The last arming was one on the ground.
  bool above_idle_{false}, above_idle_at_disarm_{false};
  Time glides_until_{};
  bool asked_{false};                             ///< For arming, since disarmed.
  bool stick_raised_{false}, commanded_{false};   ///< Since the arming.
  float throttle_{0.0f}, throttle_before_{0.0f};  ///< Newest good frame; the one before.
  Time imu_any_{}, stuck_at_{};
  int unusable_{0};  ///< Samples in a row.
  bool imu_latched_{false};
  Time rc_any_{}, rc_not_bad_{};
  bool rc_bad_now_{false}, rc_failsafe_now_{false};
  int off_frames_{0};  ///< In a row with the arm switch off.
  Time off_since_{}, corner_since_{}, rc_good_{kNever};
  bool in_corner_{false};  ///< The sticks are in the disarming corner.
  Time offboard_{kNever}, companion_{kNever}, parameters_changed_{kNever};
  Time motor_test_{kNever};
  int auxiliary_over_writes_{0};  ///< Passes that wrote outputs since auxiliary motors must stop.
  std::array<Time, 3> rearmed_{kNever, kNever, kNever};
  std::uint16_t servo_once_{0};
  bool armed_at_scan_{false};
  Values values_{};
  bool values_known_{false};
  int until_scan_{0};
};

}  // namespace rosflight::core
