// SPDX-License-Identifier: BSD-3-Clause
#include "config/table.hpp"
#include "rosflight_sim/view_tools.hpp"
#include "sim/fixedwing/fixedwing.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight_sim {

namespace config = rosflight::config;

namespace views {

namespace {

/// What the vehicle file knows of a key.
struct FileKey {
  config::Range allowed;
  std::string text;
  std::function<Numbers(const Vehicle&)> get;
};
using FileKeys = std::map<std::string, FileKey>;

template <class S, class Get>
void add_section(FileKeys& keys, const std::string& section, const config::Table<S>& table,
                 Get get) {
  for (const auto& parameter : table.parameters()) {
    const auto& row = parameter.row;
    const std::string key = section + "." + row.key;
    std::string text = key + " of the vehicle file";
    if (!row.text.empty()) text += ": " + std::string(row.text);
    if (!row.unit.empty()) text += " [" + std::string(row.unit) + "]";
    keys.emplace(key, FileKey{row.allowed, std::move(text), [parameter, get](const Vehicle& v) {
                                return parameter.get(get(v));
                              }});
  }
}

const FileKeys& file_keys() {
  static const FileKeys all = [] {
    FileKeys keys;
    add_section(keys, "body", sim::body_parameters(), [](const Vehicle& v) { return v.body(); });
    add_section(keys, "environment", sim::environment_parameters(),
                [](const Vehicle& v) { return v.environment(); });
    add_section(keys, "rotors", sim::rotor_parameters(), rotors_of);
    add_section(keys, "aero", sim::aero_parameters(),
                [](const Vehicle& v) { return rotors_of(v).aero; });
    add_section(keys, "aero", sim::airframe_parameters(),
                [](const Vehicle& v) { return sim::read_fixed_wing(v.root()).airframe; });
    add_section(keys, "surfaces", sim::surface_parameters(),
                [](const Vehicle& v) { return sim::read_fixed_wing(v.root()); });
    return keys;
  }();
  return all;
}

}  // namespace

void add(List& list, const KeyView& view, std::function<double(const Vehicle&)> get) {
  const FileKey& key = file_keys().at(view.key);
  add(list, view.name, key.allowed.low / view.factor, key.allowed.high / view.factor, key.text,
      std::move(get));
}

void add(List& list, const KeyViews& views) {
  for (const KeyView& view : views) {
    add(list, view, [view, get = file_keys().at(view.key).get](const Vehicle& v) {
      return get(v).at(view.index) / view.factor;
    });
  }
}

void assign(std::vector<std::string>& out, const KeyViews& views, const ViewValues& all,
            const Names& changed) {
  std::map<std::string, Numbers> values;
  Names keys;
  for (const KeyView& view : views) {
    values[view.key].push_back(view.factor * all.at(view.name)[0]);
    if (changed.count(view.name) != 0) keys.insert(view.key);
  }
  for (const std::string& key : keys) {
    const Numbers& numbers = values.at(key);
    out.push_back(key + "=" + (numbers.size() == 1 ? text(numbers[0]) : text(numbers)));
  }
}

}  // namespace views

}  // namespace rosflight_sim
