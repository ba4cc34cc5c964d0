// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/imu_clock.hpp"

namespace rosflight::core {

ImuClock::Step ImuClock::use(Time stamp, Time arrival, bool restarted, Time dt) {
  stamp_ = stamp;
  arrival_ = arrival;
  candidates_ = 0;
  equal_ = 1;
  known_ = true;
  watching_ = false;
  return {true, false, restarted, false, hal::seconds(dt)};
}

ImuClock::Step ImuClock::examine(Time stamp, Time arrival, std::int64_t dt, std::int64_t waited) {
  if (!known_) return use(stamp, arrival, true, Time{0});
  if (dt > 0 && fits(dt, waited)) return use(stamp, arrival, false, Time{dt});
  watching_ = true;
  if (dt == 0) {
    const bool time_passed = waited > 0;  // a paused simulation stops both clocks
    if (time_passed && equal_ < kStanding) ++equal_;
    Step s;
    s.standing = equal_ >= kStanding;
    s.usable = !s.standing;
    return s;
  }
  const std::int64_t since = difference(stamp, candidate_stamp_);
  const bool agrees =
      candidates_ > 0 && since > 0 && fits(since, (arrival - candidate_arrival_).count());
  candidates_ = agrees ? static_cast<std::uint8_t>(candidates_ + 1) : std::uint8_t{1};
  candidate_stamp_ = stamp;
  candidate_arrival_ = arrival;
  if (candidates_ >= kAgreeing) return use(stamp, arrival, true, Time{waited});
  Step s;
  s.backwards = dt < 0;
  return s;
}

}  // namespace rosflight::core
