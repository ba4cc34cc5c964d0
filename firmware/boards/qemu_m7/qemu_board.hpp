// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/memories.hpp"
#include "firmware/boards/common/simulated_peripherals.hpp"
#include "firmware/boards/qemu_m7/clocks.hpp"
#include "firmware/boards/qemu_m7/exchange_block.hpp"
#include "firmware/boards/qemu_m7/registers.hpp"

namespace rosflight::boards::m7 {

/// The processor: watchdog, and a reset that happens when the main loop has control again.
class QemuSystem final : public hal::System {
 public:
  explicit QemuSystem(std::uint32_t watchdog_ms) : watchdog_ms_{watchdog_ms} {}
  void start_sensors() override { sensors_started_ = true; }
  std::uint16_t sensor_errors() const override { return 0; }
  const char* sensor_message(std::size_t /*index*/, bool& /*ok*/) const override { return nullptr; }
  void reset(bool to_bootloader) override {
    reset_requested_ = true;
    to_bootloader_ = to_bootloader;
  }
  void feed_watchdog() override { Watchdog::feed(watchdog_ms_); }
  /// The emulator's clock does not measure the time a pass would take: bench/m7 counts
  /// instructions.
  hal::Time busy_time() const override { return {}; }
  bool shares_processor() const override { return true; }

  bool sensors_started() const { return sensors_started_; }
  bool reset_requested() const { return reset_requested_; }
  bool to_bootloader() const { return to_bootloader_; }

 private:
  std::uint32_t watchdog_ms_;
  bool sensors_started_{false};
  bool reset_requested_{false};
  bool to_bootloader_{false};
};

/// The two lamps of the MPS2 board.
class FpgaLeds final : public hal::Leds {
 public:
  void set(hal::Led led, bool on) override {
    const std::uint32_t bit = 1u << static_cast<unsigned>(led);
    const std::uint32_t now = reg(kLedRegister);
    reg(kLedRegister) = on ? now | bit : now & ~bit;
  }
  static bool lit(hal::Led led) {
    return (reg(kLedRegister) >> static_cast<unsigned>(led) & 1u) != 0;
  }
};

/// An IMU that can break in the two ways a driver breaks a processor.
class TroubledImu final : public Mailbox<hal::ImuSample> {
 public:
  bool poll(hal::ImuSample& sample) override;
  /// The next poll() makes it, once.
  void expect(Trouble trouble) { trouble_ = trouble; }

 private:
  Trouble trouble_{Trouble::kNone};
};

/// Everything on the board but clock and serial port, which differ by coupling.
struct QemuBoard {
  /// Real time needs a long timeout: the emulator's clock runs on while the host does other
  /// things.
  static constexpr std::uint32_t kWatchdogLockStep_ms = 25;  // 25 million instructions
  static constexpr std::uint32_t kWatchdogRealTime_ms = 2000;

  explicit QemuBoard(Coupling coupling);

  /// Puts what the block carries, all but receiver and link, into the mailboxes. `offset` is added
  /// to every stamp.
  void take_sensors(const ToProcessor& in, hal::Time offset);
  void take_receiver(const ToProcessor& in, hal::Time offset);
  /// Outputs, LEDs, stack.
  void report(FromProcessor& out) const;
  hal::Board roles(hal::Clock& clock, hal::Serial& serial);

  QemuSystem system;
  MappedStorage storage;
  BackupRam backup;
  FpgaLeds leds;
  SimulatedOutputs outputs;
  SimulatedReceiver receiver;
  SimulatedBattery battery;
  TroubledImu imu;
  Mailbox<hal::MagSample> mag;
  Mailbox<hal::BaroSample> baro;
  Mailbox<hal::DiffPressureSample> diff_pressure;
  Mailbox<hal::RangeSample> range;
  Mailbox<hal::GnssSample> gnss;
};

inline ExchangeBlock& exchange_block() {
  return memory_at<ExchangeBlock>(kExternalRam);
}
std::uint8_t* storage_memory();
std::uint8_t* backup_memory();

}  // namespace rosflight::boards::m7
