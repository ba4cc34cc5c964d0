// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/qemu_m7/qemu_board.hpp"

#include "firmware/boards/qemu_m7/startup.hpp"

extern "C" std::uint8_t board_backup[];

namespace rosflight::boards::m7 {

std::uint8_t* storage_memory() {
  return &memory_at<std::uint8_t>(kExternalRam + kStorageOffset);
}

std::uint8_t* backup_memory() {
  return board_backup;
}

bool TroubledImu::poll(hal::ImuSample& sample) {
  if (trouble_ == Trouble::kBusFault) {
    constexpr std::uintptr_t kNothingThere = 0xB000'0000u;
    const std::uint32_t nothing = reg(kNothingThere);
    static_cast<void>(nothing);
  }
  while (trouble_ == Trouble::kHang) asm volatile("" ::: "memory");
  return Mailbox::poll(sample);
}

QemuBoard::QemuBoard(Coupling coupling)
    : system{coupling == Coupling::kLockStep ? kWatchdogLockStep_ms : kWatchdogRealTime_ms},
      storage{storage_memory(), kStorageSize},
      backup{backup_memory()} {
  leds.set(hal::Led::kOverride, false);
  leds.set(hal::Led::kStatus, false);
}

void QemuBoard::take_receiver(const ToProcessor& in, hal::Time offset) {
  if (in.has_rc == 0) return;
  hal::RcFrame frame = in.rc;
  frame.stamp += offset;
  receiver.put(frame);
}

void QemuBoard::take_sensors(const ToProcessor& in, hal::Time offset) {
  const auto put = [offset](auto& mailbox, std::uint8_t has, auto sample) {
    sample.stamp += offset;
    if (has != 0) mailbox.put(sample);
  };
  put(imu, in.has_imu, in.imu);
  put(mag, in.has_mag, in.mag);
  put(baro, in.has_baro, in.baro);
  put(diff_pressure, in.has_diff_pressure, in.diff_pressure);
  put(range, in.has_range, in.range);
  put(gnss, in.has_gnss, in.gnss);
  put(battery, in.has_battery, in.battery);
}

void QemuBoard::report(FromProcessor& out) const {
  out.outputs = outputs.values();
  out.leds = {static_cast<std::uint8_t>(FpgaLeds::lit(hal::Led::kOverride)),
              static_cast<std::uint8_t>(FpgaLeds::lit(hal::Led::kStatus))};
  out.stack_bytes = stack_high_water();
  out.boots = boot_count();
  out.reset_requested = system.reset_requested() ? 1 : 0;
}

hal::Board QemuBoard::roles(hal::Clock& clock, hal::Serial& serial) {
  return {clock,   system, serial, storage, backup,        leds,  outputs, receiver,
          battery, imu,    mag,    baro,    diff_pressure, range, gnss};
}

}  // namespace rosflight::boards::m7
