// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_client.hpp"

#include <algorithm>
#include <utility>

#include "companion/load_summary.hpp"
#include "companion/parameter_file.hpp"

namespace rosflight::companion {

namespace {

// So many values in a row that do not fit mean that the table does not.
constexpr int kForeignUntilRelist = 3;

// Measured by the firmware at every start, which is no reason to store it: so does the firmware count (Parameters::unsaved).
bool measured_at_start(const link::ParamName& name) {
  const std::string_view text = text_of(name);
  return text == "BARO_BIAS" || text == "GROUND_LEVEL";
}

}  // namespace

ParameterClient::ParameterClient(const Options& options, Port& port)
    : options_(options),
      port_(port),
      list_(options.list, table_),
      requests_(options.requests, table_, port) {}

ParameterClient::~ParameterClient() {
  fail_all("the session has ended");
}

std::optional<ParameterValue> ParameterClient::get(std::string_view name) const {
  const auto index = table_.find(name);
  return index ? std::optional(table_[*index].value) : std::nullopt;
}

Job<ParameterClient::ListResult> ParameterClient::refresh() {
  auto record = std::make_shared<JobRecord<ListResult>>();
  record->started = port_.now();
  refreshes_.push_back(record);
  start_list();
  return Job<ListResult>(record);
}

Job<ParameterResult> ParameterClient::read(std::string_view name) {
  auto record = std::make_shared<JobRecord<ParameterResult>>();
  record->started = port_.now();
  requests_.read(name, [this, record](const ParameterResult& result) {
    record->result = result;
    ends_.finish(record, result.ok() ? JobState::kDone : JobState::kFailed, result.text,
                 port_.now());
  });
  return Job<ParameterResult>(record);
}

Job<ParameterResult> ParameterClient::set(std::string_view name, double value) {
  auto record = std::make_shared<JobRecord<ParameterResult>>();
  record->started = port_.now();
  requests_.set(name, value, std::nullopt, [this, record](const ParameterResult& result) {
    record->result = result;
    ends_.finish(record, result.ok() ? JobState::kDone : JobState::kFailed, result.text,
                 port_.now());
  });
  return Job<ParameterResult>(record);
}

Job<LoadReport> ParameterClient::load(ParameterSet set) {
  auto load = std::make_shared<Load>();
  load->set = std::move(set);
  load->job = std::make_shared<JobRecord<LoadReport>>();
  load->job->started = port_.now();
  load->job->result.entries.resize(load->set.size());
  load->open = load->set.size();
  if (load->set.empty()) {
    ends_.finish(load->job, JobState::kDone, load_summary({}), port_.now());
    return Job<LoadReport>(load->job);
  }
  loads_.push_back(load);
  for (std::size_t i = 0; i < load->set.size(); ++i) {
    request_entry(load, i);
  }
  return Job<LoadReport>(load->job);
}

void put_mixers_last(ParameterSet& set) {
  std::stable_partition(set.begin(), set.end(), [](const NamedValue& entry) {
    return entry.name != "PRIMARY_MIXER" && entry.name != "SECONDARY_MIXER";
  });
}

Job<LoadReport> ParameterClient::load_file(const std::filesystem::path& path) {
  try {
    ParameterSet set = read_parameter_file(path);
    put_mixers_last(set);
    return load(std::move(set));
  } catch (const std::exception& error) {
    auto record = std::make_shared<JobRecord<LoadReport>>();
    record->started = port_.now();
    ends_.finish(record, JobState::kFailed, error.what(), port_.now());
    return Job<LoadReport>(record);
  }
}

Job<ParameterClient::ListResult> ParameterClient::save_file(const std::filesystem::path& path,
                                                            ParameterSet defaults) {
  Save save{path, std::move(defaults), std::make_shared<JobRecord<ListResult>>()};
  save.job->started = port_.now();
  const Job<ListResult> job(save.job);
  if (table_.complete()) {
    write_save(save);
  } else {
    save.job->text = "waiting for the parameter list";
    saves_.push_back(std::move(save));
    list_progress_ = std::max(list_progress_, port_.now());
    port_.wake();
  }
  return job;
}

void ParameterClient::write_save(const Save& save) {
  ParameterSet values = table_.values();
  if (!save.defaults.empty()) {
    ParameterSet different;
    for (const ParameterDifference& d : diff(save.defaults, values)) {
      if (d.kind != ParameterDifference::Kind::kOnlyLeft) {
        different.push_back({d.name, d.right});
      }
    }
    values = std::move(different);
  }
  try {
    write_parameter_file(save.path, values, firmware_version_);
    save.job->result = {values.size(), table_.count()};
    ends_.finish(save.job, JobState::kDone,
                 std::to_string(values.size()) + " parameters written to " + save.path.string(),
                 port_.now());
  } catch (const std::exception& error) {
    ends_.finish(save.job, JobState::kFailed, error.what(), port_.now());
  }
}

void ParameterClient::request_entry(const std::shared_ptr<Load>& load, std::size_t entry) {
  const NamedValue& wanted = load->set[entry];
  requests_.set(
      wanted.name, wanted.value.number(), wanted.value.type,
      [this, load, entry](const ParameterResult& result) { entry_ended(load, entry, result); });
}

void ParameterClient::entry_ended(const std::shared_ptr<Load>& load, std::size_t entry,
                                  const ParameterResult& result) {
  ParameterResult& line = load->job->result.entries[entry];
  const bool set_again = load->round > 1 && result.outcome == ParameterOutcome::kSet;
  if (set_again && load->round == kLoadRounds) {
    line.outcome = ParameterOutcome::kRefused;
    line.text = line.name + ": set, but changed again by the flight control unit";
  } else if (load->round == 1 || !result.ok()) {
    line = result;
  }
  load->any_set = load->any_set || result.outcome == ParameterOutcome::kSet;
  if (--load->open == 0) {
    end_round(load);
  }
}

void ParameterClient::end_round(const std::shared_ptr<Load>& load) {
  const LoadReport& report = load->job->result;
  if (load->any_set && load->round < kLoadRounds) {
    ++load->round;
    load->any_set = false;
    std::vector<std::size_t> again;
    for (std::size_t i = 0; i < report.entries.size(); ++i) {
      if (report.entries[i].ok()) {
        again.push_back(i);
      }
    }
    load->open = again.size();
    for (const std::size_t i : again) {
      request_entry(load, i);
    }
    return;
  }
  std::erase(loads_, load);
  ends_.finish(load->job, report.ok() ? JobState::kDone : JobState::kFailed, load_summary(report),
               port_.now());
}

void ParameterClient::start_list() {
  table_.age();
  list_progress_ = port_.now();
  list_.start(port_.now());
  port_.wake();
}

void ParameterClient::link_opened() {
  if (options_.automatic_list) {
    start_list();
  }
}

void ParameterClient::connected(bool again) {
  // At the first contact the list may be flowing already.
  if (options_.automatic_list && (again || table_.fresh() == 0)) {
    start_list();
  }
}

void ParameterClient::fcu_restarted() {
  table_.forget();
  requests_.table_forgotten();
  saved_changes_ = changes_;
  saved_when_listed_ = false;
  publish_unsaved();
  link_opened();
}

void ParameterClient::reloaded_from_storage() {
  saved_when_listed_ = true;
  start_list();
}

void ParameterClient::written(std::uint64_t revision) {
  saved_changes_ = revision;
  publish_unsaved();
}

void ParameterClient::received(const link::ParamValue& message) {
  using Update = ParameterTable::Update;
  const bool was_complete = table_.all_fresh();
  const std::size_t fresh_before = table_.fresh();
  const ParameterTable::Result result = table_.accept(message);
  if (result.update == Update::kMalformed) {
    ++counters_.malformed;
    return;
  }
  if (result.update == Update::kForeign) {
    ++counters_.foreign;
    if (++foreign_in_a_row_ >= kForeignUntilRelist) {
      foreign_in_a_row_ = 0;
      table_.forget();
      requests_.table_forgotten();
      start_list();
    }
    return;
  }
  foreign_in_a_row_ = 0;
  ++counters_.values;
  const Time now = port_.now();
  const bool newly_fresh = table_.fresh() != fresh_before;
  const ParameterTable::Entry entry = table_[message.index];
  if (newly_fresh) {
    list_progress_ = now;
    if (table_.fresh() == 1) {
      port_.publish(ParameterListEvent{1, table_.count(), false});
    }
  }
  list_.received(message.index, newly_fresh, now);
  if (result.update != Update::kSame) {
    if (result.update == Update::kChanged && !measured_at_start(entry.name)) ++changes_;
    port_.publish(ParameterEvent{entry.name, entry.value.type, entry.value.bits,
                                 result.update == Update::kNew, result.old_value.bits});
    publish_unsaved();
  }
  requests_.received(entry.name, entry.value);
  if (!was_complete && table_.all_fresh()) {
    list_complete();
  }
  port_.wake();
  ends_.flush();
}

void ParameterClient::list_complete() {
  if (std::exchange(saved_when_listed_, false)) {
    saved_changes_ = changes_;
    publish_unsaved();
  }
  const std::size_t count = table_.count();
  port_.publish(ParameterListEvent{count, count, true});
  for (const auto& record : std::exchange(refreshes_, {})) {
    record->result = {count, count};
    ends_.finish(record, JobState::kDone, std::to_string(count) + " parameters received",
                 port_.now());
  }
  for (const Save& save : std::exchange(saves_, {})) {
    write_save(save);
  }
}

void ParameterClient::run(bool link_open) {
  const Time now = port_.now();
  if (link_open) {
    list_.run(port_);
  }
  if (now >= requests_.next_due() || (!link_open && !requests_.idle())) {
    requests_.run(link_open);
  }
  if (!(refreshes_.empty() && saves_.empty()) && now - list_progress_ >= options_.list_timeout) {
    const std::string text = "parameter list incomplete: " + std::to_string(table_.fresh()) +
                             " of " + std::to_string(table_.count()) + " received";
    for (const auto& record : std::exchange(refreshes_, {})) {
      record->result = {table_.fresh(), table_.count()};
      ends_.finish(record, JobState::kFailed, text, now);
    }
    for (const Save& save : std::exchange(saves_, {})) {
      ends_.finish(save.job, JobState::kFailed, text, now);
    }
  }
  ends_.flush();
}

Time ParameterClient::next_due(bool link_open) const {
  const Time timeout =
      refreshes_.empty() && saves_.empty() ? kNever : list_progress_ + options_.list_timeout;
  return std::min({link_open ? list_.next_due() : kNever, requests_.next_due(), timeout});
}

void ParameterClient::fail_all(const std::string& reason) {
  // No load may start another round.
  for (const auto& load : loads_) {
    load->round = kLoadRounds;
  }
  requests_.abandon(reason);
  for (const auto& record : std::exchange(refreshes_, {})) {
    ends_.finish(record, JobState::kFailed, reason, port_.now());
  }
  for (const Save& save : std::exchange(saves_, {})) {
    ends_.finish(save.job, JobState::kFailed, reason, port_.now());
  }
}

void ParameterClient::publish_unsaved() {
  if (unsaved() != published_unsaved_) {
    published_unsaved_ = unsaved();
    port_.publish(UnsavedEvent{published_unsaved_});
  }
}

void ParameterClient::copy_state_of(const ParameterClient& other) {
  table_ = other.table_;
  list_.copy_state_of(other.list_);
  requests_.copy_state_of(other.requests_);
  list_progress_ = other.list_progress_;
  changes_ = other.changes_;
  saved_changes_ = other.saved_changes_;
  published_unsaved_ = other.published_unsaved_;
  saved_when_listed_ = other.saved_when_listed_;
  foreign_in_a_row_ = other.foreign_in_a_row_;
  firmware_version_ = other.firmware_version_;
  counters_ = other.counters_;
}

}  // namespace rosflight::companion
