// SPDX-License-Identifier: BSD-3-Clause
#include "flight/steering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "config/strict_yaml.hpp"
#include "flight/tuning.hpp"

namespace rosflight::flight {
namespace {

using config::Error;
using sim::rc::Control;
using Change = std::function<void(Flight&)>;

constexpr std::string_view kAllowed =
    "wind, gust, fault, heal, switch, stick, keep_altitude, altitude_offset, hold, board, land, "
    "return, tune";

/// Its part before the first `mark`, and what follows.
std::pair<std::string, std::string> cut(const std::string& text, char mark) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

Error wrong(const std::string& what, const std::string& found, std::string_view allowed) {
  return Error(fmt::format("{}: found '{}', allowed {}", what, found.substr(0, 60), allowed));
}

bool on_or_off(const std::string& what, const std::string& text) {
  if (text != "on" && text != "off") throw wrong(what, text, "on, off");
  return text == "on";
}

Change wind(const std::string& text) {
  const WindChoice choice = parse_wind(text);
  return [choice](Flight& flight) {
    flight.set_wind(choice.steady_W_m_s, choice.w20_m_s.value_or(0.0));
  };
}

Change gust(const std::string& text) {
  constexpr double kMaxHold_s = 60.0;
  const std::size_t comma = text.rfind(',');
  const auto seconds =
      comma == std::string::npos ? std::nullopt : config::parse_number(text.substr(comma + 1));
  if (!seconds || !(*seconds > 0.0) || *seconds > kMaxHold_s)
    throw wrong("gust", text, "SPEED,FROM_DEG,SECONDS with more than 0 and at most 60 s");
  const WindChoice peak = parse_wind(text.substr(0, comma));
  if (peak.w20_m_s) throw wrong("gust", text, "SPEED,FROM_DEG,SECONDS");
  return [peak, duration_s = *seconds](Flight& flight) {
    flight.add_gust(peak.steady_W_m_s, duration_s);
  };
}

Change fault(const std::string& text, const FlightSetup& setup) {
  const auto [what, duration] = cut(text, ':');
  if (what.find('@') != std::string::npos)
    throw wrong("fault", text, "WHAT[=VALUE][:DURATION]; it begins now");
  sim::Fault fault = sim::parse_fault(what + "@0" + (duration.empty() ? "" : ":" + duration));
  setup.check(fault);
  return [fault](Flight& flight) {
    sim::Fault from_now = fault;
    from_now.start = flight.now();
    if (fault.end != sim::Time::max()) from_now.end = flight.now() + fault.end;
    flight.faults().add(from_now);
  };
}

Control control(const std::string& name, bool is_switch) {
  constexpr std::size_t kSticks = 4;  // the first ones
  const auto& names = sim::rc::kControlNames;
  const auto first = names.begin() + (is_switch ? kSticks : 0);
  const auto last = is_switch ? names.end() : names.begin() + kSticks;
  const auto found = std::find(first, last, name);
  if (found == last) {
    throw wrong(is_switch ? "switch" : "stick", name,
                fmt::format("{}", fmt::join(first, last, ", ")));
  }
  return static_cast<Control>(found - names.begin());
}

Change move(const std::string& text, bool is_switch) {
  const auto [name, where] = cut(text, ' ');
  const Control which = control(name, is_switch);
  double to = 0.0;
  if (is_switch) {
    to = on_or_off(name, where) ? 1.0 : 0.0;
  } else {
    const auto number = config::parse_number(where);
    if (!number || !(*number >= 0.0 && *number <= 1.0)) throw wrong(name, where, "0 to 1");
    to = *number;
  }
  return [which, to](Flight& flight) { flight.pilot().set(which, static_cast<float>(to)); };
}

Change altitude_offset(const std::string& text) {
  constexpr double kMax_m = 3.0;
  const auto offset_m = config::parse_number(text);
  if (!offset_m || !(std::abs(*offset_m) <= kMax_m))
    throw wrong("altitude_offset", text, "-3 to 3 m");
  return [to_m = *offset_m](Flight& flight) { flight.guidance().set_altitude_offset(to_m); };
}

Change board(const std::string& text, const FlightSetup& setup) {
  using Impairment = Autopilot::Impairment;
  constexpr std::array<std::pair<std::string_view, Impairment>, 3> kImpairments{
      {{"slow", Impairment::kSlowPasses},
       {"reversed_clock", Impairment::kReversedImuClock},
       {"healthy", Impairment::kNone}}};
  const auto* const found = std::find_if(kImpairments.begin(), kImpairments.end(),
                                         [&text](const auto& one) { return one.first == text; });
  if (found == kImpairments.end()) throw wrong("board", text, "slow, reversed_clock, healthy");
  if (setup.choice.board != "in_process") throw wrong("board", setup.choice.board, "in_process");
  return [kind = found->second](Flight& flight) {
    static_cast<void>(flight.autopilot().set_impairment(flight.now(), kind));
  };
}

Change tune(const std::string& text, const Flight& flight) {
  const auto [key, value] = cut(text, ' ');
  return [vehicle = tuned(flight.vehicle_text(), flight.setup(), key, value)](Flight& flying) {
    flying.tune(vehicle);
  };
}

}  // namespace

std::function<void(Flight&)> parse_change(const std::string& text, const Flight& present) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control))
    throw Error("steer: found a control character, allowed a line of text");
  const auto [verb, rest] = cut(text, ' ');
  if (verb == "wind") return wind(rest);
  if (verb == "gust") return gust(rest);
  if (verb == "fault") return fault(rest, present.setup());
  if (verb == "switch") return move(rest, true);
  if (verb == "stick") return move(rest, false);
  if (verb == "tune") return tune(rest, present);
  if (verb == "hold") {
    return [on = on_or_off("hold", rest)](Flight& flight) { flight.runner().set_hold(on); };
  }
  if (verb == "board") return board(rest, present.setup());
  const bool multirotor_only = verb == "keep_altitude" || verb == "altitude_offset";
  if (multirotor_only && present.setup().fixed_wing())
    throw wrong("steer", verb, "that of a multirotor");
  if (verb == "altitude_offset") return altitude_offset(rest);
  if (verb == "keep_altitude") {
    return [on = on_or_off(verb, rest)](Flight& flight) { flight.runner().set_keep_altitude(on); };
  }
  if (!rest.empty()) throw wrong("steer", text, kAllowed);
  if (verb == "heal") return [](Flight& flight) { flight.faults().end_all(flight.now()); };
  if (verb == "land") return [](Flight& flight) { flight.guidance().request_land(); };
  if (verb == "return") return [](Flight& flight) { flight.guidance().request_return(); };
  throw wrong("steer", text, kAllowed);
}

}  // namespace rosflight::flight
