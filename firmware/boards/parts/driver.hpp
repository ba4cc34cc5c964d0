// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <atomic>
#include <cstdint>

#include "firmware/boards/parts/bus.hpp"
#include "firmware/boards/parts/text.hpp"

namespace rosflight::boards::parts {

/// How a part is brought up.
enum class Start : std::uint8_t {
  kCold,  ///< Soft reset, identity, set-up.
  kWarm  ///< The part kept running through a reset of the chip: identity and set-up are read back and
         ///< rewritten only if wrong. No reset, no wait.
};

enum class PartState : std::uint8_t { kOff, kStarting, kRunning, kFailed };

class Setup;

/// What all drivers of parts on a bus share: the life of a part.
///
///     kOff -> kStarting -> kRunning
///                 ^  |        |
///                 |  v        v
///                kFailed <----+
///
/// A part runs when its start-up has ended; it is well when it then delivers. A part that was well and
/// fails is started again at the
/// next tick, warm: a transient fault costs a few samples, and a part that lost its set-up gets it back.
/// A warm start that fails is followed by a cold one, and that is repeated once per second. The rest of
/// the board waits for none of this.
class Driver {
 public:
  static constexpr Time kRetry = hal::milliseconds(1000);
  static constexpr std::uint8_t kFailuresInARow = 10;  ///< Transfers until a part failed.

  /// Begins to bring the part up. Bus context, or before interrupts are on.
  void start(Start how, Time now);
  /// Bus context, once per tick (1 kHz or faster).
  void step(Time now);

  /// Main loop or bus context, as all below.
  PartState state() const { return state_.load(std::memory_order_acquire); }
  /// One line for people: "DPS310: identity 0x00, expected 0x10", or "DPS310: ok". Empty before.
  const char* message() const { return message_.data(); }
  /// Rises when message() has something new to say: the first failure after a success, and the first
  /// success after a failure. Repeated failures of a dead part do not count.
  std::uint16_t announcements() const { return announcements_.load(std::memory_order_acquire); }
  /// The last announcement was a failure.
  bool failure_announced() const { return failure_announced_.load(std::memory_order_acquire); }
  /// Failed starts, failed transfers and damaged samples since construction, but for those of a part whose failure has
  /// been announced; stops at 65535.
  std::uint16_t errors() const { return errors_.load(std::memory_order_relaxed); }
  /// It has delivered something good since construction: the part is there.
  bool was_well() const { return was_well_.load(std::memory_order_relaxed); }
  /// It has sent something since construction, good or not: a part is there.
  bool answered() const { return answered_.load(std::memory_order_relaxed) || was_well(); }

 protected:
  explicit Driver(const char* name) : name_{name} {}
  ~Driver() = default;

  /// Begins the start-up. @returns false if a transfer of the last one is still under way.
  virtual bool begin(Start how, Time now) = 0;
  /// One tick of the start-up; calls started() or fail() at its end.
  virtual void step_start(Time now) = 0;
  /// One tick while running.
  virtual void step_running(Time now) = 0;

  /// One tick of a start-up by a table of registers. @returns true once it has ended well; if it
  /// failed, so has the part.
  bool step_setup(Setup& setup, Time now);
  /// When the last start began. A part that kept running through a reset of the chip may be in a measurement that
  /// was commanded before, which has to end first.
  Time begun() const { return begun_; }
  /// The start-up has ended.
  void started();
  /// The part has delivered something good; called for each of it.
  void well();
  /// The part failed; the caller adds what happened to the text that is returned.
  Text fail(Time now);
  /// A transfer of the part ended. @returns whether it went well; kFailuresInARow that did not fail
  /// the part.
  bool good(TransferResult result, Time now);
  void count_error();
  /// The part has sent something that cannot be used.
  void note_answer() { answered_.store(true, std::memory_order_relaxed); }

 private:
  void announce() { announcements_.store(static_cast<std::uint16_t>(announcements() + 1)); }

  const char* name_;
  Time begun_{};
  Time retry_at_{};
  Start retry_{Start::kCold};
  Start how_{Start::kCold};
  std::uint8_t failures_in_a_row_{0};
  bool well_{false};  ///< Since the last start.
  std::array<char, 64> message_{};
  std::atomic<PartState> state_{PartState::kOff};
  std::atomic<std::uint16_t> errors_{0};
  std::atomic<bool> was_well_{false};
  std::atomic<bool> answered_{false};
  std::atomic<bool> failure_announced_{false};  ///< Since it was last well.
  std::atomic<std::uint16_t> announcements_{0};
};

}  // namespace rosflight::boards::parts
