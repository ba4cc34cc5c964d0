// SPDX-License-Identifier: BSD-3-Clause
// The board made of memory keeps every contract of the HAL.
#include <memory>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/hal/test/contract/backup_memory_contract.hpp"
#include "firmware/hal/test/contract/battery_contract.hpp"
#include "firmware/hal/test/contract/clock_contract.hpp"
#include "firmware/hal/test/contract/leds_contract.hpp"
#include "firmware/hal/test/contract/outputs_contract.hpp"
#include "firmware/hal/test/contract/receiver_contract.hpp"
#include "firmware/hal/test/contract/serial_contract.hpp"
#include "firmware/hal/test/contract/source_contract.hpp"
#include "firmware/hal/test/contract/storage_contract.hpp"
#include "firmware/hal/test/contract/system_contract.hpp"

namespace rosflight::hal::contract {
namespace {

/// One whole board each, seen through the roles that the firmware gets.
struct Fixture {
  boards::SimulatedBoard board;
  boards::MemorySerial serial;
  hal::Board roles{board.roles(serial)};
};

struct SimulatedClock : Fixture {
  Clock& role() { return roles.clock; }
  void pass(Time time) { board.clock.set(board.clock.now() + time); }
};

template <class S>
struct MailboxOf;
template <>
struct MailboxOf<ImuSample> {
  static auto& in(boards::SimulatedBoard& b) { return b.imu; }
  static Source<ImuSample>& role(hal::Board& b) { return b.imu; }
};
template <>
struct MailboxOf<MagSample> {
  static auto& in(boards::SimulatedBoard& b) { return b.mag; }
  static Source<MagSample>& role(hal::Board& b) { return b.mag; }
};
template <>
struct MailboxOf<BaroSample> {
  static auto& in(boards::SimulatedBoard& b) { return b.baro; }
  static Source<BaroSample>& role(hal::Board& b) { return b.baro; }
};
template <>
struct MailboxOf<DiffPressureSample> {
  static auto& in(boards::SimulatedBoard& b) { return b.diff_pressure; }
  static Source<DiffPressureSample>& role(hal::Board& b) { return b.diff_pressure; }
};
template <>
struct MailboxOf<RangeSample> {
  static auto& in(boards::SimulatedBoard& b) { return b.range; }
  static Source<RangeSample>& role(hal::Board& b) { return b.range; }
};
template <>
struct MailboxOf<GnssSample> {
  static auto& in(boards::SimulatedBoard& b) { return b.gnss; }
  static Source<GnssSample>& role(hal::Board& b) { return b.gnss; }
};
template <>
struct MailboxOf<RcFrame> {
  static auto& in(boards::SimulatedBoard& b) { return b.receiver; }
  static Source<RcFrame>& role(hal::Board& b) { return b.receiver; }
};
template <>
struct MailboxOf<BatterySample> {
  static auto& in(boards::SimulatedBoard& b) { return b.battery; }
  static Source<BatterySample>& role(hal::Board& b) { return b.battery; }
};

template <class S>
struct SimulatedSource : Fixture {
  using Sample = S;
  Source<S>& role() { return MailboxOf<S>::role(roles); }
  void deliver(const S& sample) { MailboxOf<S>::in(board).put(sample); }
};

struct SimulatedReceiver : Fixture {
  using Sample = RcFrame;
  Receiver& role() { return roles.receiver; }
  void deliver(const RcFrame& frame) { board.receiver.put(frame); }
};

struct SimulatedBattery : Fixture {
  using Sample = BatterySample;
  Battery& role() { return roles.battery; }
  void deliver(const BatterySample& pins) { board.battery.put(pins); }
};

struct SimulatedSerial : Fixture {
  Serial& role() { return roles.serial; }
  void deliver(const std::vector<std::uint8_t>& bytes) { serial.put(bytes.data(), bytes.size()); }
  std::vector<std::uint8_t> sent() { return serial.take_sent(); }
};

struct SimulatedOutputs : Fixture {
  Outputs& role() { return roles.outputs; }
  std::size_t channels() const { return kOutputs; }
  float resolution() const { return 0.0f; }
  float driven(std::size_t k) { return board.outputs.values()[k]; }
};

/// The medium is the vector of bytes; a power cycle makes a new board with it.
struct SimulatedStorage {
  Storage& role() { return *storage; }
  void power_cycle() {
    const std::vector<std::uint8_t> medium = storage->bytes();
    storage = std::make_unique<boards::SimulatedStorage>();
    storage->set_bytes(medium);
  }
  std::unique_ptr<boards::SimulatedStorage> storage{std::make_unique<boards::SimulatedStorage>()};
};

struct SimulatedBackup : Fixture {
  BackupMemory& role() { return roles.backup; }
  void reset() {
    board.system.reset(false);
    board.system.acknowledge_reset();
  }
};

struct SimulatedLeds : Fixture {
  Leds& role() { return roles.leds; }
  bool lit(Led led) { return board.leds.on(led); }
};

struct SimulatedSystem : Fixture {
  System& role() { return roles.system; }
  bool sensors_started() const { return board.system.sensors_started(); }
  bool reset_asked() const { return board.system.reset_requested(); }
  bool bootloader_asked() const { return board.system.to_bootloader(); }
};

using Sources = ::testing::Types<SimulatedSource<ImuSample>, SimulatedSource<MagSample>,
                                 SimulatedSource<BaroSample>, SimulatedSource<DiffPressureSample>,
                                 SimulatedSource<RangeSample>, SimulatedSource<GnssSample>,
                                 SimulatedSource<RcFrame>, SimulatedSource<BatterySample>>;

INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, ClockContract, SimulatedClock);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, SourceContract, Sources);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, ReceiverContract, SimulatedReceiver);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, BatteryContract, SimulatedBattery);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, SerialContract, SimulatedSerial);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, OutputsContract, SimulatedOutputs);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, StorageContract, SimulatedStorage);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, BackupMemoryContract, SimulatedBackup);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, LedsContract, SimulatedLeds);
INSTANTIATE_TYPED_TEST_SUITE_P(SimulatedBoard, SystemContract, SimulatedSystem);

