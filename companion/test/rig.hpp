// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <string_view>
#include <vector>

#include "companion/in_process.hpp"
#include "companion/session.hpp"
#include "companion/test/fake_fcu.hpp"
#include "link/detect/detecting_codec.hpp"

namespace rosflight::companion::test {

using namespace std::chrono_literals;

/// Remembers all events.
class EventLog final : public Listener {
 public:
  void on_event(const Event& event) override { events.push_back(event); }

  template <class T>
  std::vector<T> of() const {
    std::vector<T> result;
    for (const Event& e : events) {
      if (const T* t = std::get_if<T>(&e)) {
        result.push_back(*t);
      }
    }
    return result;
  }
  std::size_t count(ConnectionChange change) const {
    std::size_t n = 0;
    for (const ConnectionEvent& e : of<ConnectionEvent>()) {
      n += e.change == change ? 1U : 0U;
    }
    return n;
  }

  std::vector<Event> events;
};

/// A session and a fake FCU at the two ends of a lossy cable, in simulated time, 400 steps a
/// second.
class Rig {
 public:
  static constexpr Time kStep = 2500us;

  explicit Rig(std::vector<FakeFcu::Parameter> table = numbered_table(20),
               const Session::Options& options = {}, double byte_loss = 0.0, std::uint64_t seed = 1)
      : lossy_up(link.companion_end(), byte_loss, seed),
        lossy_down(link.fcu_end(), byte_loss, seed + 1000),
        fcu(lossy_down, std::move(table)),
        session(codec, lossy_up, options) {
    session.add(log);
  }

  void step() {
    now += kStep;
    fcu.step(now);
    session.step(now);
  }
  void run_for(Time duration) {
    for (const Time end = now + duration; now < end;) {
      step();
    }
  }
  /// @returns false if `condition` did not come true within `limit` of simulated time.
  template <class Condition>
  bool run_until(Condition&& condition, Time limit = 60s) {
    for (const Time end = now + limit; now < end;) {
      if (condition()) {
        return true;
      }
      step();
    }
    return condition();
  }
  /// The session's idea of a parameter; NaN if it has none.
  ParameterValue mirror(std::string_view name) const {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    return session.parameters().get(name).value_or(ParameterValue::of(kNone));
  }
  template <class J>
  bool run_job(const J& job, Time limit = 60s) {
    return run_until([&] { return !job.pending(); }, limit);
  }

  Time now{1s};
  InProcessLink link{1 << 16};
  LossyTransport lossy_up;
  LossyTransport lossy_down;
  FakeFcu fcu;
  link::DetectingCodec codec;
  Session session;
  EventLog log;
};

}  // namespace rosflight::companion::test
