// SPDX-License-Identifier: BSD-3-Clause
// Every parameter that may be changed while armed is changed in flight, to each value that messages
// can take it to, and the vehicle goes on flying: judged by the world, not by any estimate. The
// list comes from the firmware's own table.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "flight/test/fixedwing_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using core::Param;
using core::Parameters;
using sim::rc::Control;

/// Values of one parameter, each sent as a message of its own.
struct Change {
  Param id{};
  std::vector<double> values;
};

double number(const Parameters& p, Param id) {
  const bool whole = Parameters::row(id).type == core::ParamType::kInt32;
  return whole ? static_cast<double>(p.get_int(id)) : static_cast<double>(p.get_float(id));
}

/// What the parameter is after a message with `value`, armed.
double after_message(Parameters p, Param id, double value) {
  const bool whole = Parameters::row(id).type == core::ParamType::kInt32;
  const auto bits = whole ? std::bit_cast<std::uint32_t>(static_cast<std::int32_t>(value))
                          : std::bit_cast<std::uint32_t>(static_cast<float>(value));
  static_cast<void>(
      p.set_bits(id, static_cast<std::uint8_t>(Parameters::row(id).type), bits, true));
  return number(p, id);
}

bool is_whole(Param id) {
  return Parameters::row(id).type == core::ParamType::kInt32;
}

/// The farthest value towards `limit` that one message is taken with; nothing if none is.
std::optional<double> farthest(const Parameters& p, Param id, double limit) {
  const double start = number(p, id);
  const auto accepted = [&](double value) { return after_message(p, id, value) != start; };
  if (limit == start) return std::nullopt;
  if (accepted(limit)) return limit;
  double taken = start;
  double refused = limit;
  constexpr int kHalvings = 60;
  for (int k = 0; k < kHalvings; ++k) {
    double middle = 0.5 * (taken + refused);
    if (is_whole(id)) middle = std::round(middle);
    (middle != start && accepted(middle) ? taken : refused) = middle;
  }
  if (taken == start) return std::nullopt;
  return taken;
}

/// As far towards `limit` as `messages` messages can take it.
std::optional<Change> towards(Parameters p, Param id, double limit, int messages) {
  Change change{id, {}};
  for (int k = 0; k < messages; ++k) {
    const auto next = farthest(p, id, limit);
    if (!next) break;
    const double value = after_message(p, id, *next);
    change.values.push_back(*next);
    static_cast<void>(is_whole(id) ? p.set_int(id, static_cast<std::int32_t>(value))
                                   : p.set_float(id, static_cast<float>(value)));
  }
  if (change.values.empty()) return std::nullopt;
  return change;
}

std::string name_of(Param id) {
  const auto& name = Parameters::row(id).name;
  return {name.data(), std::find(name.begin(), name.end(), '\0')};
}

/// Tuning has no bound of its own: only the size of one message's step is limited.
bool is_tuned(Param id) {
  const std::string name = name_of(id);
  return (name.rfind("PID_", 0) == 0 && name != "PID_TAU") ||
         name.find("_EQ_TORQUE") != std::string::npos;
}

/// All that can be done while armed to the parameters of `p`.
std::vector<Change> changes_of(const Parameters& p, bool tuned) {
  constexpr int kMaxMessages = 20;
  constexpr float kMaxLimit = 1e6f;
  std::vector<Change> changes;
  for (std::size_t k = 0; k < core::kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    if (is_tuned(id) != tuned) continue;
    const auto& row = Parameters::row(id);
    for (const float limit : {row.min, row.max, row.sentinel}) {
      if (std::isnan(limit)) continue;
      const auto change =
          towards(p, id, static_cast<double>(std::clamp(limit, -kMaxLimit, kMaxLimit)),
                  tuned ? 1 : kMaxMessages);
      if (change) changes.push_back(*change);
    }
  }
  return changes;
}

/// A vehicle on its mission, and what may be asked of it.
class InFlight {
 public:
  explicit InFlight(FlightChoice choice) : choice_{std::move(choice)} { choice_.state = "truth"; }

