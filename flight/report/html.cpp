// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/html.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "messages/utf8.hpp"

namespace rosflight::report {

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : messages::clean_utf8(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string number(double value, int decimals) {
  constexpr double kFixedLimit = 1e9;
  if (!std::isfinite(value)) return "–";
  std::array<char, 64> text{};
  char* const begin = text.data();
  char* const end = begin + text.size();
  const auto result = std::abs(value) < kFixedLimit
                          ? std::to_chars(begin, end, value, std::chars_format::fixed, decimals)
                          : std::to_chars(begin, end, value, std::chars_format::scientific, 2);
  std::string out(begin, result.ptr);
  const bool zero = out.find_first_not_of("-0.") == std::string::npos;
  if (zero && out.front() == '-') out.erase(0, 1);
  return out;
}

void append_coordinate(std::string& out, double value) {
  constexpr double kLimit = 1e6;
  const double inside = value > -kLimit ? std::min(value, kLimit) : -kLimit;  // NaN goes low.
  std::int64_t hundredths = std::llround(inside * 100.0);
  if (hundredths < 0) {
    out += '-';
    hundredths = -hundredths;
  }
  std::array<char, 24> text{};
  const auto whole = std::to_chars(text.data(), text.data() + text.size(), hundredths / 100);
  out.append(text.data(), whole.ptr);
  const auto rest = static_cast<int>(hundredths % 100);
  if (rest == 0) return;
  out += '.';
  out += static_cast<char>('0' + rest / 10);
  if (rest % 10 != 0) out += static_cast<char>('0' + rest % 10);
}

}  // namespace rosflight::report
