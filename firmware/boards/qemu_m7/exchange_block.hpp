// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "firmware/boards/common/firmware_glance.hpp"
#include "firmware/hal/samples.hpp"

/// What the emulated board and the world outside exchange: one block in memory that both see, laid
/// out the same on a little-endian 64-bit host and on the Cortex-M7.
///
/// The board's 16 MiB of external RAM at 0x60000000 are backed by memory of the host. The block
/// lies at its beginning, the non-volatile storage one mebibyte above.
///
/// Lock-step: the world fills ToProcessor and sends one byte over a pipe; the board, which has stood
/// still in a semihosting read, makes its passes, fills FromProcessor and sends one byte back. Real
/// time: no pipes; each side counts `sequence` up after writing and copies what the other wrote
/// until the count was the same before and after.
namespace rosflight::boards::m7 {

inline constexpr std::uint32_t kExternalRam = 0x6000'0000u;
inline constexpr std::size_t kExternalRamSize = 16u << 20u;
inline constexpr std::size_t kStorageOffset = 1u << 20u;
inline constexpr std::size_t kStorageSize = 16384;

/// Bytes on the pipes.
enum class Bell : char {
  kRing = 'r',    ///< To the board: ToProcessor is ready.
  kDone = 'd',    ///< From the board: FromProcessor is ready.
  kBooted = 'b',  ///< From the board: it has started and waits for kStart.
};
/// File descriptors of the emulator's process at which the pipes are; the board opens them by name.
inline constexpr int kToProcessorFd = 20;
inline constexpr int kFromProcessorFd = 21;
inline constexpr char kToProcessorPipe[] = "/proc/self/fd/20";
inline constexpr char kFromProcessorPipe[] = "/proc/self/fd/21";

enum class Coupling : std::uint32_t { kLockStep = 1, kRealTime = 2 };

enum class Order : std::uint32_t {
  kNone = 0,
  kStart = 1,  ///< Build the firmware and start it; the clock shows time_us.
  kStep = 2,   ///< Passes with what the block carries.
};

/// Faults that the board makes itself, in its sensor driver, for tests.
enum class Trouble : std::uint32_t {
  kNone = 0,
  kBusFault = 1,  ///< Reads where nothing is.
  kHang = 2,      ///< Never comes back.
};

/// Transmit classes of the cable: urgent, timely, ordinary.
inline constexpr std::size_t kTransmitClasses = 3;

struct ToProcessor {
  static constexpr std::size_t kLinkCapacity = 4096;

  std::uint32_t sequence{};
  Coupling coupling{Coupling::kLockStep};
  Order order{Order::kNone};
  Trouble trouble{Trouble::kNone};
  std::int64_t
      time_us{};  ///< Lock-step: the board's clock. Real time: clock of the samples' stamps.
  std::array<std::uint32_t, kTransmitClasses> room{};  ///< Free bytes of the cable's queues.
  std::uint32_t link_count{};
  std::uint8_t has_rc{}, has_imu{}, has_mag{}, has_baro{};
  std::uint8_t has_diff_pressure{}, has_range{}, has_gnss{}, has_battery{};
  hal::RcFrame rc;
  hal::ImuSample imu;
  hal::MagSample mag;
  hal::BaroSample baro;
  hal::DiffPressureSample diff_pressure;
  hal::RangeSample range;
  hal::GnssSample gnss;
  hal::BatterySample battery;
  std::array<std::uint8_t, kLinkCapacity> link{};
};

struct FromProcessor {
  static constexpr std::size_t kLinkCapacity = 16384;
  /// Each frame in `link` stands behind these bytes: size (two, little-endian), urgency, and
  /// whether the board counted on room for it.
  static constexpr std::size_t kFrameHeader = 4;

  std::uint32_t sequence{};
  std::uint32_t boots{};            ///< Since the power came on.
  std::uint32_t reset_requested{};  ///< 1: resets itself after this answer.
  std::uint32_t stack_bytes{};      ///< High-water mark since the power came on.
  std::uint32_t ticks{};            ///< Ticks of the 25 MHz counter in the passes of this step.
  std::uint32_t passes{};
  std::uint32_t link_count{};
  std::uint32_t link_overflow{};  ///< Frames lost because `link` was full.
  std::uint32_t uart_received{};  ///< Bytes since start, real time only.
  std::uint32_t uart_sent{};
  std::uint32_t uart_overruns{};
  std::uint32_t uart_frames_dropped{};
  hal::OutputValues outputs{};
  std::array<std::uint8_t, 2> leds{};
  std::array<std::uint8_t, 6> reserved{};
  FirmwareGlance firmware;
  std::array<std::uint8_t, kLinkCapacity> link{};
};

struct ExchangeBlock {
  ToProcessor to_processor;
  FromProcessor from_processor;
};

// Both compilers must agree; these are the sizes.
static_assert(sizeof(hal::RcFrame) == 112 && sizeof(hal::ImuSample) == 40);
static_assert(sizeof(hal::MagSample) == 24 && sizeof(hal::BaroSample) == 16);
static_assert(sizeof(hal::DiffPressureSample) == 16 && sizeof(hal::RangeSample) == 24);
static_assert(sizeof(hal::GnssSample) == 72 && sizeof(hal::BatterySample) == 16);
static_assert(offsetof(ToProcessor, rc) == 48 &&
              sizeof(ToProcessor) == 48 + 320 + ToProcessor::kLinkCapacity);
static_assert(offsetof(FromProcessor, link) == 216);
static_assert(std::is_trivially_copyable_v<ExchangeBlock>);
static_assert(sizeof(ExchangeBlock) <= kStorageOffset);

}  // namespace rosflight::boards::m7
