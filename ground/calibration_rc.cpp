// SPDX-License-Identifier: BSD-3-Clause
// Calibrations that a person does with the transmitter.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ostream>

#include "ground/calibration.hpp"

namespace rosflight::ground {
namespace {

using companion::NamedValue;
using companion::ParameterSet;

// Pulses of a receiver: 1000 to 2000 us, sticks at rest at 1500 us, throttle at 1000 us.
constexpr int kLowEnd_us = 1100;
constexpr int kHighEnd_us = 1900;
constexpr int kCentre_us = 1500;
constexpr int kMaxOffCentre_us = 100;
constexpr int kMaxStir_us = 10;  // of a stick that is released
constexpr Time kReleased = std::chrono::seconds{1};

struct Stick {
  const char* name;
  const char* parameter;
  bool centred;
  std::size_t channel{};
  int low{100000};
  int high{0};
};

using Sticks = std::array<Stick, 4>;

/// Smallest and largest pulses of the sticks.
class StickRange final : public companion::Listener {
 public:
  StickRange(Session& session, const Sticks& chosen) : sticks(chosen), session_(session) {
    session_.add(*this);
  }
  ~StickRange() override { session_.remove(*this); }
  StickRange(const StickRange&) = delete;
  StickRange& operator=(const StickRange&) = delete;

  void on_rc(const link::RcChannels& rc, const companion::Stamp& stamp) override {
    for (Stick& stick : sticks) {
      const int pulse = rc.pulse_us[stick.channel];
      stick.low = std::min(stick.low, pulse);
      stick.high = std::max(stick.high, pulse);
    }
    if (begin == Time{}) begin = stamp.arrival;
    end = stamp.arrival;
  }
  void restart() {
    for (Stick& stick : sticks) {
      stick.low = 100000;
      stick.high = 0;
    }
    begin = end = Time{};
  }

  Sticks sticks;
  Time begin{};
  Time end{};

 private:
  Session& session_;
};

bool whole_range(const Stick& stick) {
  return stick.low <= kLowEnd_us && stick.high >= kHighEnd_us;
}

int rest(const Stick& stick) {
  return (stick.low + stick.high) / 2;
}

bool released(const Stick& stick) {
  const bool in_place = stick.centred ? std::abs(rest(stick) - kCentre_us) <= kMaxOffCentre_us
                                      : stick.high <= kLowEnd_us;
  return in_place && stick.high - stick.low <= kMaxStir_us;
}

std::string range_text(const Stick& stick) {
  return fmt::format("{} stick (channel {}): {} .. {} us", stick.name, stick.channel, stick.low,
                     stick.high);
}

int refuse_rc(const std::string& why, std::ostream& out) {
  say(out, "rc calibration refused: " + why + "; nothing changed");
  return 1;
}

/// Waits until a second of frames satisfies the test; starts over with each second that does not.
bool at_rest(GroundLink& link, StickRange& range, Time limit) {
  range.restart();
  const auto all_released = [&range] {
    return std::all_of(range.sticks.begin(), range.sticks.end(), released);
  };
  const Time until = link.now() + limit;
  while (link.now() < until) {
    link.run_until([&range] { return range.end - range.begin >= kReleased; }, until - link.now());
    if (range.end - range.begin >= kReleased && all_released()) return true;
    if (link.now() < until) range.restart();
  }
  return false;
}

// ---- speed controllers

constexpr std::size_t kEscOutputs = 10;  // that a mixer has
constexpr double kUpperEnd = 0.99;
constexpr double kLowerEnd = 0.01;
constexpr std::int32_t kEscMixer = 0;

/// What the mixer of a vehicle consists of: choosing another one fills the rest.
bool is_mixer_parameter(const NamedValue& entry) {
  return entry.name.starts_with("PRI_MIXER") || entry.name.starts_with("SEC_MIXER") ||
         entry.name == "PRIMARY_MIXER" || entry.name == "SECONDARY_MIXER";
}

/// Smallest and largest value that all outputs had together.
class OutputEnds final : public companion::Listener {
 public:
  explicit OutputEnds(Session& session) : session_(session) { session_.add(*this); }
  ~OutputEnds() override { session_.remove(*this); }
  OutputEnds(const OutputEnds&) = delete;
  OutputEnds& operator=(const OutputEnds&) = delete;

