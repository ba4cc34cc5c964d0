// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/rc_lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ostream>

#include "config/strict_yaml.hpp"

namespace rosflight::flight {
namespace {

constexpr std::size_t kMaxLine = 100;

}  // namespace

void RcLines::step() {
  pollfd ready{fd_, POLLIN, 0};
  if (fd_ < 0 || ::poll(&ready, 1, 0) <= 0) return;
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(fd_, bytes.data(), bytes.size());
  if (count <= 0) fd_ = -1;
  if (count > 0) rest_.append(bytes.data(), static_cast<std::size_t>(count));
  for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
    move(rest_.substr(0, end));
    rest_.erase(0, end + 1);
  }
  rest_.resize(std::min(rest_.size(), kMaxLine));
}

void RcLines::move(const std::string& line) {
  const auto& names = sim::rc::kControlNames;
  const std::size_t space = line.find(' ');
  const auto* const name = std::find(names.begin(), names.end(), line.substr(0, space));
  constexpr double kNone = -1.0;
  const double to = space == std::string::npos
                        ? kNone
                        : config::parse_number(line.substr(space + 1)).value_or(kNone);
  if (name == names.end() || !(to >= 0.0 && to <= 1.0)) {
    err_ << fmt::format(
                "rosflight: --rc -: found '{}', allowed CONTROL POSITION with {} and 0 to 1\n",
                line.substr(0, kMaxLine), fmt::join(names, ", "))
         << std::flush;
    return;
  }
  pilot_.set(static_cast<sim::rc::Control>(name - names.begin()), static_cast<float>(to));
}

}  // namespace rosflight::flight
