// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <map>

#include "companion/session.hpp"

namespace rosflight::companion {

/// Reads the flight record of an FCU over a session: requests its entries in windows, and again those that
/// did not arrive. What the entries contain is not looked at (docs/link.md).
///
/// The FCU answers while it is disarmed. Entries that it overwrites meanwhile are passed over.
class RecordReader final : public Listener {
 public:
  using Bytes = std::array<std::uint8_t, 2 * link::kRecordPartBytes>;
  enum class State : std::uint8_t {
    kReading,
    kComplete,
    kNoRecord,  ///< No answer: this FCU has none, is armed, or is too old.
    kStopped    ///< It answered and then no more; entries() has what arrived.
  };

  explicit RecordReader(Session& session) : session_{session} { session_.add(*this); }
  ~RecordReader() override { session_.remove(*this); }
  RecordReader(const RecordReader&) = delete;
  RecordReader& operator=(const RecordReader&) = delete;

  /// After each step of the session: sends what is due.
  void step();
  State state() const { return state_; }
  /// Those received so far, by number.
  const std::map<std::uint32_t, Bytes>& entries() const { return entries_; }
  /// Number of entries that there were when the reading began; 0 before the first answer.
  std::size_t expected() const { return known_ ? newest_ + 1 - oldest_ : 0; }

  void on_received(const link::Message& message, const Stamp& stamp) override;

 private:
  static constexpr std::uint16_t kWindow = 128;
  static constexpr Time kSilence = std::chrono::milliseconds{400};
  static constexpr int kAttempts = 8;

  bool find_missing();
  void request(Time now);

  Session& session_;
  std::map<std::uint32_t, Bytes> entries_;
  State state_{State::kReading};
  Bytes arriving_{};
  std::uint32_t arriving_number_{};  ///< Its first half is there.
  std::uint32_t oldest_{}, newest_{};
  std::uint32_t missing_{};     ///< No entry before it is missing.
  std::uint32_t window_end_{};  ///< The last number that was requested.
  bool known_{false};           ///< oldest_ and newest_ are.
  bool window_done_{false};
  int attempts_{0};  ///< Requests since the last entry.
  Time again_{};     ///< When the next request is due.
};

}  // namespace rosflight::companion
