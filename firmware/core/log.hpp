// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/hal/time.hpp"
#include "link/messages.hpp"

namespace rosflight::core {

using hal::Time;
using link::Severity;

/// Builds one line of at most 49 characters without printf, heap or locale. Longer text is cut.
class Text {
 public:
  Text() = default;
  Text(const char* text) { add(text); }  // NOLINT(google-explicit-constructor): literals are texts
  /// Appends text, or a number in decimal digits.
  Text& add(const char* text);
  Text& add(std::int32_t value);
  /// Appends eight hexadecimal digits.
  Text& add_hex(std::uint32_t value);
  /// With the given number of decimals (0..6); NaN and huge values as words.
  Text& add(float value, int decimals);
  /// A name that may lack its NUL.
  Text& add(const link::ParamName& name);
  Text& add(const Text& text) { return add(text.chars_.data()); }

  const std::array<char, link::kTextLength>& chars() const { return chars_; }

 private:
  void put(char c);
  Text& add(const char* text, std::size_t size);
  std::array<char, link::kTextLength> chars_{};  ///< Always NUL-padded.
  std::size_t length_{0};
};

/// Texts for the ground: a ring of the newest 25 until the link can send them. Every text of the
/// firmware passes through it, in order. 1.4 kB.
class Log {
 public:
  static constexpr std::size_t kCapacity = 25;

  /// Adds a text of that severity; with a full ring the oldest is overwritten and counted.
  void info(const Text& text) { push(Severity::kInfo, text); }
  /// As info().
  void warning(const Text& text) { push(Severity::kWarning, text); }
  /// As info().
  void error(const Text& text) { push(Severity::kError, text); }
  /// As info().
  void critical(const Text& text) { push(Severity::kCritical, text); }
  /// As info(), with the severity as an argument.
  void push(Severity severity, const Text& text);

  bool empty() const { return count_ == 0; }
  /// Removes and returns the oldest text; call only if not empty().
  link::StatusText pop();
  /// Texts that were overwritten before they were sent.
  std::uint32_t lost() const { return lost_; }

 private:
  std::array<link::StatusText, kCapacity> ring_{};
  std::uint8_t first_{0};
  std::uint8_t count_{0};
  std::uint32_t lost_{0};
};

/// Permits something at most once per period: for texts that a control pass would repeat 400 times
/// a second.
class RateLimit {
 public:
  /// @param period  shortest time between two permissions.
  constexpr explicit RateLimit(Time period) : period_{period} {}
  /// @returns true if the last permission is at least one period ago, and records this one.
  bool allow(Time now) {
    if (used_ && now - last_ < period_) return false;
    used_ = true;
    last_ = now;
    return true;
  }

 private:
  Time period_;
  Time last_{};
  bool used_{false};
};

}  // namespace rosflight::core
