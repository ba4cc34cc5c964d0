// SPDX-License-Identifier: BSD-3-Clause
// The emulated board keeps every contract of the HAL; runs on the processor itself.
#include <cstdio>
#include <memory>

#include "firmware/boards/qemu_m7/block_serial.hpp"
#include "firmware/boards/qemu_m7/qemu_board.hpp"
#include "firmware/boards/qemu_m7/startup.hpp"
#include "firmware/boards/qemu_m7/test/crossed_uarts.hpp"
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

using boards::m7::Coupling;
using boards::m7::ExchangeBlock;
using boards::m7::FromProcessor;
using boards::m7::ToProcessor;

/// One whole board each, seen through the roles that the firmware gets.
struct Fixture {
  boards::m7::LatchedClock clock;
  std::unique_ptr<ExchangeBlock> block{std::make_unique<ExchangeBlock>()};
  boards::m7::BlockSerial serial{*block};
  boards::m7::QemuBoard board{Coupling::kLockStep};
  hal::Board roles{board.roles(clock, serial)};

  /// Samples come as the world sends them.
  void deliver() {
    board.take_receiver(block->to_processor, Time{0});
    board.take_sensors(block->to_processor, Time{0});
    block->to_processor = ToProcessor{};
  }
};

struct Latched {
  boards::m7::LatchedClock clock;
  Clock& role() { return clock; }
  void pass(Time time) { clock.set(clock.now() + time); }
};

struct Hardware {
  boards::m7::HardwareClock clock;
  Clock& role() { return clock; }
  void pass(Time time) { boards::m7::spend(time); }
};

template <class S>
struct Field;
template <>
struct Field<ImuSample> {
  static auto& of(ToProcessor& b) { return b.has_imu = 1, b.imu; }
  static Source<ImuSample>& role(hal::Board& b) { return b.imu; }
};
template <>
struct Field<MagSample> {
  static auto& of(ToProcessor& b) { return b.has_mag = 1, b.mag; }
  static Source<MagSample>& role(hal::Board& b) { return b.mag; }
};
template <>
struct Field<BaroSample> {
  static auto& of(ToProcessor& b) { return b.has_baro = 1, b.baro; }
  static Source<BaroSample>& role(hal::Board& b) { return b.baro; }
};
template <>
struct Field<DiffPressureSample> {
  static auto& of(ToProcessor& b) { return b.has_diff_pressure = 1, b.diff_pressure; }
  static Source<DiffPressureSample>& role(hal::Board& b) { return b.diff_pressure; }
};
template <>
struct Field<RangeSample> {
  static auto& of(ToProcessor& b) { return b.has_range = 1, b.range; }
  static Source<RangeSample>& role(hal::Board& b) { return b.range; }
};
template <>
struct Field<GnssSample> {
  static auto& of(ToProcessor& b) { return b.has_gnss = 1, b.gnss; }
  static Source<GnssSample>& role(hal::Board& b) { return b.gnss; }
};
template <>
struct Field<RcFrame> {
  static auto& of(ToProcessor& b) { return b.has_rc = 1, b.rc; }
  static Source<RcFrame>& role(hal::Board& b) { return b.receiver; }
};
template <>
struct Field<BatterySample> {
  static auto& of(ToProcessor& b) { return b.has_battery = 1, b.battery; }
  static Source<BatterySample>& role(hal::Board& b) { return b.battery; }
};

template <class S>
struct BlockSource : Fixture {
  using Sample = S;
  Source<S>& role() { return Field<S>::role(roles); }
  void deliver(const S& sample) {
    Field<S>::of(block->to_processor) = sample;
    Fixture::deliver();
  }
};

struct BlockReceiver : BlockSource<RcFrame> {
  Receiver& role() { return roles.receiver; }
};

struct BlockBattery : BlockSource<BatterySample> {
  Battery& role() { return roles.battery; }
};

