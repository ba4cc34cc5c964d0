// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "apps/fly/link_tap.hpp"
#include "companion/transport.hpp"
#include "firmware/core/command.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/state_machine.hpp"
#include "sim/modules.hpp"

namespace rosflight::apps {

/// What a report shows of the firmware, whichever board it runs on.
struct FirmwareView {
  core::State state{};
  bool armed{};
  bool failsafe{};
  std::uint16_t errors{};
  std::uint16_t primary_entries{};
  std::array<float, 10> command{};  ///< Combined command.
  std::array<core::CommandType, 10> command_type{};
  core::Quaternion q_NB{};
  float roll_rad{};
  float pitch_rad{};
};

/// What only a board with a processor of its own can tell.
struct ProcessorFigures {
  std::uint32_t stack_bytes{};   ///< High-water mark.
  std::uint64_t instructions{};  ///< Executed in passes.
  std::uint64_t passes{};
  std::uint32_t resets{};         ///< After the first start.
  std::uint64_t uart_received{};  ///< Bytes over its own link, if it has one.
  std::uint64_t uart_sent{};
  std::uint64_t uart_lost{};  ///< Bytes received too fast, and frames that found no room.
};

/// A board that a flight can be flown with.
class FlightBoard : public sim::BoardModule {
 public:
  /// Powers up at time t.
  virtual void start(sim::Time t) = 0;
  /// Power fails and returns: a reboot that backup memory does not survive. `in_flight_fault`: a
  /// crash of the processor instead, after which backup memory holds a record.
  virtual void restart(sim::Time t, bool in_flight_fault) = 0;
  /// What can befall a processor in its sensor driver.
  enum class Breakdown : std::uint8_t { kCrash, kHang };
  /// It happens now or in the next step: a record is left, the board resets.
  virtual void break_down(sim::Time t, Breakdown kind) = 0;
  /// When the firmware's clock was zero.
  virtual sim::Time boot_time() const = 0;
  virtual FirmwareView view() const = 0;
  /// The companion's end of the link, if the board brings its own; nullptr: the simulated cable.
  virtual companion::Transport* link() { return nullptr; }
  /// Who sees the frames on a link of its own.
  virtual void set_link_tap(LinkTap* tap) { static_cast<void>(tap); }
  virtual std::optional<ProcessorFigures> figures() const { return std::nullopt; }
};

}  // namespace rosflight::apps