  const core::Firmware& firmware() const { return rig_->firmware(); }
  const std::string& trouble() const { return trouble_; }
  double kick() const { return kick_; }

  /// Flies as before; a new flight if the last one ended or met with trouble.
  bool make_ready() {
    constexpr double kMaxTime_s = 400.0;
    if (rig_ && trouble_.empty() && rig_->flight->runner().stage() == Stage::kFly &&
        rig_->flight->autonomy().tracking && steady() &&
        sim::to_seconds(rig_->flight->now()) < kMaxTime_s) {
      return true;
    }
    trouble_.clear();
    rig_ = std::make_unique<Rig>(choice_);
    if (!rig_->reach_mission()) return false;
    const double limit_s = sim::to_seconds(rig_->flight->now()) + 30.0;
    while (!steady() && sim::to_seconds(rig_->flight->now()) < limit_s) rig_->flight->step();
    // Where the pilot's throttle counts, it is a little more than what carries the vehicle.
    constexpr double kALittleMore = 1.05;
    rig_->flight->pilot().set(Control::kThrottle,
                              static_cast<float>(kALittleMore * rig_->setup->hover_throttle));
    return steady();
  }

  /// Sends the messages, flies on, and undoes the change.
  void fly(const Change& change, double duration_s) {
    const double before = number(firmware().parameters(), change.id);
    for (const double value : change.values) send(change.id, value);
    fly_on(duration_s);
    if (!trouble_.empty()) return;
    // The pilot takes over with centred sticks, then even the radio is silent for a while.
    auto& pilot = rig_->flight->pilot();
    set_override(true);
    fly_on(duration_s);
    pilot.set_silent(true);
    fly_on(0.5);
    pilot.set_silent(false);
    set_override(false);
    fly_on(0.5);
    if (!trouble_.empty()) return;
    const int most = 2 * static_cast<int>(change.values.size()) + 2;
    for (int k = 0; k < most && number(firmware().parameters(), change.id) != before; ++k) {
      const auto back = farthest(firmware().parameters(), change.id, before);
      if (!back) break;
      send(change.id, *back);
    }
    if (number(firmware().parameters(), change.id) != before) {
      rig_.reset();  // cannot be undone: the next change has a new flight
      return;
    }
    fly_on(2.0);
  }

  /// One message; kick() is then the largest step of an output in the two passes after it, less
  /// four times the largest of the half second before.
  void tune(const Change& change) {
    const double before = number(firmware().parameters(), change.id);
    const double noise = largest_step(200);
    static_cast<void>(
        rig_->flight->session().parameters().set(name_of(change.id), change.values[0]));
    const int most = 40;
    hal::OutputValues last = outputs();
    kick_ = 0.0;
    int passes = 0;
    for (int k = 0; k < most && passes < 2; ++k) {
      last = outputs();
      rig_->flight->step();
      if (number(firmware().parameters(), change.id) == before) continue;
      // The message is read after the outputs were written: the next step is the first with it.
      if (passes > 0) kick_ = std::max(kick_, difference(last, outputs()));
      ++passes;
    }
    if (passes == 0) trouble_ = "the message was not taken";
    kick_ -= 4.0 * noise;
    fly_on(0.3);
    if (!trouble_.empty()) return;
    send(change.id, before);
    if (number(firmware().parameters(), change.id) != before)
      rig_.reset();
    else
      fly_on(1.0);
  }

 private:
  void set_override(bool on) {
    rig_->flight->pilot().set_switch(Control::kAttitudeOverride, on);
    rig_->flight->pilot().set_switch(Control::kThrottleOverride, on);
  }

  void send(Param id, double value) {
    const double wanted = after_message(firmware().parameters(), id, value);
    auto job = rig_->flight->session().parameters().set(name_of(id), value);
    for (int k = 0; k < 40 && number(firmware().parameters(), id) != wanted; ++k) step();
    if (number(firmware().parameters(), id) != wanted) trouble_ = "the message was not taken";
  }

