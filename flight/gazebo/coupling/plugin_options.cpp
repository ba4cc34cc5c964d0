// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/plugin_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <map>

namespace rosflight::flight::gazebo {
namespace {

using Mode = PluginOptions::Mode;

template <class Number>
Number number(const std::string& name, const std::string& text, Number min, Number max) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= min && value <= max))
    throw config::Error(
        fmt::format("<{}>: found {}, allowed a number from {} to {}", name, text, min, max));
  return value;
}

std::chrono::nanoseconds span(const std::string& name, const std::string& text, double min_s) {
  constexpr double kMax_s = 10.0;
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(number(name, text, min_s, kMax_s)));
}

Mode mode_of(const std::string& text) {
  if (text == "dynamics_only") return Mode::kDynamicsOnly;
  if (text == "whole_loop") return Mode::kWholeLoop;
  throw config::Error(fmt::format("<mode>: found '{}', allowed dynamics_only, whole_loop", text));
}

std::optional<Run> end_of(const std::string& text) {
  if (text == "run") return std::nullopt;
  if (text == "pause") return Run::kPause;
  if (text == "stop") return Run::kStop;
  throw config::Error(fmt::format("<at_end>: found '{}', allowed run, pause, stop", text));
}

struct Element {
  std::optional<Mode> only;  ///< Empty: both modes have it.
  std::function<void(const std::string& name, const std::string& text)> take;
};

std::map<std::string, Element> elements_of(PluginOptions& o) {
  constexpr std::uint64_t kMaxSeed = 1'000'000'000'000;
  constexpr double kMinWait_s = 0.001, kMinGap_s = 0.01;  // some steps, or none would ever be due
  std::map<std::string, Element> out;
  out["mode"] = {{}, [&o](auto&, auto& text) { o.mode = mode_of(text); }};
  out["link"] = {{}, [&o](auto&, auto& text) { o.link = text; }};
  out["vehicle"] = {{}, [&o](auto&, auto& text) { o.choice.vehicle = text; }};
  out["set"] = {{}, [&o](auto&, auto& text) { o.choice.overrides.push_back(text); }};
  out["seed"] = {{}, [&o](auto& name, auto& text) {
                   o.choice.seed = number<std::uint64_t>(name, text, 0, kMaxSeed);
                 }};
  out["mission"] = {Mode::kWholeLoop, [&o](auto&, auto& text) { o.choice.mission = text; }};
  out["wind"] = {Mode::kWholeLoop, [&o](auto&, auto& text) { o.choice.wind = text; }};
  out["fault"] = {Mode::kWholeLoop, [&o](auto&, auto& text) { o.choice.faults.push_back(text); }};
  out["log"] = {Mode::kWholeLoop, [&o](auto&, auto& text) { o.log_file = text; }};
  out["at_end"] = {Mode::kWholeLoop, [&o](auto&, auto& text) { o.at_end = end_of(text); }};
  out["namespace"] = {Mode::kDynamicsOnly, [&o](auto&, auto& text) { o.name_space = text; }};
  out["max_gap_s"] = {Mode::kDynamicsOnly,
                      [&o](auto& name, auto& text) { o.max_gap = span(name, text, kMinGap_s); }};
  out["wait_s"] = {Mode::kDynamicsOnly,
                   [&o](auto& name, auto& text) { o.wait = span(name, text, kMinWait_s); }};
  return out;
}

}  // namespace

PluginOptions read_plugin_options(const PluginElements& elements) {
  PluginOptions options;
  options.choice.vehicle.clear();
  const std::map<std::string, Element> known = elements_of(options);
  for (const auto& [name, text] : elements) {
    const auto found = known.find(name);
    if (found != known.end()) {
      found->second.take(name, text);
    } else if (name.find(':') == std::string::npos) {  // gz:system_priority is Gazebo's
      std::vector<std::string> names;
      for (const auto& entry : known) names.push_back(entry.first);
      throw config::Error(
          fmt::format("found an element <{}>, allowed {}", name, fmt::join(names, ", ")));
    }
  }
  for (const auto& [name, text] : elements) {
    const auto found = known.find(name);
    if (found != known.end() && found->second.only && *found->second.only != options.mode)
      throw config::Error(
          fmt::format("found an element <{}> with <mode> {}, allowed with {}", name,
                      options.mode == Mode::kWholeLoop ? "whole_loop" : "dynamics_only",
                      options.mode == Mode::kWholeLoop ? "dynamics_only" : "whole_loop"));
  }
  if (options.choice.vehicle.empty())
    throw config::Error("<vehicle>: found none, allowed a name of vehicles/ or a YAML file");
  return options;
}

}  // namespace rosflight::flight::gazebo
