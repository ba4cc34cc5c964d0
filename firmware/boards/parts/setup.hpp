// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/bus.hpp"
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/text.hpp"

namespace rosflight::boards::parts {

/// How a part with 8-bit registers is read: SPI parts set the top bit of the address and may insert
/// a byte before the data; I2C parts do neither. Writing is address, value for all.
struct RegisterDialect {
  std::uint8_t read_flag{0x80};
  std::uint8_t dummy_bytes{0};  ///< 0 or 1.
};

enum class SetupKind : std::uint8_t {
  kWrite,      ///< Reset or command: written, not read back. Left out by a warm start.
  kVoid,       ///< A read whose result means nothing.
  kIdentity,   ///< Must read `value` under `mask`, else the part is wrong or mute.
  kConfigure,  ///< Written and read back up to kAttempts times; a warm start reads first, and writes
               ///< only if it is wrong.
  kAwait       ///< Read at each step until `value` under `mask`, for wait_us at most.
};

/// One row of a start-up sequence.
struct SetupStep {
  SetupKind kind;
  std::uint8_t reg;
  std::uint8_t value{0};
  std::uint8_t mask{0xFF};   ///< Bits that are compared.
  std::uint32_t wait_us{0};  ///< After the write, before anything else.
  bool even_if_warm{false};  ///< kWrite: executed at a warm start as well.
};

/// Runs the start-up sequence of a part, one transfer after the other, without waiting in between
/// where the table wants no wait: a warm start of ten registers takes ten short transfers.
class Setup final : public TransferOwner {
 public:
  static constexpr int kAttempts = 8;

  enum class Status : std::uint8_t { kIdle, kBusy, kDone, kFailed };

  /// All must outlive this.
  template <std::size_t N>
  Setup(Port& port, RegisterDialect dialect, const std::array<SetupStep, N>& steps)
      : port_{port}, dialect_{dialect}, steps_{steps.data()}, count_{N} {}

  /// Bus context. Ignored while a transfer of this is on the bus; then call it again.
  /// @returns false in that case.
  bool begin(Start how, Time now);
  /// Bus context, once per tick.
  void step(Time now);
  Status status() const { return status_; }
  /// Appends what was wrong, such as "identity 0x1F, expected 0x1E".
  void describe(Text& text) const;
  /// Registers that a warm start found wrong and wrote.
  std::uint8_t rewritten() const { return rewritten_; }

  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;

 private:
  void proceed(Time now);
  bool start_read();
  bool start_write();
  void next(Time now, std::uint32_t wait_us);
  void compare(Time now);
  void mismatch(Time now);
  void fail(TransferResult result);

  Port& port_;
  RegisterDialect dialect_;
  const SetupStep* steps_;
  std::size_t count_;
  std::size_t at_{0};
  Time not_before_{};
  Time limit_{};
  std::array<std::uint8_t, 2> out_{};
  std::uint8_t found_{0};
  Transfer transfer_{};
  TransferResult result_{TransferResult::kDone};
  Status status_{Status::kIdle};
  Start how_{Start::kCold};
  std::uint8_t rewritten_{0};
  int attempts_{0};
  bool wrote_{false};    ///< The current row has been written.
  bool reading_{false};  ///< The transfer on the bus is a read.
  bool on_bus_{false};
};

}  // namespace rosflight::boards::parts