/// Lock-step: a block per exchange, the cable outside with room for one transmit queue.
struct ThroughBlock : Fixture {
  static constexpr std::uint32_t kRoom = 4096;
  ThroughBlock() { exchange(); }
  Serial& role() { return roles.serial; }
  void exchange() {
    block->to_processor.room = {kRoom, kRoom, kRoom};
    serial.begin();
  }
  void deliver(const std::vector<std::uint8_t>& bytes) {
    std::copy(bytes.begin(), bytes.end(), block->to_processor.link.begin());
    block->to_processor.link_count = static_cast<std::uint32_t>(bytes.size());
    const FromProcessor before = block->from_processor;
    exchange();
    block->from_processor = before;  // what was written is not lost by it
    block->to_processor.link_count = 0;
  }
  std::vector<std::uint8_t> sent() {
    std::vector<std::uint8_t> bytes;
    const auto& out = block->from_processor;
    for (std::size_t at = 0; at < out.link_count;) {
      const std::size_t size = out.link[at] | static_cast<std::size_t>(out.link[at + 1]) << 8u;
      const bool fits = out.link[at + 3] != 0;
      at += FromProcessor::kFrameHeader;
      if (fits) bytes.insert(bytes.end(), &out.link[at], &out.link[at] + size);
      at += size;
    }
    exchange();
    return bytes;
  }
};

/// Real time: two UARTs of the board, wired to each other.
struct OnWire {
  boards::m7::CrossedUarts uarts;
  Serial& role() { return uarts.near; }
  void deliver(const std::vector<std::uint8_t>& bytes) { uarts.deliver(bytes); }
  std::vector<std::uint8_t> sent() { return uarts.sent(); }
};

struct Pins : Fixture {
  Outputs& role() { return roles.outputs; }
  std::size_t channels() const { return kOutputs; }
  float resolution() const { return 0.0f; }
  float driven(std::size_t k) {
    board.report(block->from_processor);
    return block->from_processor.outputs[k];
  }
};

struct Medium {
  Storage& role() { return *storage; }
  void power_cycle() { storage = make(); }
  static std::unique_ptr<boards::MappedStorage> make() {
    return std::make_unique<boards::MappedStorage>(boards::m7::storage_memory(),
                                                   boards::m7::kStorageSize);
  }
  std::unique_ptr<boards::MappedStorage> storage{make()};
};

struct Backup {
  Backup() { memory->clear(); }
  BackupMemory& role() { return *memory; }
  void reset() { memory = make(); }
  static std::unique_ptr<boards::BackupRam> make() {
    return std::make_unique<boards::BackupRam>(boards::m7::backup_memory());
  }
  std::unique_ptr<boards::BackupRam> memory{make()};
};

struct Lamps : Fixture {
  Leds& role() { return roles.leds; }
  bool lit(Led led) {
    board.report(block->from_processor);
    return block->from_processor.leds[static_cast<std::size_t>(led)] != 0;
  }
};

struct Processor : Fixture {
  System& role() { return roles.system; }
  bool sensors_started() const { return board.system.sensors_started(); }
  bool reset_asked() const { return board.system.reset_requested(); }
  bool bootloader_asked() const { return board.system.to_bootloader(); }
};

using Sources =
    ::testing::Types<BlockSource<ImuSample>, BlockSource<MagSample>, BlockSource<BaroSample>,
                     BlockSource<DiffPressureSample>, BlockSource<RangeSample>,
                     BlockSource<GnssSample>, BlockSource<RcFrame>, BlockSource<BatterySample>>;
using Clocks = ::testing::Types<Latched, Hardware>;
using Serials = ::testing::Types<ThroughBlock, OnWire>;

INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, ClockContract, Clocks);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, SourceContract, Sources);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, ReceiverContract, BlockReceiver);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, BatteryContract, BlockBattery);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, SerialContract, Serials);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, OutputsContract, Pins);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, StorageContract, Medium);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, BackupMemoryContract, Backup);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, LedsContract, Lamps);
INSTANTIATE_TYPED_TEST_SUITE_P(QemuM7, SystemContract, Processor);

}  // namespace
}  // namespace rosflight::hal::contract
