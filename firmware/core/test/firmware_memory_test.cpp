// SPDX-License-Identifier: BSD-3-Clause
// Memory that is never asked for.
#include <memory>

#include "firmware/core/test/firmware_rig.hpp"
#include "test_support/allocations.hpp"

namespace rosflight::core {
namespace {

/// A serial port in fixed memory, so that what is counted is the firmware's own.
class FixedSerial final : public hal::Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* /*data*/, std::size_t size, std::uint8_t /*qos*/) override {
    sent += size;
    return true;
  }
  std::size_t writable() const override { return 4096; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t n = std::min(capacity, waiting - taken);
    std::memcpy(data, &bytes[taken], n);
    taken += n;
    return n;
  }
  void put(const link::Frame& frame) {
    if (taken == waiting) taken = waiting = 0;
    std::memcpy(&bytes[waiting], frame.bytes.data(), frame.size);
    waiting += frame.size;
  }
  std::array<std::uint8_t, 65536> bytes{};
  std::size_t waiting{0}, taken{0}, sent{0};
};

TEST(FirmwareMemory, NothingIsAllocatedWhileStartingOrRunning) {
  auto rig = std::make_unique<FirmwareRig>();
  rig->store_quadrotor();
  boards::SimulatedBoard& board = rig->board;
  FixedSerial serial;
  link::MavlinkCodec fcu{{1, 250}}, companion{{1, 50}};
  std::size_t before = test_support::allocations();
  Firmware firmware(board.roles(serial), fcu);
  firmware.start();
  EXPECT_EQ(test_support::allocations(), before) << "start()";

  hal::RcFrame rc = rig->rc;
  rc.channels[FirmwareRig::kYaw] = 1.0f;
  std::array<float, 10> u{};
  u[2] = 0.5f;
  const std::array<link::Message, 9> messages{
      link::Heartbeat{},
      link::TimeSync{0, 5},
      link::ParamRequestList{},
      link::ParamRequestRead{1, 7, {}},
      link::ParamSet{1, param_name("PID_ROLL_ANG_P"), {bits_of(0.2f)}, 9},
      link::ParamSet{1, param_name("NO_SUCH_NAME"), {0}, 9},
      link::OffboardControl{2, 0, u},
      link::AuxCommand{},
      link::ExternalAttitude{}};
  bool flew = false;
  before = test_support::allocations();
  for (int k = 1; k <= 4000; ++k) {
    const Time now = hal::microseconds(std::int64_t{2500} * k);
    board.clock.set(now);
    board.imu.put(rig->imu_at(now));
    board.baro.put({now, 100'000.0f, 300.0f});
    board.mag.put({now, {1e-5f, 0.0f, 4e-5f}, 300.0f});
    board.battery.put({now, 16.0f, 3.0f});
    board.gnss.put({});
    rc.failsafe = k > 1000 && k < 1200;
    if (k % 8 == 0) board.receiver.put(rc);
    for (const link::Message& m : messages) {
      link::Frame frame;
      if (k % 4 == 0 && companion.encode(m, frame)) serial.put(frame);
    }
    for (std::uint8_t c = 0; c < 12; ++c) {
      link::Frame frame;
      const bool reboot = c == 8 || c == 9;
      if (k > 2000 && k % 100 == 0 && !reboot && companion.encode(link::CommandRequest{c}, frame)) {
        serial.put(frame);
      }
    }
    if (k == 600) rc.channels[FirmwareRig::kYaw] = 0.5f;
    if (k == 2500) rc.channels[FirmwareRig::kYaw] = 0.0f;  // disarms: commands are carried out
    firmware.run();
    flew = flew || firmware.state().armed();
  }
  EXPECT_EQ(test_support::allocations(), before) << "4000 passes";
  EXPECT_TRUE(flew);
  EXPECT_FALSE(firmware.state().armed());
  EXPECT_GT(serial.sent, 100'000u);
}

}  // namespace
}  // namespace rosflight::core
