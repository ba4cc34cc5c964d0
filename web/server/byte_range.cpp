// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/byte_range.hpp"

#include <algorithm>
#include <charconv>

namespace rosflight::web::server {
namespace {

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<ByteRange> byte_range(std::string_view header, std::uint64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit)) return std::nullopt;
  header.remove_prefix(kUnit.size());
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::string_view first_text = header.substr(0, dash);
  const std::string_view last_text = header.substr(dash + 1);
  if (first_text.empty()) {
    const std::optional<std::uint64_t> length = number(last_text);
    if (!length || *length == 0 || size == 0) return std::nullopt;
    const std::uint64_t kept = std::min(*length, size);
    return ByteRange{size - kept, std::min(kept, kMaxRange)};
  }
  const std::optional<std::uint64_t> first = number(first_text);
  const std::optional<std::uint64_t> last =
      last_text.empty() ? std::optional<std::uint64_t>(size) : number(last_text);
  if (!first || !last || *first >= size || *last < *first) return std::nullopt;
  const std::uint64_t end = std::min(*last, size - 1) + 1;
  return ByteRange{*first, std::min(end - *first, kMaxRange)};
}

}  // namespace rosflight::web::server
