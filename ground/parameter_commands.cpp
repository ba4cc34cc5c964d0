// SPDX-License-Identifier: BSD-3-Clause
#include "ground/parameter_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "companion/load_summary.hpp"
#include "companion/parameter_file.hpp"
#include "config/strict_yaml.hpp"
#include "ground/parameter_info.hpp"

namespace rosflight::ground {
namespace {

using companion::NamedValue;
using companion::ParameterResult;
using companion::ParameterSet;
using companion::ParameterValue;
using Json = nlohmann::ordered_json;

constexpr Time kTextTime = std::chrono::milliseconds{300};  // a refusal is followed by its reason

std::optional<std::string> allowed_if_not(std::string_view name, double value) {
  const ParameterInfo* const info = find_parameter_info(name);
  if (info == nullptr || info->allows(value)) return std::nullopt;
  return info->allowed() + (info->unit.empty() ? "" : " " + std::string(info->unit));
}

Json number(const ParameterValue& value) {
  if (value.type == link::ParamType::kInt32) return value.as_int32();
  return config::parse_number(value.text()).value_or(value.number());  // shortest, not widened
}

bool differs(const NamedValue& entry) {
  const ParameterInfo* const info = find_parameter_info(entry.name);
  return info != nullptr && !same_value(info->default_value(), entry.value);
}

Json json_row(const NamedValue& entry) {
  const ParameterInfo* const info = find_parameter_info(entry.name);
  return {{"name", entry.name},
          {"type", companion::type_name(entry.value.type)},
          {"value", number(entry.value)},
          {"default", info == nullptr ? Json() : number(info->default_value())},
          {"unit", info == nullptr ? Json() : Json(info->unit)},
          {"differs", differs(entry)}};
}

void print_rows(const ParameterSet& set, bool json, std::ostream& out) {
  if (json) {
    Json rows = Json::array();
    for (const NamedValue& entry : set) rows.push_back(json_row(entry));
    out << rows.dump(2) << "\n";
    return;
  }
  out << fmt::format("  {:<16} {:>14} {:>14}  {}\n", "name", "value", "default", "unit");
  for (const NamedValue& entry : set) {
    const ParameterInfo* const info = find_parameter_info(entry.name);
    const std::string line = fmt::format(
        "{} {:<16} {:>14} {:>14}  {}", differs(entry) ? '*' : ' ', entry.name, entry.value.text(),
        info == nullptr ? "-" : info->default_value().text(), info == nullptr ? "" : info->unit);
    out << line.substr(0, line.find_last_not_of(' ') + 1) << "\n";
  }
}

/// What the vehicle sent about a parameter that it refused.
std::string reason(GroundLink& link, const TextLog& texts, const std::string& name) {
  const auto said = [&] { return !texts.last_with(name).empty(); };
  link.run_until(said, kTextTime);
  return said() ? " (vehicle: " + texts.last_with(name) + ")" : "";
}

/// One parameter from the vehicle. @throws config::Error if it has none of that name.
NamedValue read(GroundLink& link, const std::string& name) {
  const TextLog texts(link.session());
  const auto job = link.session().parameters().read(name);
  const auto unknown = [&] { return texts.last_with("No parameter " + name) != ""; };
  link.run_until([&] { return !job.pending() || unknown(); }, companion::kNever);
  const auto& value = job.result().value;
  if (job.done() && value) return {name, *value};
  if (unknown()) throw config::Error(name + ": the vehicle has no such parameter");
  throw NoAnswer(job.text() + " from " + link.name());
}

void warn_not_stored(const GroundLink& link, std::ostream& out) {
  out << "not stored: lost at the next restart of " << link.name() << "; --write stores them\n";
}

int store(GroundLink& link, std::ostream& out) {
  const auto job = link.session().commands().start(link::Command::kWriteParams);
  link.wait(job);
  out << job.text() << "\n";
  return job.done() ? kGood : kNotGood;
}

int report(GroundLink& link, const std::vector<ParameterResult>& results, const TextLog& texts,
           bool write, std::ostream& out) {
  bool good = true;
  for (const ParameterResult& result : results) {
    good = good && result.ok();
    out << result.text << (result.ok() ? "" : reason(link, texts, result.name)) << "\n";
  }
  if (good && write) return store(link, out);
  if (write) {
    out << "nothing stored\n";
  } else if (link.session().parameters().unsaved()) {
    warn_not_stored(link, out);
  }
  return good ? kGood : kNotGood;
}

}  // namespace

std::vector<Assignment> parse_assignments(const std::vector<std::string>& words) {
  if (words.empty() || words.size() % 2 != 0) {
    throw config::Error(
        fmt::format("set: found {} words, allowed NAME VALUE, once or more", words.size()));
  }
  std::vector<Assignment> assignments;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    const std::string& name = words[i];
    const auto value = config::parse_number(words[i + 1]);
    const auto error = [&](const std::string& allowed) {
      return config::Error(fmt::format("{}: found {}, allowed {}", name, words[i + 1], allowed));
    };
    if (!companion::make_name(name)) {
      throw config::Error("name: found '" + name + "', allowed 1 to 16 letters, digits and _");
    }
    if (!value) throw error("a number");
    const ParameterInfo* const info = find_parameter_info(name);
    std::string problem;
    if (info != nullptr && !companion::to_value(*value, info->type, problem)) {
      throw error(info->type == link::ParamType::kInt32 ? "a whole number"
                                                        : "a number that fits a float");
    }
    if (const auto allowed = allowed_if_not(name, *value)) throw error(*allowed);
    assignments.push_back({name, *value});
  }
  return assignments;
}

