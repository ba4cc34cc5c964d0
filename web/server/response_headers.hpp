// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string_view>
#include <utility>

namespace rosflight::web::server {

/// Media type of what an address leads to; "" is the page itself.
constexpr std::string_view media_type(std::string_view address) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kTypes{
      {{".html", "text/html; charset=utf-8"},
       {".js", "text/javascript; charset=utf-8"},
       {".css", "text/css; charset=utf-8"},
       {".json", "application/json"},
       {".mcap", "application/octet-stream"}}};
  if (address.empty()) return kTypes.front().second;
  for (const auto& [end, type] : kTypes) {
    if (address.ends_with(end)) return type;
  }
  return "application/octet-stream";
}

/// In every answer: what a browser may do with it. Pages of others may not use it, and ours uses
/// nothing of others; WebAssembly, from an address inside the page, is the decoder of compressed logs.
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kBrowserRules{
    {{"Content-Security-Policy",
      "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self' data:; "
      "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
     {"Cross-Origin-Opener-Policy", "same-origin"},
     {"Cross-Origin-Resource-Policy", "same-origin"},
     {"X-Content-Type-Options", "nosniff"},
     {"Referrer-Policy", "no-referrer"}}};

}  // namespace rosflight::web::server
