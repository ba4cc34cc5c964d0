// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <atomic>

#include "firmware/boards/parts/bus.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// FRAM of 256 kbit on SPI (Cypress FM25V02A and its kind) as hal::Storage: bytes are stored as they arrive,
/// without erasing or waiting, so a cut of power leaves what was written before and nothing else changed.
/// Goes in transfers of at most 64 bytes, each of which the caller waits for (150 us at 4 MHz);
/// other parts get the bus in between. Small reads, one behind the other, share a transfer; no byte
/// of a transfer is given twice, so reading again asks the part again. Source: data sheet FM25V02A,
/// commands.
class Fram final : public hal::Storage, private TransferOwner {
 public:
  static constexpr SpiWish kSpi{3, 40'000'000, false};
  static constexpr std::size_t kBytes = 32'768;
  /// Longest wait for one transfer, with what others have on the bus.
  static constexpr Time kLimit = hal::milliseconds(20);

  /// The bus must run without the caller (interrupts).
  Fram(Port& port, const hal::Clock& clock) : port_{port}, clock_{clock} {}

  /// Main loop, once at the start: reads the identity. Until it was right, the size is 0.
  bool identify();
  /// Main loop, as the functions below. One line for people.
  const char* message() const { return message_.data(); }

  std::size_t size() const override { return present_ ? kBytes : 0; }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override;
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override;
  bool flush() override { return present_; }

 private:
  static constexpr std::size_t kChunk = 64;
  static constexpr std::size_t kIdentityBytes = 9;

  bool exchange(std::size_t out, std::size_t in);
  bool read_chunk(std::size_t offset, std::uint8_t* data, std::size_t count);
  bool in_range(std::size_t offset, std::size_t count) const;
  std::size_t address(std::uint8_t command, std::size_t offset);
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;

  Port& port_;
  const hal::Clock& clock_;
  bool present_{false};
  std::array<std::uint8_t, kChunk + 3> out_{};
  std::array<std::uint8_t, kChunk> in_{};
  std::size_t ahead_offset_{0};  ///< Address of the first byte in in_ that nobody has read yet,
  std::size_t ahead_index_{0};   ///< its index there,
  std::size_t ahead_count_{0};   ///< and how many they are.
  Transfer transfer_{};
  std::array<char, 64> message_{};
  enum class Wait : std::uint8_t { kNone, kPending, kDone, kFailed };
  std::atomic<Wait> wait_{Wait::kNone};
};

}  // namespace rosflight::boards::parts