// What the board adds for tests: faults.

TEST(SimulatedStorageFault, OnlyTheBytesBeforeTheCutReachTheMedium) {
  boards::SimulatedStorage storage(64);
  const std::vector<std::uint8_t> data(16, 0x11);
  storage.cut_power_after(5);
  EXPECT_FALSE(storage.write(8, data.data(), data.size()));
  EXPECT_FALSE(storage.write(40, data.data(), 1));
  EXPECT_FALSE(storage.flush());
  std::uint8_t byte = 0;
  EXPECT_FALSE(storage.read(0, &byte, 1));
  storage.restore_power();
  for (std::size_t k = 0; k < 64; ++k) {
    ASSERT_TRUE(storage.read(k, &byte, 1));
    EXPECT_EQ(byte, k >= 8 && k < 13 ? 0x11 : 0xFF) << k;
  }
  EXPECT_TRUE(storage.write(40, data.data(), 1));
}

TEST(SimulatedStorageFault, ACutRightAfterTheLastByteLosesNothing) {
  boards::SimulatedStorage storage(64);
  const std::vector<std::uint8_t> data(16, 0x11);
  storage.cut_power_after(16);
  EXPECT_TRUE(storage.write(0, data.data(), data.size()));
  EXPECT_TRUE(storage.flush());
  EXPECT_FALSE(storage.write(16, data.data(), 1));
}

TEST(MemorySerial, CountsDroppedFrames) {
  boards::MemorySerial serial(100);
  const std::vector<std::uint8_t> frame(60, 1);
  EXPECT_TRUE(serial.write(frame.data(), frame.size(), Serial::kOrdinary));
  EXPECT_FALSE(serial.write(frame.data(), frame.size(), Serial::kUrgent));
  EXPECT_EQ(serial.dropped(), 1u);
  EXPECT_EQ(serial.take_sent().size(), 60u);
  EXPECT_EQ(serial.writable(), 100u);
}

}  // namespace
}  // namespace rosflight::hal::contract
