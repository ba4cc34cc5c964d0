// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <atomic>
#include <cstdint>

#include "firmware/boards/parts/bus.hpp"

namespace rosflight::boards::parts {

/// How a part is brought up.
enum class Start : std::uint8_t {
  kCold,  ///< Soft reset, identity, set-up.
  kWarm  ///< The part kept running through a reset of the chip: identity and set-up are read back and
         ///< rewritten only if wrong. No reset, no wait.
};

enum class PartState : std::uint8_t { kOff, kStarting, kRunning, kFailed };

/// What all part drivers share. A part that fails to start, or falls silent later, is reported once
/// and tried again once per second from the beginning; the rest of the board does not wait for it.
class Driver {
 public:
  /// Begins to bring the part up. Bus context, or before the interrupts are on.
  virtual void start(Start how, Time now) = 0;
  /// Bus context, once per tick (1 kHz or faster).
  virtual void step(Time now) = 0;

  /// Main loop or bus context.
  PartState state() const { return state_.load(std::memory_order_acquire); }
  /// One line for people, such as "DPS310: identity 0x00, expected 0x10"; "DPS310: ok" once it runs.
  /// The last failure stays until the part runs. Main loop.
  const char* message() const { return message_.data(); }
  /// Failed starts, failed transfers and damaged samples since construction.
  std::uint16_t errors() const { return errors_.load(std::memory_order_relaxed); }

 protected:
  ~Driver() = default;
  void set_state(PartState state) { state_.store(state, std::memory_order_release); }
  /// Counts one error, up to 65535.
  void count_error() {
    const std::uint16_t errors = errors_.load(std::memory_order_relaxed);
    if (errors != 0xFFFFu)
      errors_.store(static_cast<std::uint16_t>(errors + 1), std::memory_order_relaxed);
  }
  static constexpr std::size_t kMessageBytes = 64;
  std::array<char, kMessageBytes> message_{};

 private:
  std::atomic<PartState> state_{PartState::kOff};
  std::atomic<std::uint16_t> errors_{0};
};

}  // namespace rosflight::boards::parts