ParameterSet read_checked_file(const std::filesystem::path& file) {
  return companion::read_parameter_file(file, [](const NamedValue& entry) {
    // A float of the file stands for the number that was written: 0.9999 is not above 0.9999.
    const auto written = config::parse_number(entry.value.text());
    return allowed_if_not(entry.name, written.value_or(entry.value.number()));
  });
}

int list_parameters(GroundLink& link, bool only_changed, bool json, std::ostream& out) {
  link.receive_parameters();
  ParameterSet set = link.session().parameters().table().values();
  const std::size_t all = set.size();
  const auto changed = static_cast<std::size_t>(std::count_if(set.begin(), set.end(), differs));
  if (only_changed) std::erase_if(set, [](const NamedValue& entry) { return !differs(entry); });
  print_rows(set, json, out);
  if (!json) out << fmt::format("{} parameters, * {} differ from their defaults\n", all, changed);
  return kGood;
}

int get_parameters(GroundLink& link, const std::vector<std::string>& names, bool json,
                   std::ostream& out) {
  ParameterSet set;
  for (const std::string& name : names) set.push_back(read(link, name));
  print_rows(set, json, out);
  return kGood;
}

int set_parameters(GroundLink& link, const std::vector<Assignment>& assignments, bool write,
                   std::ostream& out) {
  for (const Assignment& a : assignments) read(link, a.name);
  const TextLog texts(link.session());
  std::vector<ParameterResult> results;
  results.reserve(assignments.size());
  for (const Assignment& a : assignments) {
    results.push_back(link.wait(link.session().parameters().set(a.name, a.value)).result());
  }
  return report(link, results, texts, write, out);
}

int load_parameters(GroundLink& link, const ParameterSet& set, bool write, std::ostream& out) {
  link.receive_parameters();
  const TextLog texts(link.session());
  const auto job = link.session().parameters().load(set);
  link.wait(job);
  std::vector<ParameterResult> bad;
  for (const ParameterResult& entry : job.result().entries) {
    if (!entry.ok()) bad.push_back(entry);
  }
  out << companion::count_text(job.result()) << "\n";
  return report(link, bad, texts, write, out);
}

int save_parameters(GroundLink& link, const std::filesystem::path& file, bool only_changed,
                    std::ostream& out) {
  link.receive_parameters();
  ParameterSet defaults;
  for (const ParameterInfo& info : parameter_infos()) {
    if (only_changed) defaults.push_back({std::string(info.name), info.default_value()});
  }
  const auto job = link.session().parameters().save_file(file, std::move(defaults));
  if (link.wait(job).failed()) throw config::Error(job.text());
  out << job.text() << "\n";
  return kGood;
}

int diff_parameters(GroundLink& link, const ParameterSet& set, bool all, bool json,
                    std::ostream& out) {
  using Kind = companion::ParameterDifference::Kind;
  link.receive_parameters();
  auto differences = companion::diff(set, link.session().parameters().table().values());
  if (!all) std::erase_if(differences, [](const auto& d) { return d.kind == Kind::kOnlyRight; });
  Json rows = Json::array();
  for (const auto& d : differences) {
    const bool in_file = d.kind != Kind::kOnlyRight;
    const bool in_vehicle = d.kind != Kind::kOnlyLeft;
    if (json) {
      rows.push_back({{"name", d.name},
                      {"file", in_file ? number(d.left) : Json()},
                      {"vehicle", in_vehicle ? number(d.right) : Json()}});
    } else {
      const auto shown = [&d](bool there, const ParameterValue& v) {
        if (!there) return std::string("none");
        return d.kind == Kind::kType ? v.text() + " " + companion::type_name(v.type) : v.text();
      };
      out << fmt::format("{:<16} file {:>14}  vehicle {:>14}\n", d.name, shown(in_file, d.left),
                         shown(in_vehicle, d.right));
    }
  }
  if (json) {
    out << rows.dump(2) << "\n";
  } else {
    out << fmt::format("{} of {} parameters of the file differ\n", differences.size(), set.size());
  }
  return differences.empty() ? kGood : kNotGood;
}

}  // namespace rosflight::ground
