// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_table.hpp"

#include <algorithm>
#include <utility>

#include "companion/events.hpp"

namespace rosflight::companion {

namespace {

// More than any FCU has; keeps a broken count from asking for megabytes and for weeks of requests.
constexpr std::size_t kMaxCount = 4096;

bool well_formed(const link::ParamValue& m) {
  return m.count > 0 && m.count <= kMaxCount && m.index < m.count &&
         (m.type == link::ParamType::kInt32 || m.type == link::ParamType::kFloat) &&
         make_name(text_of(m.name)).has_value();
}

// What follows the NUL may be leftovers.
link::ParamName padded(const link::ParamName& name) {
  return make_name(text_of(name)).value_or(link::ParamName{});
}

}  // namespace

ParameterTable::Result ParameterTable::accept(const link::ParamValue& message) {
  if (!well_formed(message)) {
    return {Update::kMalformed, {}};
  }
  if (entries_.empty()) {
    entries_.resize(message.count);
  }
  if (message.count != entries_.size()) {
    return {Update::kForeign, {}};
  }
  const link::ParamName name = padded(message.name);
  const ParameterValue value{message.type, message.value};
  Entry& entry = entries_[message.index];
  if (!entry.known) {
    if (find(name)) {
      return {Update::kForeign, {}};
    }
    entry = {name, value, true, true, entry.awaited - (entry.awaited > 0 ? 1U : 0U)};
    ++known_;
    ++fresh_;
    return {Update::kNew, {}};
  }
  if (entry.name != name || entry.value.type != message.type) {
    return {Update::kForeign, {}};
  }
  entry.awaited -= entry.awaited > 0 ? 1 : 0;
  fresh_ += entry.fresh ? 0 : 1;
  entry.fresh = true;
  if (same_value(entry.value, value)) {
    return {Update::kSame, {}};
  }
  const ParameterValue old_value = std::exchange(entry.value, value);
  return {Update::kChanged, old_value};
}

void ParameterTable::forget() {
  entries_.clear();
  known_ = 0;
  fresh_ = 0;
}

void ParameterTable::age() {
  for (Entry& entry : entries_) {
    entry.fresh = false;
  }
  fresh_ = 0;
}

std::optional<std::size_t> ParameterTable::find(const link::ParamName& name) const {
  const auto it = std::find_if(entries_.begin(), entries_.end(),
                               [&](const Entry& e) { return e.known && e.name == name; });
  if (it == entries_.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(it - entries_.begin());
}

std::optional<std::size_t> ParameterTable::find(std::string_view name) const {
  const auto padded_name = make_name(name);
  return padded_name ? find(*padded_name) : std::nullopt;
}

std::optional<std::size_t> ParameterTable::next_missing(std::size_t from) const {
  for (std::size_t i = from; i < entries_.size(); ++i) {
    if (!entries_[i].fresh) {
      return i;
    }
  }
  return std::nullopt;
}

ParameterSet ParameterTable::values() const {
  ParameterSet set;
  set.reserve(known_);
  for (const Entry& entry : entries_) {
    if (entry.known) {
      set.push_back({std::string(text_of(entry.name)), entry.value});
    }
  }
  std::sort(set.begin(), set.end(),
            [](const NamedValue& a, const NamedValue& b) { return a.name < b.name; });
  return set;
}

}  // namespace rosflight::companion
