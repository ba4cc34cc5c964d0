// SPDX-License-Identifier: BSD-3-Clause
#include "companion/time_sync.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::companion {

namespace {

using namespace std::chrono_literals;

constexpr Time kSentNever{-1};
constexpr Time kPointPeriod = 1s;
constexpr Time kMaxRoundTrip = 2s;
constexpr Time kJumpMargin = 5ms;
constexpr Time kRosflight2Jump = 10ms;
constexpr double kRosflight2Weight = 0.95;
constexpr double kFloor_ns = 20e3;
constexpr double kMaxSlope = 500e-6;
constexpr double kMinSpan_s = 4.0;
constexpr double kJitterWeight = 0.1;

double ns(Time t) {
  return static_cast<double>(t.count());
}
Time from_ns(double value) {
  return Time{std::llround(value)};
}

}  // namespace

link::TimeSync TimeSync::request(Time now) {
  if (figures_.requests == 0) {
    sent_.fill(kSentNever);
  }
  sent_[next_sent_] = now;
  next_sent_ = (next_sent_ + 1) % kOutstanding;
  ++figures_.requests;
  return {.tc1_ns = 0, .ts1_ns = now.count()};
}

bool TimeSync::is_ours(Time sent) {
  const auto it = std::find(sent_.begin(), sent_.end(), sent);
  if (figures_.requests == 0 || it == sent_.end()) {
    return false;
  }
  *it = kSentNever;
  return true;
}

TimeSync::Answer TimeSync::answer(const link::TimeSync& message, Time now) {
  const Time sent{message.ts1_ns};
  // Half of 64 bits of nanoseconds is 146 years: a clock beyond that is a broken frame, and would
  // overflow.
  const bool plausible = message.tc1_ns > 0 && message.tc1_ns < (std::int64_t{1} << 62);
  if (!plausible || sent < Time{} || sent > now || now - sent > kMaxRoundTrip || !is_ours(sent)) {
    ++figures_.ignored;
    return Answer::kIgnored;
  }
  const Time fcu{message.tc1_ns};
  const Point point{fcu, sent + (now - sent) / 2 - fcu, now - sent};
  ++figures_.answers;
  figures_.round_trip = point.round_trip;

  if (!synchronised_) {
    restart_from(point);
    return Answer::kAccepted;
  }
  if (rule_ == Rule::kRosflight2) {
    apply_rosflight2_rule(point);
    return Answer::kAccepted;
  }
  if (contradicts(point)) {
    const bool confirmed =
        suspect_ && std::chrono::abs(suspect_->offset - point.offset) <=
                        (suspect_->round_trip + point.round_trip) / 2 + kJumpMargin;
    if (!confirmed) {
      suspect_ = point;
      return Answer::kIgnored;
    }
    ++figures_.jumps;
    restart_from(point);
    return Answer::kJumped;
  }
  suspect_.reset();
  insert(point);
  fit();
  measure(point);
  return Answer::kAccepted;
}

void TimeSync::reset() {
  synchronised_ = false;
  suspect_.reset();
  count_ = 0;
}

Time TimeSync::to_companion(Time fcu) const {
  const Time base = fcu + offset_;
  return slope_ == 0.0 ? base : base + from_ns(slope_ * ns(fcu - base_fcu_));
}

bool TimeSync::contradicts(const Point& point) const {
  const Time expected = to_companion(point.fcu) - point.fcu;
  return std::chrono::abs(point.offset - expected) >
         (point.round_trip + figures_.min_round_trip) / 2 + kJumpMargin;
}

void TimeSync::restart_from(const Point& point) {
  synchronised_ = true;
  suspect_.reset();
  count_ = 1;
  newest_ = 0;
  points_[0] = point;
  newest_since_ = point.fcu;
  base_fcu_ = point.fcu;
  offset_ = point.offset;
  slope_ = 0.0;
  mean_square_ns2_ = 0.0;
  figures_.min_round_trip = point.round_trip;
  measure(point);
}

void TimeSync::insert(const Point& point) {
  if (point.fcu - newest_since_ < kPointPeriod) {
    if (point.round_trip <= points_[newest_].round_trip) {
      points_[newest_] = point;
    }
    return;
  }
  newest_ = (newest_ + 1) % kPoints;
  count_ = std::min(count_ + 1, kPoints);
  points_[newest_] = point;
  newest_since_ = point.fcu;
}

void TimeSync::fit() {
  const Point* best = &points_[0];
  Time first = points_[0].fcu;
  Time last = first;
  for (std::size_t i = 0; i < count_; ++i) {
    const Point& p = points_[i];
    best = p.round_trip < best->round_trip ? &p : best;
    first = std::min(first, p.fcu);
    last = std::max(last, p.fcu);
  }
  figures_.min_round_trip = best->round_trip;

  // Numbers relative to the best point stay small, so doubles keep nanoseconds.
  double w_sum = 0.0;
  double x_sum = 0.0;
  double y_sum = 0.0;
  double xx_sum = 0.0;
  double xy_sum = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Point& p = points_[i];
    const double excess = 0.5 * ns(p.round_trip - best->round_trip);
    const double w = 1.0 / (kFloor_ns * kFloor_ns + excess * excess);
    const double x = ns(p.fcu - best->fcu);
    const double y = ns(p.offset - best->offset);
    w_sum += w;
    x_sum += w * x;
    y_sum += w * y;
    xx_sum += w * x * x;
    xy_sum += w * x * y;
  }
  const double spread = xx_sum - x_sum * x_sum / w_sum;
  const bool long_enough = to_seconds(last - first) >= kMinSpan_s && spread > 0.0;
  slope_ = long_enough
               ? std::clamp((xy_sum - x_sum * y_sum / w_sum) / spread, -kMaxSlope, kMaxSlope)
               : 0.0;
  base_fcu_ = best->fcu;
  offset_ = best->offset + from_ns((y_sum - slope_ * x_sum) / w_sum);
}

void TimeSync::apply_rosflight2_rule(const Point& point) {
  if (std::chrono::abs(offset_ - point.offset) > kRosflight2Jump) {
    ++figures_.jumps;
    restart_from(point);
    return;
  }
  offset_ += from_ns(kRosflight2Weight * ns(point.offset - offset_));
  figures_.min_round_trip = std::min(figures_.min_round_trip, point.round_trip);
  measure(point);
}

void TimeSync::measure(const Point& point) {
  const Time expected = to_companion(point.fcu) - point.fcu;
  const double error = ns(point.offset - expected);
  mean_square_ns2_ += kJitterWeight * (error * error - mean_square_ns2_);
  figures_.offset = expected;
  figures_.drift_ppm = slope_ * 1e6;
  figures_.jitter = from_ns(std::sqrt(mean_square_ns2_));
  figures_.error_bound = figures_.min_round_trip / 2;
}

}  // namespace rosflight::companion
