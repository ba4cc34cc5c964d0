// SPDX-License-Identifier: BSD-3-Clause
// The Linux board keeps every contract of the HAL.
#include <memory>
#include <thread>

#include "firmware/boards/linux/linux_board.hpp"
#include "firmware/boards/linux/test/far_end.hpp"
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

using base::LinkAddress;
using boards::LinuxBoard;

/// One whole board each, seen through the roles that the firmware gets.
struct Fixture {
  boards::TemporaryFolder folder;
  LinuxBoard board{base::parse_board_link("tcp:0"), folder / "memory"};
  hal::Board roles{board.roles()};
};

struct LinuxClock : Fixture {
  Clock& role() { return roles.clock; }
  void pass(Time time) { std::this_thread::sleep_for(time); }
};

template <class S, boards::Mailbox<S> LinuxBoard::*kBox>
struct LinuxSource : Fixture {
  using Sample = S;
  Source<S>& role() { return board.*kBox; }
  void deliver(const S& sample) { (board.*kBox).put(sample); }
};

struct LinuxReceiver : Fixture {
  using Sample = RcFrame;
  Receiver& role() { return roles.receiver; }
  void deliver(const RcFrame& frame) { board.receiver.put(frame); }
};

struct LinuxBattery : Fixture {
  using Sample = BatterySample;
  Battery& role() { return roles.battery; }
  void deliver(const BatterySample& pins) { board.battery.put(pins); }
};

template <LinkAddress::Kind kKind>
struct LinuxSerial {
  boards::Pair pair = boards::Pair::of(kKind);
  const std::size_t room = pair.near->writable();
  Serial& role() { return *pair.near; }
  void deliver(const std::vector<std::uint8_t>& bytes) { pair.deliver(bytes); }
  std::vector<std::uint8_t> sent() { return pair.sent(room - pair.near->writable()); }
};

struct LinuxOutputs : Fixture {
  Outputs& role() { return roles.outputs; }
  std::size_t channels() const { return kOutputs; }
  float resolution() const { return 0.0f; }
  float driven(std::size_t k) { return board.outputs.values()[k]; }
};

struct LinuxStorage {
  boards::TemporaryFolder folder;
  std::unique_ptr<boards::FileStorage> storage{
      std::make_unique<boards::FileStorage>(folder / "memory")};
  Storage& role() { return *storage; }
  void power_cycle() {
    storage.reset();
    storage = std::make_unique<boards::FileStorage>(folder / "memory");
  }
};

struct LinuxBackup : Fixture {
  BackupMemory& role() { return roles.backup; }
  void reset() {
    board.system.reset(false);
    board.clock.boot();
    board.system.restarted();
  }
};

struct LinuxLeds : Fixture {
  Leds& role() { return roles.leds; }
  bool lit(Led led) { return board.leds.on(led); }
};

struct LinuxSystem : Fixture {
  System& role() { return roles.system; }
  bool sensors_started() const { return board.system.sensors_started(); }
  bool reset_asked() const { return board.system.reset_requested(); }
  bool bootloader_asked() const { return board.system.to_bootloader(); }
};

using Sources =
    ::testing::Types<LinuxSource<ImuSample, &LinuxBoard::imu>,
                     LinuxSource<MagSample, &LinuxBoard::mag>,
                     LinuxSource<BaroSample, &LinuxBoard::baro>,
                     LinuxSource<DiffPressureSample, &LinuxBoard::diff_pressure>,
                     LinuxSource<RangeSample, &LinuxBoard::range>,
                     LinuxSource<GnssSample, &LinuxBoard::gnss>, LinuxReceiver, LinuxBattery>;
using Serials =
    ::testing::Types<LinuxSerial<LinkAddress::Kind::kPty>, LinuxSerial<LinkAddress::Kind::kUdp>,
                     LinuxSerial<LinkAddress::Kind::kTcpServer>>;

INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, ClockContract, LinuxClock);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, SourceContract, Sources);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, ReceiverContract, LinuxReceiver);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, BatteryContract, LinuxBattery);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, SerialContract, Serials);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, OutputsContract, LinuxOutputs);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, StorageContract, LinuxStorage);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, BackupMemoryContract, LinuxBackup);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, LedsContract, LinuxLeds);
INSTANTIATE_TYPED_TEST_SUITE_P(LinuxBoard, SystemContract, LinuxSystem);

}  // namespace
}  // namespace rosflight::hal::contract
