// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/atomic_file.hpp"
#include "config/strict_yaml.hpp"

namespace rosflight::companion {

namespace {

NamedValue read_entry(const config::Section& entry) {
  NamedValue result;
  result.name = entry.text("name");
  if (!make_name(result.name)) {
    throw entry.error("name", entry.raw("name"), "1 to 16 letters, digits and _");
  }
  const std::int64_t type = entry.integer("type", 6, 9);
  if (type != 6 && type != 9) {
    throw entry.error("type", entry.raw("type"), "6 (int32) or 9 (float)");
  }
  const double number = entry.number("value", config::Range::any());
  std::string problem;
  const auto value = to_value(number, static_cast<link::ParamType>(type), problem);
  if (!value) {
    throw entry.error(
        "value", entry.raw("value"),
        type == 6 ? "a whole number of 32 bits (type 6)" : "a number that fits a float (type 9)");
  }
  result.value = *value;
  entry.finish();
  return result;
}

ParameterSet read_document(const config::Document& document, const EntryCheck& check) {
  ParameterSet set;
  std::set<std::string> names;
  for (const config::Section& entry : document.root_sections()) {
    set.push_back(read_entry(entry));
    if (!names.insert(set.back().name).second) {
      throw entry.error("name", set.back().name + " a second time", "each name once");
    }
    const auto allowed = check ? check(set.back()) : std::nullopt;
    if (allowed) {
      throw entry.error("value", entry.raw("value"), *allowed);
    }
  }
  return set;
}

}  // namespace

ParameterSet read_parameter_file(const std::filesystem::path& path, const EntryCheck& check) {
  return read_document(config::Document::from_file(path), check);
}

ParameterSet parse_parameters(std::string_view text, const std::string& name) {
  return read_document(config::Document::from_text(text, name), {});
}

std::string format_parameters(const ParameterSet& set, std::string_view firmware_version) {
  std::string text = "# " + std::to_string(set.size()) + " parameters";
  if (!firmware_version.empty()) {
    // Hostile or garbled version texts must not break out of the comment.
    std::string printable(firmware_version);
    std::replace_if(
        printable.begin(), printable.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    text += " of firmware " + printable;
  }
  text += '\n';
  std::vector<const NamedValue*> sorted;
  sorted.reserve(set.size());
  for (const NamedValue& entry : set) {
    sorted.push_back(&entry);
  }
  std::sort(sorted.begin(), sorted.end(),
            [](const NamedValue* a, const NamedValue* b) { return a->name < b->name; });
  for (const NamedValue* entry : sorted) {
    text += std::isfinite(entry->value.number()) ? "- {name: " : "# not a finite number: {name: ";
    text += entry->name + ", type: " + std::to_string(static_cast<int>(entry->value.type)) +
            ", value: " + entry->value.text() + "}\n";
  }
  return set.empty() ? text + "[]\n" : text;
}

void write_parameter_file(const std::filesystem::path& path, const ParameterSet& set,
                          std::string_view firmware_version) {
  base::write_file(path, format_parameters(set, firmware_version), base::Durability::kPowerCut);
}

}  // namespace rosflight::companion
