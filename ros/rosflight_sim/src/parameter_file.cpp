// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/parameter_file.hpp"

#include <algorithm>

namespace rosflight_sim {

namespace {

constexpr const char* kParameters = "ros__parameters";

bool is_for(const std::string& part, const std::string& node) {
  return part == node || part == "**" || part == "*";
}

std::string without_namespace(const std::string& name) {
  return name.substr(name.rfind('/') + 1);
}

/// The section at `key` if it is a map, whatever else is there.
std::optional<config::Section> map_at(const config::Section& parent, const std::string& key) {
  try {
    return parent.optional_section(key);
  } catch (const config::Error&) {
    return {};
  }
}

}  // namespace

std::optional<ParameterFile> ParameterFile::load(const std::string& file) {
  const auto document = config::Document::from_file(file);
  if (document.is_list()) return {};
  ParameterFile out(document.root());
  if (out.parts_.empty()) return {};
  return out;
}

ParameterFile::ParameterFile(const config::Section& root) {
  for (const std::string& key : root.keys()) {
    const auto section = map_at(root, key);
    if (!section) continue;
    const auto parameters = map_at(*section, kParameters);
    if (!parameters) continue;
    parts_.push_back({without_namespace(key), *parameters});
    if (parts_.back().node == "fixedwing_forces_and_moments") type_ = "fixedwing";
  }
}

std::optional<std::vector<double>> ParameterFile::value(const std::string& node,
                                                        const std::string& name,
                                                        rosflight_common::GivenKind kind) {
  using rosflight_common::GivenKind;
  asked_.insert(name);
  std::optional<std::vector<double>> found;
  for (const Part& part : parts_) {
    if (!is_for(part.node, node) || !part.parameters.has(name)) continue;
    if (kind == GivenKind::kNumber) {
      found = std::vector<double>{part.parameters.number(name, config::Range::any())};
    } else if (kind == GivenKind::kSwitch) {
      found = std::vector<double>{part.parameters.boolean(name) ? 1.0 : 0.0};
    } else {
      found = part.parameters.numbers(name, config::Section::kAnyCount, config::Range::any());
    }
  }
  return found;
}

std::vector<std::string> ParameterFile::unused(const std::string& node) const {
  std::vector<std::string> names;
  for (const Part& part : parts_) {
    if (part.node != node) continue;
    for (const std::string& name : part.parameters.keys())
      if (asked_.count(name) == 0) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace rosflight_sim
