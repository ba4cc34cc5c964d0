// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/simulated_peripherals.hpp"
#include "firmware/boards/linux/file_storage.hpp"
#include "firmware/boards/linux/linux_clock.hpp"
#include "firmware/boards/linux/linux_serial.hpp"
#include "firmware/boards/linux/linux_system.hpp"

/// A Linux process as a flight control unit: clock, non-volatile memory and serial port of the
/// operating system; sensors, receiver, battery and outputs of a simulated vehicle.
namespace rosflight::boards {

struct LinuxBoard {
  /// @throws LinuxError
  LinuxBoard(const LinkAddress& link, const std::filesystem::path& storage_file)
      : system{clock}, serial{link}, storage{storage_file} {}

  LinuxClock clock;
  LinuxSystem system;
  LinuxSerial serial;
  FileStorage storage;
  SimulatedBackup backup;
  SimulatedLeds leds;
  SimulatedOutputs outputs;
  SimulatedReceiver receiver;
  SimulatedBattery battery;
  Mailbox<hal::ImuSample> imu;
  Mailbox<hal::MagSample> mag;
  Mailbox<hal::BaroSample> baro;
  Mailbox<hal::DiffPressureSample> diff_pressure;
  Mailbox<hal::RangeSample> range;
  Mailbox<hal::GnssSample> gnss;

  /// The board as the firmware sees it.
  hal::Board roles() {
    return {clock,   system, serial, storage, backup,        leds,  outputs, receiver,
            battery, imu,    mag,    baro,    diff_pressure, range, gnss};
  }
};

}  // namespace rosflight::boards