  void on_output(const link::OutputRaw& m, const companion::Stamp& /*stamp*/) override {
    const auto end = m.values.begin() + kEscOutputs;
    highest = std::max(highest, static_cast<double>(*std::min_element(m.values.begin(), end)));
    now_highest = static_cast<double>(*std::max_element(m.values.begin(), end));
  }
  double highest{0.0};      ///< Reached by every output.
  double now_highest{1.0};  ///< Highest value of the last message.

 private:
  Session& session_;
};

/// The steps of a person. @returns what went wrong; empty if nothing did.
std::string drive_both_ends(GroundLink& link, const CalibrationOptions& options,
                            std::ostream& out) {
  const auto armed = [&link] { return link.streams().status.value.armed; };
  const double wait_s = companion::to_seconds(options.wait);
  OutputEnds ends(link.session());
  say(out, "speed controllers without power: arm, then raise the throttle stick to its end");
  if (!link.run_until(armed, options.wait)) return fmt::format("not armed within {:g} s", wait_s);
  ends.highest = 0.0;
  if (!link.run_until([&ends] { return ends.highest >= kUpperEnd; }, options.wait)) {
    return fmt::format("upper end {:.3f}, limit {:g} within {:g} s", ends.highest, kUpperEnd,
                       wait_s);
  }
  say(out, fmt::format(
               "upper end {:.3f} on {} outputs: power the speed controllers, wait for their tones, "
               "then lower the stick",
               ends.highest, kEscOutputs));
  if (!link.run_until([&] { return ends.now_highest <= kLowerEnd && armed(); }, options.wait)) {
    return fmt::format("lower end {:.3f}, limit {:g} within {:g} s", ends.now_highest, kLowerEnd,
                       wait_s);
  }
  const double lowest = ends.now_highest;
  say(out, fmt::format("lower end {:.3f}: wait for the tones, then disarm", lowest));
  if (!link.run_until([&] { return !armed(); }, options.wait)) {
    return fmt::format("not disarmed within {:g} s", wait_s);
  }
  say(out, fmt::format("endpoints sent: {:.3f} and {:.3f} on {} outputs", lowest, ends.highest,
                       kEscOutputs));
  return {};
}

/// Puts the former mixer back and stores it, since arming stored the other one.
/// @returns what went wrong; empty if nothing did.
std::string restore_mixer(GroundLink& link, const ParameterSet& before, Time wait,
                          std::ostream& out) {
  Session& session = link.session();
  const auto disarmed = [&link] { return !link.streams().status.value.armed; };
  if (!disarmed()) {
    say(out, "disarm: only then the former mixer can be put back");
    link.finish_until(disarmed, wait);
  }
  const auto load = session.parameters().load(before);
  if (link.finish(load).failed()) return "former mixer NOT put back: " + load.text();
  const auto store = session.commands().start(link::Command::kWriteParams);
  if (link.finish(store).failed()) return "former mixer in force, but NOT stored: " + store.text();
  say(out, "former mixer put back and stored");
  return {};
}

}  // namespace

int calibrate_rc(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  Sticks sticks{{{"roll", "RC_X_CHN", true},
                 {"pitch", "RC_Y_CHN", true},
                 {"yaw", "RC_Z_CHN", true},
                 {"throttle", "RC_F_CHN", false}}};
  const std::vector<std::string> trims{"X_EQ_TORQUE", "Y_EQ_TORQUE", "Z_EQ_TORQUE"};
  for (Stick& stick : sticks) {
    const auto channel = read_values(link, {stick.parameter})[0].value.as_int32();
    stick.channel =
        static_cast<std::size_t>(std::clamp<std::int32_t>(channel, 0, link::kRcChannels - 1));
  }
  const ParameterSet before = read_values(link, trims);
  if (!link.run_until([&] { return link.streams().rc.count > 0; }, link.timeout())) {
    throw NoAnswer("rc: no receiver channels from " + link.name());
  }
  StickRange range(link.session(), sticks);
  const auto all_moved = [&range] {
    return std::all_of(range.sticks.begin(), range.sticks.end(), whole_range);
  };
  const auto armed = [&link] { return link.streams().status.value.armed; };
  if (!armed()) {  // otherwise the vehicle sends the reason
    say(out,
        "propellers off (sticks can arm): move both sticks of the transmitter to all their ends");
    const bool moved = link.run_until([&] { return all_moved() || armed(); }, options.wait);
    const Sticks found = range.sticks;
    for (const Stick& stick : found) say(out, range_text(stick));
    if (!moved) {
      const auto bad = std::find_if_not(found.begin(), found.end(), whole_range);
      return refuse_rc(
          fmt::format("{}, limit {} .. {} us", range_text(*bad), kLowEnd_us, kHighEnd_us), out);
    }
    say(out, "release the sticks, throttle down, and do not touch them");
    const bool rested = at_rest(link, range, options.wait);
    for (const Stick& stick : range.sticks) {
      say(out,
          fmt::format("{} {} {} us", stick.name, stick.centred ? "centre" : "low", rest(stick)));
    }
    if (!rested) {
      const auto bad = std::find_if_not(range.sticks.begin(), range.sticks.end(), released);
      const bool seen = bad != range.sticks.end();
      return refuse_rc(
          !seen ? "no receiver channels"
          : bad->centred
              ? fmt::format("{} centre {} us, moving by {} us; limits {} .. {} us and {} us",
                            bad->name, rest(*bad), bad->high - bad->low,
                            kCentre_us - kMaxOffCentre_us, kCentre_us + kMaxOffCentre_us,
                            kMaxStir_us)
              : fmt::format("throttle {} us, limit {} us", bad->high, kLowEnd_us),
          out);
    }
  }
  const auto job = link.session().commands().start(link::Command::kRcCalibration);
  const TextLog texts(link.session());
  link.wait(job);
  link.run_for(std::chrono::milliseconds{300});
  for (const std::string& line : texts.lines()) say(out, "vehicle: " + line);
  say(out, job.text());
  if (job.failed()) return 1;
  const ParameterSet now = read_values(link, trims);
  for (std::size_t i = 0; i < trims.size(); ++i) {
    say(out,
        fmt::format("trim {}: {} -> {}", trims[i], before[i].value.text(), now[i].value.text()));
  }
  return store_calibration(link, options.write, out);
}

int calibrate_esc(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  const auto refuse_esc = [&out](const std::string& why) {
    say(out, "esc calibration refused: " + why + "; nothing changed");
    return 1;
  };
  if (!options.props_off) {
    return refuse_esc(
        "found propellers possibly mounted, allowed without them: take them off and give "
        "--props-off");
  }
  link.receive_parameters();
  if (link.streams().status.value.armed) return refuse_esc("the vehicle is armed");
  Session& session = link.session();
  ParameterSet before = session.parameters().table().values();
  std::erase_if(before, [](const NamedValue& entry) { return !is_mixer_parameter(entry); });
  // The choice comes first: it fills the matrix, whose own values follow.
  std::stable_partition(before.begin(), before.end(), [](const NamedValue& entry) {
    return entry.name == "PRIMARY_MIXER" || entry.name == "SECONDARY_MIXER";
  });
  const auto choice = session.parameters().set("PRIMARY_MIXER", kEscMixer);
  if (link.wait(choice).failed()) return refuse_esc(choice.text());
  std::string problem;
  bool stopped = false;
  try {
    problem = drive_both_ends(link, options, out);
  } catch (const Stopped&) {
    stopped = true;
  }
  const std::string left = restore_mixer(link, before, options.wait, out);
  if (!left.empty()) {
    say(out, left);
    return 1;
  }
  if (stopped) throw Stopped();
  if (!problem.empty()) {
    say(out, "esc calibration failed: " + problem);
    return 1;
  }
  return 0;
}

}  // namespace rosflight::ground
