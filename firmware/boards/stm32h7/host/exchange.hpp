// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "firmware/boards/common/firmware_glance.hpp"
#include "firmware/hal/samples.hpp"

/// What the world and the program of the emulated chip exchange: one block of shared memory, and a
/// byte over a pipe when it is ready. Both are programs of one machine and one build.
namespace rosflight::boards::stm32h7 {

/// Files of the emulator's process.
inline constexpr int kToChipFd = 20;
inline constexpr int kFromChipFd = 21;
inline constexpr int kBlockFd = 22;

enum class ChipOrder : std::uint8_t {
  kPowerOn,  ///< Power comes on at `time_us`; RAM and backup memory are lost.
  kStep,     ///< Takes what the block carries and runs until `until_us`.
};

/// Faults of the hardware that tests inject. Those from kMute to kSpeaksNmea last until kRepaired.
enum class HardwareFault : std::uint8_t {
  kNone,
  kBusError,      ///< The next write to the bus of the IMU is answered with an error.
  kDamagedFlash,  ///< Two words of each sector of parameters cannot be read, as after a cut of power.
  kStuckInterrupt,  ///< The data-ready line's interrupt stays pending: no other code runs.
  kMute,            ///< The part drives no data line and acknowledges nothing.
  kStuckBus,        ///< The data line of the I2C stays low.
  kWrongIdentity,   ///< The identity register of the part reads as that of another part.
  kSpeaksNmea,      ///< The GNSS receiver ignores what it is sent and sends NMEA only.
  kRepaired,
  kLostEdges,  ///< For 30 ms no data-ready edge of the IMU arrives.
  kOverrun,  ///< The next byte is lost: on the SPI of the IMU, the UART of the link or the GNSS receiver.
  kBrownOut,  ///< The part loses its registers.
  kFlippedBit,  ///< One bit of the next answer of a part on SPI, or of a byte of the GNSS receiver, is inverted.
  kTornWord,  ///< The flash word `torn_word` of the first sector of parameters cannot be read; the one before can.
};

/// What the fault is in.
enum class FaultyPart : std::uint8_t { kImu, kBaro, kMag, kPitot, kGnss, kLink };

struct ToChip {
  static constexpr std::size_t kLinkCapacity = 16384;

  std::int64_t time_us{};   ///< Simulation time: the samples and bytes arrive now.
  std::int64_t until_us{};  ///< The chip runs up to here.
  ChipOrder order{ChipOrder::kStep};
  HardwareFault fault{HardwareFault::kNone};
  FaultyPart faulty_part{FaultyPart::kImu};
  std::uint16_t torn_word{};
  std::uint8_t usb_plugged{};       ///< The link goes over USB; otherwise over the UART.
  std::uint8_t receiver_is_crsf{};  ///< Otherwise S.Bus.
  std::uint8_t has_rc{}, has_imu{}, has_mag{}, has_baro{};
  std::uint8_t has_diff_pressure{}, has_range{}, has_gnss{}, has_battery{};
  std::uint32_t link_count{};
  std::uint32_t link_baud{};
  hal::RcFrame rc;
  hal::ImuSample imu;
  hal::MagSample mag;
  hal::BaroSample baro;
  hal::DiffPressureSample diff_pressure;
  hal::RangeSample range;
  hal::GnssSample gnss;
  hal::BatterySample battery;
  double chip_degC{45.0};  ///< Temperature of the processor's junction.
  std::array<std::uint8_t, kLinkCapacity> link{};
};

/// What a timer makes on the pin of an output.
struct PinSignal {
  static constexpr std::size_t kDshotBits = 16;

  double count_s{};              ///< One count of the timer.
  double period_s{};             ///< From pulse to pulse, or of one bit of DShot.
  double high_s{};               ///< Width of the pulses; 0: the pin is still, or makes DShot.
  std::uint32_t dshot_frames{};  ///< Sent since the power came on.
  std::array<std::uint32_t, kDshotBits>
      dshot_high{};  ///< High time of each bit of the last frame [counts].
};

struct FromChip {
  static constexpr std::size_t kLinkCapacity = 65536;
  static constexpr std::size_t kTextCapacity = 512;

  std::int64_t time_us{};  ///< Where the chip stands.
  std::int64_t
      clock_zero_us{};  ///< When the firmware's microsecond counter was 0; -1: not started.
  std::uint64_t instructions{};  ///< Since the program began.
  std::uint64_t busy_us{};       ///< Time not slept.
  std::uint64_t link_received{}, link_sent{}, link_lost{};
  std::uint64_t
      flash_operations{};       ///< Words programmed and sectors erased, since the program began.
  std::uint32_t resets{};       ///< Since the program began.
  std::uint32_t complaints{};   ///< Complaints of models since the program began.
  std::uint32_t torn_words{};   ///< Flash words that a reset or a loss of power has cut.
  std::uint32_t stack_bytes{};  ///< High-water mark since the power came on.
  std::uint32_t link_count{};
  std::uint32_t
      transfer_to_output_us{};  ///< From the end of the IMU's last transfer to the output that followed; the longest of this step.
  std::uint32_t
      edge_to_output_us{};  ///< From a data-ready edge to the output that followed; the longest of this step.
  /// The firmware's stamp of its newest IMU sample less the time of the world that the sample shows.
  double stamp_error_us{};
  hal::OutputValues outputs{};  ///< Pulses on the pins, as 0..1; of a plain level 0 or 1.
  std::array<PinSignal, hal::kOutputs> signals{};  ///< The same as the pins show them.
  std::uint16_t levels{};                          ///< Bit per output: its pin is a plain level.
  std::array<std::uint8_t, 4> leds{};
  std::uint32_t buzzer_Hz{};  ///< Tone on the buzzer's pin now; 0: silent, or the board has none.
  std::uint8_t
      flash_is_busy{};  ///< A word or a sector of the parameters is being written or erased.
  std::uint8_t in_bootloader{};  ///< The processor executes the bootloader in ROM.
  FirmwareGlance firmware;
  std::array<char, kTextCapacity> text{};  ///< The first complaint.
  std::array<std::uint8_t, kLinkCapacity> link{};
};

struct Exchange {
  ToChip to_chip;
  FromChip from_chip;
};
static_assert(std::is_trivially_copyable_v<Exchange>);

}  // namespace rosflight::boards::stm32h7
