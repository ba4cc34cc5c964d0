// SPDX-License-Identifier: BSD-3-Clause
// The contract suites on the smallest implementations: shows that they can be met.
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
#include "firmware/hal/test/fake_roles.hpp"

namespace rosflight::hal::contract {
namespace {

struct FakeClock {
  Clock& role() { return clock; }
  void pass(Time time) { clock.pass(time); }
  fake::ManualClock clock;
};

template <class S>
struct FakeSource {
  using Sample = S;
  Source<S>& role() { return queue; }
  void deliver(const S& sample) { queue.deliver(sample); }
  fake::Queue<S> queue;
};

struct FakeReceiver {
  using Sample = RcFrame;
  Receiver& role() { return receiver; }
  void deliver(const RcFrame& frame) { receiver.deliver(frame); }
  fake::SbusReceiver receiver;
};

struct FakeBattery {
  using Sample = BatterySample;
  Battery& role() { return battery; }
  void deliver(const BatterySample& pins) { battery.deliver(pins); }
  fake::DividerBattery battery;
};

struct FakeSerial {
  Serial& role() { return loop; }
  void deliver(const std::vector<std::uint8_t>& bytes) { loop.deliver(bytes); }
  std::vector<std::uint8_t> sent() { return loop.sent(); }
  fake::Loop loop;
};

struct FakeOutputs {
  Outputs& role() { return outputs; }
  std::size_t channels() const { return fake::PwmOutputs::kPins; }
  float resolution() const { return 0.0011f; }  // whole microseconds of 1000
  float driven(std::size_t k) { return outputs.driven(k); }
  fake::PwmOutputs outputs;
};

struct FakeStorage {
  Storage& role() { return chip; }
  void power_cycle() {}
  fake::Chip chip;
};

struct FakeBackup {
  BackupMemory& role() { return registers; }
  void reset() {}
  fake::Registers registers;
};

struct FakeLeds {
  Leds& role() { return lamps; }
  bool lit(Led led) { return lamps.lit(led); }
  fake::Lamps lamps;
};

struct FakeSystem {
  System& role() { return processor; }
  bool sensors_started() const { return processor.sensors_started; }
  bool reset_asked() const { return processor.reset_asked; }
  bool bootloader_asked() const { return processor.bootloader_asked; }
  fake::Processor processor;
};

using Sources = ::testing::Types<FakeSource<ImuSample>, FakeSource<MagSample>,
                                 FakeSource<BaroSample>, FakeSource<DiffPressureSample>,
                                 FakeSource<RangeSample>, FakeSource<GnssSample>, FakeReceiver>;

INSTANTIATE_TYPED_TEST_SUITE_P(Fake, ClockContract, FakeClock);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, SourceContract, Sources);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, ReceiverContract, FakeReceiver);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, BatteryContract, FakeBattery);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, SerialContract, FakeSerial);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, OutputsContract, FakeOutputs);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, StorageContract, FakeStorage);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, BackupMemoryContract, FakeBackup);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, LedsContract, FakeLeds);
INSTANTIATE_TYPED_TEST_SUITE_P(Fake, SystemContract, FakeSystem);

}  // namespace
}  // namespace rosflight::hal::contract
