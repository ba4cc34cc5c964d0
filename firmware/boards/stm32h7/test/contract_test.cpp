// SPDX-License-Identifier: BSD-3-Clause
// The contract suites of the HAL on a board itself. Each test runs on a board whose power has just come on.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "firmware/boards/stm32h7/test/far_end.hpp"
#include "firmware/core/test/arithmetic_contract.hpp"
#include "firmware/hal/test/contract/backup_memory_contract.hpp"
#include "firmware/hal/test/contract/clock_contract.hpp"
#include "firmware/hal/test/contract/leds_contract.hpp"
#include "firmware/hal/test/contract/outputs_contract.hpp"
#include "firmware/hal/test/contract/serial_contract.hpp"
#include "firmware/hal/test/contract/storage_contract.hpp"
#include "firmware/hal/test/contract/system_contract.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

ObjectStorage<BoardUnderTest> under_test;

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

/// Behind the restart, what the test did before it has no effect: only then does it show that memory survived.
class ReplayedBackup final : public hal::BackupMemory {
 public:
  explicit ReplayedBackup(bool replays) : replays_{replays} {}
  bool read(std::uint8_t* data, std::size_t count) override { return memory().read(data, count); }
  bool write(const std::uint8_t* data, std::size_t count) override {
    return replays_ || memory().write(data, count);
  }
  void clear() override { memory().clear(); }
  bool replays() const { return replays_; }
  void end_replay() { replays_ = false; }

 private:
  static hal::BackupMemory& memory() { return board_under_test().roles.backup; }
  bool replays_;
};

struct Backup {
  hal::BackupMemory& role() { return memory; }
  void reset() {
    if (!memory.replays()) {
      far_end().announce_reset();
      board_under_test().roles.system.reset(false);
    }
    memory.end_replay();
  }
  ReplayedBackup memory{far_end().after() == FarEnd::After::kReset};
};

/// As ReplayedBackup.
class ReplayedStorage final : public hal::Storage {
 public:
  explicit ReplayedStorage(bool replays) : replays_{replays} {}
  std::size_t size() const override { return medium().size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    return medium().read(offset, data, count);
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    return replays_ || medium().write(offset, data, count);
  }
  bool flush() override { return replays_ || medium().flush(); }
  bool replays() const { return replays_; }
  void end_replay() { replays_ = false; }

 private:
  static hal::Storage& medium() { return board_under_test().roles.storage; }
  bool replays_;
};

struct Medium {
  hal::Storage& role() { return storage; }
  void power_cycle() {
    if (!storage.replays()) far_end().end("power");
    storage.end_replay();
  }
  ReplayedStorage storage{far_end().after() == FarEnd::After::kPowerCycle};
};

struct Lamps {
  hal::Leds& role() { return board_under_test().roles.leds; }
  bool lit(hal::Led led) {
    const PinLeds::Pins& pins = board_under_test().plan.leds;
    const Pin& pin = led == hal::Led::kOverride ? pins.override_led : pins.status_led;
    return level(pin) != pins.low_is_lit;
  }
};

/// The board's, whose reset() returns once the processor has been reset.
class RestartingSystem final : public hal::System {
 public:
  void start_sensors() override { board().start_sensors(); }
  std::uint16_t sensor_errors() const override { return board().sensor_errors(); }
  const char* sensor_message(std::size_t index, bool& ok) const override {
    return board().sensor_message(index, ok);
  }
  const char* sensor_change(bool& ok) override { return board().sensor_change(ok); }
  void reset(bool to_bootloader) override {
    if (far_end().after() == FarEnd::After::kPowerOn) {
      far_end().announce_reset();
      board().reset(to_bootloader);
    } else {
      restarted_ = true;
    }
  }
  void feed_watchdog() override { board().feed_watchdog(); }
  hal::Time busy_time() const override { return board().busy_time(); }
  bool shares_processor() const override { return board().shares_processor(); }
  bool restarted() const { return restarted_; }

 private:
  static hal::System& board() { return board_under_test().roles.system; }
  bool restarted_{false};
};

struct Processor {
  hal::System& role() { return system; }
  /// One of them measures: the barometer, in 21 ms.
  bool sensors_started() const {
    sleep_for(hal::milliseconds(100));
    hal::BaroSample sample;
    return board_under_test().roles.baro.poll(sample);
  }
  bool reset_asked() const { return system.restarted(); }
  bool bootloader_asked() const {
    return system.restarted() && far_end().after() == FarEnd::After::kBootloader;
  }
  RestartingSystem system;
};

/// The image has opened it, which may be done only once.
class OpenedSerial final : public hal::Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    return link().write(data, size, qos);
  }
  std::size_t writable() const override { return link().writable(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    return link().read(data, capacity);
  }

 private:
  static hal::Serial& link() { return board_under_test().roles.serial; }
};

/// The link, over which orders and results go as well. While a frame of its own is on its way and the interrupts
/// of the bus context are masked, no frame of the test leaves its queue.
struct Link {
  using Bytes = FarEnd::Bytes;
  Link() {
    static_cast<void>(far_end().report());  // all that was printed before is there
    hold("\n@mark\n");
  }
  ~Link() { release(); }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  hal::Serial& role() { return serial; }
  void deliver(const Bytes& bytes) {
    release();
    far_end().send(bytes);
    // The order has two digits for each byte: 11 us at 921 600 baud.
    constexpr hal::Time kOfAByte{3 * 11};
    sleep_for(hal::milliseconds(10) + static_cast<std::int64_t>(bytes.size()) * kOfAByte);
    hold("\n@wait\n");
  }
  Bytes sent() {
    release();
    const Bytes bytes = far_end().report();
    hold("\n@mark\n");
    return bytes;
  }

 private:
  void hold(const char* order) {
    masked_ = mask_bus();
    static_cast<void>(serial.write(reinterpret_cast<const std::uint8_t*>(order), std::strlen(order),
                                   hal::Serial::kUrgent));
  }
  void release() { unmask_bus(masked_); }

  OpenedSerial serial;
  std::uint32_t masked_{};
};

}  // namespace

BoardUnderTest& board_under_test() {
  return *under_test.get();
}

void run_contracts(const BoardUnderTest& board) {
  under_test.make(board);
  asm volatile("cpsie i" ::: "memory");
  static_cast<void>(board.roles.serial.open(921'600, 0));
  char program[] = "contract";
  std::string option = "--gtest_" + far_end().begin();
  char* arguments[] = {program, option.data(), nullptr};
  int count = 2;
  ::testing::InitGoogleTest(&count, arguments);
  const int status = RUN_ALL_TESTS();
  far_end().end("end " + std::to_string(status));
}

}  // namespace rosflight::boards::stm32h7

namespace rosflight::hal::contract {

using boards::stm32h7::Backup;
using boards::stm32h7::Lamps;
using boards::stm32h7::Link;
using boards::stm32h7::Medium;
using boards::stm32h7::Microseconds;
using boards::stm32h7::Processor;
using boards::stm32h7::TimerPins;

INSTANTIATE_TYPED_TEST_SUITE_P(Board, ClockContract, Microseconds);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, OutputsContract, TimerPins);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, BackupMemoryContract, Backup);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, LedsContract, Lamps);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, SerialContract, Link);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, StorageContract, Medium);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, SystemContract, Processor);

}  // namespace rosflight::hal::contract
