// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/boards/stm32h7/test/contract_image.hpp"

namespace rosflight::boards::stm32h7 {

/// Sleeps, so that the emulated chip need not execute a loop; ticks of 1 ms wake the processor.
void sleep_for(hal::Time time);

/// The host at the far end of the link, which is at the same time the world of the board
/// (flight/test/contract_world.hpp). An order is a line that begins with '@', between what GoogleTest prints:
///
///     @arguments            what to do, and what has just happened: OPTION AFTER
///     @show KIND BYTES      the sensors of a kind are exposed to this sample from now on: TIMES
///     @frame BYTES          the receiver sends this frame: TIMES
///     @send BYTES           the far end sends these bytes
///     @mark                 what follows, orders aside, is the test's
///     @report               BYTES that came since the last @mark; none if there was none since the last @report
///     @wait                 nothing
///     @restart, @power      the test resets the processor now; asks for the power to be cut
///     @end STATUS           the tests have ended
///
/// BYTES are pairs of hexadecimal digits. OPTION AFTER, TIMES and BYTES are answers, each a line. TIMES are two on the
/// board's clock [us]: when the exposure began, and for which time the sample is valid, from which a moving world goes on.
class FarEnd {
 public:
  /// What happened before this start. A test that restarts the processor is run again by the image that
  /// starts then; its traits let what it did before the restart have no effect.
  enum class After : std::uint8_t { kPowerOn, kReset, kBootloader, kPowerCycle };
  using Bytes = std::vector<std::uint8_t>;

  /// Asks what to do; once. @returns an option of GoogleTest without its beginning "--gtest_".
  std::string begin();
  After after() const { return after_; }

  void tell(const std::string& order);
  /// @returns the answer.
  std::string ask(const std::string& order);
  struct Exposure {
    hal::Time begin{}, valid{};
  };
  /// An order with bytes, whose answer is TIMES.
  Exposure show(const char* order, const void* data, std::size_t size);
  void send(const Bytes& bytes) { tell("send " + hex(bytes.data(), bytes.size())); }
  Bytes report();
  /// Announces that the test resets the processor now; first the parts end their start-up, in which a reset of the
  /// processor would have the next start speak to them too early.
  void announce_reset();
  /// For an order behind which the host restarts the board.
  [[noreturn]] void end(const std::string& order);

 private:
  static std::string hex(const void* data, std::size_t size);
  bool read_line(std::string& line, hal::Time wait);

  After after_{After::kPowerOn};
  std::string begun_;
};

/// One per image.
FarEnd& far_end();

}  // namespace rosflight::boards::stm32h7
