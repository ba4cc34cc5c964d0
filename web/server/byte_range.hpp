// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace rosflight::web::server {

/// Part of a file.
struct ByteRange {
  std::uint64_t start{};
  std::uint64_t length{};  ///< > 0.
};

/// The part of a file of `size` bytes that the value of an HTTP header Range asks for (RFC 9110,
/// section 14): "bytes=FIRST-LAST", "bytes=FIRST-" or "bytes=-LENGTH". Shortened to the end of the
/// file and to kMaxRange; a client asks again for the rest.
/// @returns nothing for several ranges, other units, no digits, or a start behind the end.
std::optional<ByteRange> byte_range(std::string_view header, std::uint64_t size);

inline constexpr std::uint64_t kMaxRange = std::uint64_t{16} << 20U;

}  // namespace rosflight::web::server