  void fly_on(double duration_s) {
    const double end_s = sim::to_seconds(rig_->flight->now()) + duration_s;
    while (trouble_.empty() && sim::to_seconds(rig_->flight->now()) < end_s) step();
  }

  void step() {
    rig_->flight->step();
    if (!trouble_.empty()) return;
    if (!upright()) trouble_ = "not upright";
    if (rig_->height_m() < 1.0) trouble_ = "came down";
    if (!firmware().state().armed()) trouble_ = "disarmed";
    if (rig_->flight->runner().stage() == Stage::kFailed)
      trouble_ = rig_->flight->runner().failure();
    if (!trouble_.empty()) {
      trouble_ += " at " + std::to_string(sim::to_seconds(rig_->flight->now())) + " s: tilt " +
                  std::to_string(rig_->tilt_deg()) + " deg, height " +
                  std::to_string(rig_->height_m()) + " m";
    }
  }

  bool fixed_wing() const { return rig_->setup->fixed_wing(); }
  bool upright() const { return rig_->tilt_deg() < (fixed_wing() ? 75.0 : 60.0); }
  /// Level enough, and high enough, to begin.
  bool steady() const {
    return rig_->tilt_deg() < (fixed_wing() ? 50.0 : 5.0) &&
           rig_->height_m() > (fixed_wing() ? 40.0 : 8.0);
  }

  hal::OutputValues outputs() const { return rig_->flight->in_process().board().outputs.values(); }
  double difference(const hal::OutputValues& a, const hal::OutputValues& b) const {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      largest = std::max(largest, static_cast<double>(std::abs(a[k] - b[k])));
    }
    return largest;
  }
  double largest_step(int steps) {
    double largest = 0.0;
    for (int k = 0; k < steps; ++k) {
      const auto last = outputs();
      step();
      largest = std::max(largest, difference(last, outputs()));
    }
    return largest;
  }

  FlightChoice choice_;
  std::unique_ptr<Rig> rig_;
  std::string trouble_;
  double kick_{0.0};
};

FlightChoice rotors() {
  FlightChoice choice;
  choice.mission = "hover";
  return choice;
}

void fly_all(const FlightChoice& choice) {
  InFlight vehicle(choice);
  ASSERT_TRUE(vehicle.make_ready());
  const auto changes = changes_of(vehicle.firmware().parameters(), false);
  EXPECT_FALSE(changes.empty());
  for (const Change& change : changes) {
    ASSERT_TRUE(vehicle.make_ready());
    vehicle.fly(change, 3.0);
    EXPECT_EQ(vehicle.trouble(), "") << name_of(change.id) << " = " << change.values.back();
  }
}

/// Some of an output's range; noise is taken off before.
constexpr double kSmallKick = 0.05;

void tune_all(const FlightChoice& choice) {
  InFlight vehicle(choice);
  ASSERT_TRUE(vehicle.make_ready());
  const auto changes = changes_of(vehicle.firmware().parameters(), true);
  EXPECT_FALSE(changes.empty());
  for (const Change& change : changes) {
    ASSERT_TRUE(vehicle.make_ready());
    vehicle.tune(change);
    EXPECT_EQ(vehicle.trouble(), "") << name_of(change.id) << " = " << change.values.back();
    EXPECT_LE(vehicle.kick(), kSmallKick) << name_of(change.id) << " = " << change.values.back();
  }
}

TEST(OpenParameters, EachBoundIsFlownByTheMultirotor) {
  fly_all(rotors());
}

TEST(OpenParameters, EachBoundIsFlownByTheFixedWing) {
  fly_all(fixedwing("racetrack"));
}

TEST(OpenParameters, OneStepOfAGainDoesNotKickTheMultirotor) {
  tune_all(rotors());
}

TEST(OpenParameters, OneStepOfAGainDoesNotKickTheFixedWing) {
  tune_all(fixedwing("racetrack"));
}

}  // namespace
}  // namespace rosflight::flight::testing
