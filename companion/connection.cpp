// SPDX-License-Identifier: BSD-3-Clause
#include "companion/connection.hpp"

namespace rosflight::companion {

namespace {
constexpr Time kBackwards = std::chrono::milliseconds{200};
}

bool Connection::received(Time now, bool is_heartbeat) {
  last_received_ = now;
  if (connected_ || !is_heartbeat) {
    return false;
  }
  connected_ = true;
  return true;
}

bool Connection::expired(Time now) {
  if (!connected_ || now - last_received_ < timeout_) {
    return false;
  }
  connected_ = false;
  return true;
}

bool Connection::close() {
  const bool was = connected_;
  connected_ = false;
  return was;
}

bool Connection::fcu_clock(Time fcu) {
  if (!latest_fcu_ || fcu + kBackwards >= *latest_fcu_) {
    // A frame broken so that its checksum fits could bring a far-away time, after which every true
    // stamp would look like a restart: two good ones later that is mended, at the price of one
    // false alarm.
    latest_fcu_ = latest_fcu_ && fcu < *latest_fcu_ ? *latest_fcu_ : fcu;
    went_back_ = false;
    return false;
  }
  if (!went_back_) {
    went_back_ = true;
    return false;
  }
  went_back_ = false;
  latest_fcu_ = fcu;
  return true;
}

}  // namespace rosflight::companion
