// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "companion/transport.hpp"
#include "firmware/core/command.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/state_machine.hpp"
#include "flight/autopilot/link_tap.hpp"
#include "sim/modules.hpp"

namespace rosflight::flight {

/// State of the firmware for records and reports.
struct FirmwareView {
  core::State state{};
  bool armed{};
  bool failsafe{};
  std::uint16_t errors{};        ///< Bits of core::Error.
  std::uint16_t primary_axes{};  ///< Channels of `command` that the pilot commands, one bit each.
  std::array<float, 10> command{};  ///< Combined command, in the units of its types.
  std::array<core::CommandType, 10> command_type{};
  core::Quaternion q_WB{};
  float roll_rad{};
  float pitch_rad{};
};

/// Measured by an autopilot with a processor of its own.
struct ProcessorFigures {
  std::uint32_t stack_bytes{};    ///< High-water mark.
  std::uint64_t instructions{};   ///< Executed in passes.
  std::uint64_t passes{};         ///< Passes of the main loop.
  std::uint32_t resets{};         ///< After the first start.
  std::uint64_t uart_received{};  ///< Bytes over its own serial port, if it has one.
  std::uint64_t uart_sent{};
  std::uint64_t uart_lost{};  ///< Bytes that arrived too fast, and frames that found no room.
  std::uint32_t imu_to_output_us{};  ///< Armed, the longest from a data-ready edge to an output.
  double imu_to_output_mean_us{};    ///< Armed, mean of the longest of each step.
  /// Armed, the longest from the end of the IMU's transfer to an output.
  std::uint32_t transfer_to_output_us{};
  double stamp_error_us{};  ///< Armed, the largest of an IMU stamp; up to the first reset.
  double armed_us{};        ///< Time armed, of an autopilot that counts its sleep.
  double slept_us{};        ///< The part of armed_us that the processor slept.
};

/// Flight control hardware with the real firmware: the system under test of a flight.
///
/// Four implementations: InProcessAutopilot, EmulatedAutopilot (Cortex-M7 in lock-step),
/// UartAutopilot (Cortex-M7 in real time, over its own UART) and ChipAutopilot (STM32H7 in lock-step).
class Autopilot : public sim::AutopilotModule {
 public:
  enum class Breakdown : std::uint8_t {
    kCrash,      ///< The processor takes a fault in its sensor driver.
    kHang,       ///< The sensor driver never returns; the watchdog resets the processor.
    kPowerLoss,  ///< Power fails and returns: backup memory is lost.
  };

  /// Lasts until it is replaced.
  enum class Impairment : std::uint8_t {
    kNone,
    kSlowPasses,        ///< Each pass of the main loop takes 3 ms.
    kReversedImuClock,  ///< Stamps of samples go back as fast as time goes on.
  };

  /// How many substeps of sim::LockStep make one of its steps.
  virtual unsigned substeps() const { return 1; }
  /// Powers up at time t. Call it once, before the first step.
  virtual void start(sim::Time t) = 0;
  /// Breaks now or in the next step. kCrash and kHang leave a record in backup memory; each kind
  /// ends with a reset.
  virtual void break_down(sim::Time t, Breakdown kind) = 0;
  /// @returns false: this one cannot have it.
  virtual bool set_impairment(sim::Time /*t*/, Impairment kind) {
    return kind == Impairment::kNone;
  }
  /// Simulated time at which the firmware's clock was zero.
  virtual sim::Time boot_time() const = 0;
  virtual FirmwareView view() const = 0;
  /// The companion's end of the link.
  virtual companion::Transport& link() = 0;
  /// Shows every frame on the link to `tap`; nullptr: none.
  virtual void set_link_tap(LinkTap* tap) = 0;
  /// Empty unless the processor is emulated.
  virtual std::optional<ProcessorFigures> figures() const { return std::nullopt; }
};

}  // namespace rosflight::flight
