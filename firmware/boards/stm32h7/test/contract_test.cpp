// SPDX-License-Identifier: BSD-3-Clause
// The contract suites of the HAL on a board itself, as far as the processor can see what its peripherals do.
#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

#include "firmware/boards/common/memories.hpp"
#include "firmware/boards/stm32h7/test/contract_image.hpp"
#include "firmware/core/test/arithmetic_contract.hpp"
#include "firmware/hal/test/contract/backup_memory_contract.hpp"
#include "firmware/hal/test/contract/clock_contract.hpp"
#include "firmware/hal/test/contract/leds_contract.hpp"
#include "firmware/hal/test/contract/outputs_contract.hpp"
#include "firmware/hal/test/contract/storage_contract.hpp"
#include "firmware/hal/test/contract/system_contract.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

ObjectStorage<BoardUnderTest> under_test;

void sleep_ms(int ms) {
  for (int k = 0; k < ms; ++k) wait_us(1000);
}

struct Microseconds {
  hal::Clock& role() { return board_under_test().roles.clock; }
  void pass(hal::Time time) { wait_us(static_cast<std::uint32_t>(time.count())); }
};

/// What the registers of the timers make of the pins.
struct TimerPins {
  hal::Outputs& role() { return board_under_test().roles.outputs; }
  std::size_t channels() const { return board_under_test().plan.outputs.count; }
  /// 50 Hz in 16 bits: a count is 0.31 us of the 1000 us that a value spans.
  float resolution() const { return 5e-4f; }
  float driven(std::size_t k) {
    constexpr float kCountsPerMicrosecond = 200.0f;
    const Pulses::Channel& c = board_under_test().plan.outputs.channels[k];
    const std::uint32_t compare = reg(c.timer, tim::CCR1 + 4u * c.channel);
    const bool counts = tim::CR1_CEN.of(reg(c.timer, tim::CR1)) != 0;
    const bool enabled = (reg(c.timer, tim::CCER) >> (4u * c.channel) & 1u) != 0 &&
                         (!c.advanced || tim::BDTR_MOE.of(reg(c.timer, tim::BDTR)) != 0);
    constexpr std::uint32_t kForcedLow = 4, kForcedHigh = 5;
    const std::uint32_t modes = reg(c.timer, c.channel < 2 ? tim::CCMR1 : tim::CCMR2);
    const std::uint32_t mode = (c.channel % 2 == 0 ? tim::CCMR1_OC1M : tim::CCMR1_OC2M).of(modes);
    if (mode == kForcedLow || mode == kForcedHigh)
      return enabled && mode == kForcedHigh ? 1.0f : 0.0f;
    if (!counts || !enabled || compare == 0) return 0.0f;
    const auto prescaler = static_cast<float>(reg(c.timer, tim::PSC) + 1);
    return (static_cast<float>(compare) * prescaler / kCountsPerMicrosecond - 1000.0f) / 1000.0f;
  }
};

struct Backup {
  Backup() { memory.clear(); }
  hal::BackupMemory& role() { return memory; }
  void reset() { memory = BackupRam{&memory_at<std::uint8_t>(kBackupMemory)}; }
  BackupRam memory{&memory_at<std::uint8_t>(kBackupMemory)};
};

struct Medium {
  hal::Storage& role() { return board_under_test().roles.storage; }
  void power_cycle() {}
};

struct Lamps {
  Lamps() {
    for (const hal::Led led : {hal::Led::kOverride, hal::Led::kStatus}) role().set(led, false);
  }
  hal::Leds& role() { return board_under_test().roles.leds; }
  bool lit(hal::Led led) {
    const PinLeds::Pins& pins = board_under_test().plan.leds;
    const Pin& pin = led == hal::Led::kOverride ? pins.override_led : pins.status_led;
    return level(pin) != pins.low_is_lit;
  }
};

/// The board's, whose sensors are started once as the role demands, by whichever test comes first.
class StartedOnce final : public hal::System {
 public:
  void start_sensors() override {
    if (!std::exchange(started_, true)) board().start_sensors();
  }
  std::uint16_t sensor_errors() const override { return board().sensor_errors(); }
  const char* sensor_message(std::size_t index, bool& ok) const override {
    return board().sensor_message(index, ok);
  }
  void reset(bool to_bootloader) override { board().reset(to_bootloader); }
  void feed_watchdog() override { board().feed_watchdog(); }
  hal::Time busy_time() const override { return board().busy_time(); }
  bool shares_processor() const override { return board().shares_processor(); }

 private:
  static hal::System& board() { return board_under_test().roles.system; }
  bool started_{false};
};

StartedOnce system_under_test;

struct Processor {
  hal::System& role() { return system_under_test; }
  bool sensors_started() const { return false; }
  bool reset_asked() const { return false; }
  bool bootloader_asked() const { return false; }
};

}  // namespace

BoardUnderTest& board_under_test() {
  return *under_test.get();
}

void run_contracts(const BoardUnderTest& board) {
  under_test.make(board);
  asm volatile("cpsie i" ::: "memory");
  static_cast<void>(board.roles.serial.open(921'600, 0));
  // Sensors that are started do not start again, a processor that is reset does not return, and the power is
  // not the board's own to cut.
  char program[] = "contract";
  char filter[] =
      "--gtest_filter=-*StartsSensorsWhenAskedAndNotBefore:*ResetsOnlyWhenAsked:"
      "*ResetsIntoTheBootloaderWhenAsked:*SurvivesAPowerCycle";
  char* arguments[] = {program, filter, nullptr};
  int count = 2;
  ::testing::InitGoogleTest(&count, arguments);
  const int status = RUN_ALL_TESTS();
  std::printf("end of tests: %d\n", status);
  std::fflush(stdout);
  for (;;) sleep_ms(1);
}

}  // namespace rosflight::boards::stm32h7

namespace rosflight::hal::contract {

using boards::stm32h7::Backup;
using boards::stm32h7::Lamps;
using boards::stm32h7::Medium;
using boards::stm32h7::Microseconds;
using boards::stm32h7::Processor;
using boards::stm32h7::TimerPins;

INSTANTIATE_TYPED_TEST_SUITE_P(Board, ClockContract, Microseconds);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, OutputsContract, TimerPins);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, BackupMemoryContract, Backup);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, LedsContract, Lamps);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, StorageContract, Medium);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, SystemContract, Processor);

}  // namespace rosflight::hal::contract
