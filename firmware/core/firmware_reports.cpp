// SPDX-License-Identifier: BSD-3-Clause
// The part of Firmware that executes commands and sends reports.
#include <algorithm>
#include <limits>
#include <utility>

#include "firmware/core/firmware.hpp"
#include "firmware/core/version.hpp"

namespace rosflight::core {
namespace {

constexpr Time kRebootDelay = hal::milliseconds(20);  // time to send the acknowledgement

}  // namespace

// ---- commands

bool Firmware::run_command(link::Command command, Time now) {
  switch (command) {
    case link::Command::kRcCalibration:
      return capture_trim();
    case link::Command::kAccelCalibration:
      sensors_.start_accel_calibration();
      return true;
    case link::Command::kGyroCalibration:
      sensors_.start_gyro_calibration();
      return true;
    case link::Command::kBaroCalibration:
      sensors_.start_baro_calibration();
      return true;
    case link::Command::kAirspeedCalibration:
      sensors_.start_airspeed_calibration();
      return true;
    case link::Command::kReadParams:
      if (store_.busy() || load_parameters() != StoreResult::kOk) return false;
      forget_accel_calibration();
      return true;
    case link::Command::kWriteParams:
      return false;  // could not start
    case link::Command::kSetParamDefaults:
      parameters_.reset_to_defaults();
      forget_accel_calibration();
      return true;
    case link::Command::kReboot:
    case link::Command::kRebootToBootloader:
      reboot_to_bootloader_ = command == link::Command::kRebootToBootloader;
      reboot_at_ = now + kRebootDelay;
      return true;
    case link::Command::kSendVersion: {
      link::Version version;
      version.text = Text(kVersion).chars();
      telemetry_.send(version);
      log_.info(Text("Longest period: ")
                    .add(static_cast<std::int32_t>(std::min<std::int64_t>(
                        max_pass_.count(), std::numeric_limits<std::int32_t>::max())))
                    .add(" us"));
      max_pass_ = Time{0};
      return true;
    }
  }
  return false;
}

/// @returns false without a radio: old stick positions are no trim.
bool Firmware::capture_trim() {
  if (state_.has(Error::kRcLost)) {
    log_.error("RC signal lost: no trim");
    return false;
  }
  const auto torque = controller_.trim(command_.pilot());
  const auto axis = [](std::uint16_t k) {
    return static_cast<Param>(static_cast<std::uint16_t>(Param::kXEqTorque) + k);
  };
  std::array<float, 3> sum{};
  bool in_range = true;
  for (std::uint16_t k = 0; k < 3; ++k) {
    sum[k] = parameters_.get_float(axis(k)) + torque[k];
    in_range = in_range && Parameters::in_range(axis(k), ParamValue{sum[k]});
  }
  if (in_range) {
    for (std::uint16_t k = 0; k < 3; ++k) {
      static_cast<void>(parameters_.set_float(axis(k), sum[k]));
    }
    log_.warning("Equilibrium torques found and applied");
    log_.warning("Now zero the trims of the transmitter");
    log_.warning("and write the parameters to keep them");
  } else {
    log_.error("Equilibrium torque out of range, not taken");
  }
  return in_range;
}

// ---- reports

void Firmware::send_counters() {
  const auto us = [](Time t) {
    return static_cast<std::uint32_t>(
        std::min<std::int64_t>(t.count(), std::numeric_limits<std::uint32_t>::max()));
  };
  link::Counters c;
  c.longest_pass_us = us(counters_.longest());
  c.pass_budget_us = us(PassCounters::kBudget);
  c.passes_over_budget = counters_.over_budget();
  c.passes = counters_.passes();
  c.frames_dropped = codec_.counters().frames_dropped;
  c.tx_dropped = telemetry_.dropped();
  c.texts_lost = log_.lost();
  c.imu_jitter = counters_.jitter();
  const auto& rejected = sensors_.rejected();
  static_assert(std::tuple_size_v<std::decay_t<decltype(rejected)>> <= link::kCounterBins);
  std::copy(rejected.begin(), rejected.end(), c.rejected.begin());
  c.rejected[static_cast<std::size_t>(Reject::kExternalAttitude)] = estimator_.external_rejected();
  telemetry_.send(c);
}

/// At most one text every 10 s while the link loses frames or texts.
void Firmware::report_losses(Time now) {
  const std::array<std::uint32_t, 3> lost{codec_.counters().frames_dropped, telemetry_.dropped(),
                                          log_.lost()};
  if (!telemetry_.connected()) {  // without a companion frames are expected to be lost
    reported_losses_ = {lost[0], lost[1], reported_losses_[2]};
    return;
  }
  if (lost == reported_losses_ || !loss_texts_.allow(now)) return;
  reported_losses_ = lost;
  log_.warning(Text("Link lost: in ")
                   .add(static_cast<std::int32_t>(lost[0]))
                   .add(", out ")
                   .add(static_cast<std::int32_t>(lost[1]))
                   .add(", texts ")
                   .add(static_cast<std::int32_t>(lost[2])));
}

/// Reports a sensor that stops delivering samples or delivers them again, and the start-ups and
/// transfers that the board counts as failed. The errors of a sensor that fails are not reported in addition to its
/// failure, so they are given until the next call to become one.
void Firmware::report_sensors(Time now) {
  for (std::size_t k = 0; k < kAidCount; ++k) {
    const bool silent = sensor_watch_.silent(static_cast<Aid>(k), now);
    if (silent == reported_silent_[k]) continue;
    reported_silent_[k] = silent;
    log_.push(silent ? Severity::kError : Severity::kInfo,
              Text(silent ? "Sensor silent: " : "Sensor answers again: ").add(kAidNames[k]));
  }
  const std::uint16_t errors = board_.system.sensor_errors();
  const bool new_errors = errors != reported_sensor_errors_;
  const bool waited = std::exchange(sensor_errors_wait_, new_errors);
  if (!new_errors || !waited || !sensor_texts_.allow(now)) return;
  reported_sensor_errors_ = errors;
  log_.error(Text("Sensor errors since start: ").add(std::int32_t{errors}));
}

/// The text stands for the errors that came with the failure.
void Firmware::report_sensor_changes() {
  bool ok = false;
  const char* const change = board_.system.sensor_change(ok);
  if (change == nullptr) return;
  log_.push(ok ? Severity::kInfo : Severity::kError, change);
  reported_sensor_errors_ = board_.system.sensor_errors();
}

}  // namespace rosflight::core
