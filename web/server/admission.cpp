// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/admission.hpp"

#include <algorithm>
#include <cstddef>
#include <random>
#include <utility>

namespace rosflight::web::server {
namespace {

constexpr std::string_view kScheme = "http://";

/// "HOST:PORT" as a browser writes it, which leaves out the port of the scheme.
std::string name_of(const std::string& address, std::uint16_t port) {
  constexpr std::uint16_t kHttp = 80;
  const bool v6 = address.find(':') != std::string::npos;
  return (v6 ? "[" + address + "]" : address) + (port == kHttp ? "" : ":" + std::to_string(port));
}

/// Takes the same time wherever the first difference is.
bool equal(std::string_view a, std::string_view b) {
  int different = a.size() == b.size() ? 0 : 1;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    different |= static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(b[k]);
  return different == 0;
}

}  // namespace

std::string random_token() {
  constexpr int kWords = 4;
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string token;
  for (int k = 0; k < kWords; ++k) {
    const std::uint32_t word = random();
    for (unsigned shift = 0; shift < 32; shift += 4) token += kDigits[(word >> shift) & 15U];
  }
  return token;
}

Admission::Admission(const std::string& listen, std::uint16_t port,
                     std::vector<std::string> origins)
    : viewers_{std::move(origins)} {
  if (listen.empty()) {
    viewers_.insert(viewers_.end(), kApplications.begin(), kApplications.end());
    for (const char* here : {"127.0.0.1", "localhost", "::1"})
      names_.push_back(name_of(here, port));
  } else {
    names_.push_back(name_of(listen, port));
    look_ = random_token();
    command_ = random_token();
  }
}

bool Admission::is_name(std::string_view host) const {
  return std::find(names_.begin(), names_.end(), host) != names_.end();
}

bool Admission::is_origin(std::string_view origin) const {
  return origin.starts_with(kScheme) && is_name(origin.substr(kScheme.size()));
}

bool Admission::is_origin_text(std::string_view text) {
  constexpr std::string_view kMark = "://";
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyz0123456789-._[]:";
  const std::size_t end = text.find(kMark);
  if (end == std::string_view::npos || end == 0) return false;
  const std::string_view host = text.substr(end + kMark.size());
  return text.substr(0, end).find_first_not_of(kAllowed) == std::string_view::npos &&
         host.find_first_not_of(kAllowed) == std::string_view::npos && !host.empty();
}

Right Admission::right_of_origin(std::string_view origin) const {
  if (is_origin(origin)) return Right::kCommand;
  const bool may_look = std::find(viewers_.begin(), viewers_.end(), origin) != viewers_.end();
  return may_look ? Right::kLook : Right::kNone;
}

Right Admission::right_of(std::string_view token) const {
  const bool looks = equal(token, look_);
  const bool commands = equal(token, command_);
  return commands ? Right::kCommand : looks ? Right::kLook : Right::kNone;
}

bool Admission::is_bearer(std::string_view authorization) const {
  constexpr std::string_view kBearer = "Bearer ";
  return authorization.starts_with(kBearer) &&
         right_of(authorization.substr(kBearer.size())) != Right::kNone;
}

std::string Admission::address(Right right) const {
  const std::string& token = right == Right::kCommand ? command_ : look_;
  return std::string(kScheme) + names_.front() + "/" + (wants_token() ? "#" + token : "");
}

}  // namespace rosflight::web::server
