// SPDX-License-Identifier: BSD-3-Clause
#include "ground/preflight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <ostream>

#include "companion/check_list.hpp"
#include "companion/status_text.hpp"

namespace rosflight::ground {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<PreflightRow>;
using enum PreflightVerdict;
using namespace std::chrono_literals;

constexpr Time kObservation = 2500ms;  // two heartbeats and a rate of every stream
constexpr Time kListTime = 1s;
constexpr int kListAttempts = 3;
constexpr double kMaxLoss_percent = 5.0;
constexpr double kMaxDrift_ppm = 200.0;  // crystals are good for 100 ppm
constexpr int kFix3D = 3;

constexpr const char* kParameters[] = {
    "BATT_VOLT_MAX", "FAILSAFE_THR", "FIXED_WING",  "GYRO_X_BIAS", "GYRO_Y_BIAS",
    "GYRO_Z_BIAS",   "ACC_X_BIAS",   "ACC_Y_BIAS",  "ACC_Z_BIAS",  "MAG_X_BIAS",
    "MAG_Y_BIAS",    "MAG_Z_BIAS",   "MAG_CAL_A00", "BARO_BIAS",   "DIFF_PRESS_BIAS"};

constexpr const char* kNotSent = "not sent on this link";

const char* verdict_text(PreflightVerdict verdict) {
  constexpr std::array<const char*, 4> kTexts{"pass", "warning", "FAIL", "not sent"};
  return kTexts[static_cast<std::size_t>(verdict)];
}

/// Collects the lines of the firmware's list.
class ListReader final : public companion::Listener {
 public:
  explicit ListReader(Session& session) : session_(session) { session_.add(*this); }
  ~ListReader() override { session_.remove(*this); }
  ListReader(const ListReader&) = delete;
  ListReader& operator=(const ListReader&) = delete;

  void on_event(const companion::Event& event) override { list_.add(session_.now(), event); }
  bool complete() const { return list_.complete(); }
  std::vector<link::CheckResult> lines() const {
    std::vector<link::CheckResult> all;
    for (const auto& [index, line] : list_.lines()) all.push_back(line.result);
    return all;
  }

 private:
  Session& session_;
  companion::CheckList list_;
};

std::optional<double> value_of(const PreflightFacts& facts, std::string_view name) {
  const auto found = std::find_if(facts.parameters.begin(), facts.parameters.end(),
                                  [name](const auto& entry) { return entry.name == name; });
  if (found == facts.parameters.end()) return std::nullopt;
  return found->value.number();
}

void add_firmware_list(const PreflightFacts& facts, Rows& rows) {
  for (const link::CheckResult& line : facts.checks) {
    const auto outcome = static_cast<link::CheckOutcome>(line.result);
    const auto verdict = outcome == link::CheckOutcome::kPass      ? kPass
                         : outcome == link::CheckOutcome::kWarning ? kWarning
                                                                   : kFail;
    rows.push_back({std::string(companion::text_of(line.name)), verdict,
                    std::string(companion::text_of(line.reason))});
  }
}

/// Rows for a firmware without the list, such as ROSflight 2.x: the bits of its error word.
void add_error_word(const PreflightFacts& facts, Rows& rows) {
  for (int bit = 0; companion::error_text(bit) != nullptr; ++bit) {
    const bool set = (facts.status.error_code >> bit & 1) != 0;
    rows.push_back({companion::error_text(bit), set ? kFail : kPass,
                    set ? "error flag of the firmware" : "error flag is clear"});
  }
  for (const char* name : {"throttle low", "override switch", "at rest", "level",
                           "stored parameters", "loop time", "battery low"}) {
    rows.push_back({name, kNotTold, "the firmware sends no list of its checks"});
  }
}

void add_state(const PreflightFacts& facts, Rows& rows) {
  const std::string errors = companion::error_texts(facts.status.error_code);
  rows.push_back({"error flags", errors.empty() ? kPass : kFail, errors});
  rows.push_back({"disarmed", facts.status.armed ? kFail : kPass,
                  facts.status.armed ? "the vehicle is armed" : ""});
  rows.push_back({"RC failsafe", facts.status.failsafe ? kFail : kPass,
                  facts.status.failsafe ? "failsafe is active" : ""});
}

void add_link(const PreflightFacts& facts, Rows& rows) {
  const auto& frames = facts.link.frames;
  const double all = static_cast<double>(frames.frames_received) + frames.sequence_gaps;
  const double loss = all > 0.0 ? 100.0 * frames.sequence_gaps / all : 0.0;
  rows.push_back(
      {"link loss", loss <= kMaxLoss_percent ? kPass : kFail,
       fmt::format("{:.2f} % of {:.0f} frames, allowed {:g} %", loss, all, kMaxLoss_percent)});
  const bool slow = std::abs(facts.drift_ppm) <= kMaxDrift_ppm;
  rows.push_back({"clock",
                  !facts.synchronised ? kNotTold
                  : slow              ? kPass
                                      : kWarning,
                  facts.synchronised ? fmt::format("drift {:+.1f} ppm, allowed {:g} ppm",
                                                   facts.drift_ppm, kMaxDrift_ppm)
                                     : "time requests are not answered"});
  const bool same = facts.version == companion::VersionMatch::kSame;
  rows.push_back({"version",
                  facts.firmware.empty() ? kNotTold
                  : same                 ? kPass
                                         : kWarning,
                  facts.firmware.empty() ? kNotSent
                  : same                 ? facts.firmware
                         : facts.firmware + ", made for another version of the companion"});
}

template <class T>
void add_stream(const char* name, const companion::Latest<T>& latest, bool needed,
                const std::string& text, Rows& rows) {
  if (latest.count > 0) {
    rows.push_back({name, kPass,
                    fmt::format("{}{}{:.0f} Hz", text, text.empty() ? "" : ", ", latest.rate_hz)});
  } else {
    rows.push_back({name, needed ? kFail : kNotTold,
                    needed ? "no message" : "no message: no such sensor, or its stream is off"});
  }
}

void add_sensors(const PreflightFacts& facts, Rows& rows) {
  const auto& s = facts.streams;
  add_stream("IMU samples", s.imu, true, "", rows);
  add_stream("attitude", s.attitude, true, "", rows);
  add_stream("RC channels", s.rc, true, fmt::format("{} channels", s.rc.value.count), rows);
  add_stream("mag samples", s.mag, false, "", rows);
  add_stream("baro samples", s.baro, false, "", rows);
  add_stream("airspeed", s.diff_pressure, false, "", rows);
  add_stream("range", s.range, false, "", rows);
  add_stream("GNSS", s.gnss, false,
             fmt::format("fix {}, {} satellites", s.gnss.value.fix, s.gnss.value.satellites), rows);
  if (s.gnss.count > 0 && s.gnss.value.fix < kFix3D) rows.back().verdict = kWarning;
  const auto full_V = value_of(facts, "BATT_VOLT_MAX");
  add_stream("battery volts", s.battery, false,
             fmt::format("{:.2f} V{}", s.battery.value.voltage_V,
                         full_V ? fmt::format(" of {:.2f} V", *full_V) : ""),
             rows);
}

/// A calibration leaves values that are not the neutral ones.
void add_calibration(const PreflightFacts& facts, const char* name,
                     const std::vector<std::pair<const char*, double>>& neutral, Rows& rows) {
  bool known = true;
  bool calibrated = false;
  for (const auto& [parameter, value] : neutral) {
    const auto found = value_of(facts, parameter);
    known = known && found.has_value();
    calibrated = calibrated || (found && *found != value);
  }
  rows.push_back({std::string(name) + " calibrated",
                  !known       ? kNotTold
                  : calibrated ? kPass
                               : kWarning,
                  !known ? "the vehicle has no such parameters"
                  : calibrated
                      ? ""
                      : fmt::format("{} and others have their neutral value", neutral[0].first)});
}

void add_parameters(const PreflightFacts& facts, Rows& rows) {
  const auto& s = facts.streams;
  add_calibration(facts, "gyro", {{"GYRO_X_BIAS", 0}, {"GYRO_Y_BIAS", 0}, {"GYRO_Z_BIAS", 0}},
                  rows);
  add_calibration(facts, "accel", {{"ACC_X_BIAS", 0}, {"ACC_Y_BIAS", 0}, {"ACC_Z_BIAS", 0}}, rows);
  if (s.mag.count > 0) {
    add_calibration(facts, "mag",
                    {{"MAG_X_BIAS", 0}, {"MAG_Y_BIAS", 0}, {"MAG_Z_BIAS", 0}, {"MAG_CAL_A00", 1}},
                    rows);
  }
  if (s.baro.count > 0) add_calibration(facts, "baro", {{"BARO_BIAS", 0}}, rows);
  if (s.diff_pressure.count > 0) add_calibration(facts, "airspeed", {{"DIFF_PRESS_BIAS", 0}}, rows);
  const auto failsafe = value_of(facts, "FAILSAFE_THR");
  const bool in_range = failsafe && *failsafe >= 0.0 && *failsafe <= 1.0;
  const bool fixedwing = value_of(facts, "FIXED_WING").value_or(0.0) != 0.0;
  if (!failsafe || fixedwing) {
    rows.push_back({"failsafe throttle", failsafe ? kPass : kNotTold,
                    failsafe ? "fixed wing: always 0" : kNotSent});
  } else {
    rows.push_back({"failsafe throttle", in_range ? kPass : kFail,
                    fmt::format("FAILSAFE_THR {:g}", *failsafe)});
  }
  rows.push_back(
      {"parameters stored", kNotTold,
       "no message compares memory and values in force; our firmware stores before it arms"});
}

}  // namespace

std::span<const char* const> preflight_parameters() {
  return kParameters;
}

std::vector<PreflightRow> judge_preflight(const PreflightFacts& facts) {
  Rows rows;
  if (facts.checks.empty()) {
    add_error_word(facts, rows);
  } else {
    add_firmware_list(facts, rows);
  }
  add_state(facts, rows);
  add_link(facts, rows);
  add_sensors(facts, rows);
  add_parameters(facts, rows);
  return rows;
}

PreflightFacts observe_preflight(GroundLink& link) {
  Session& session = link.session();
  std::vector<Job<companion::ParameterResult>> reads;
  for (const char* name : preflight_parameters()) reads.push_back(session.parameters().read(name));
  link.run_for(kObservation);
  ListReader list(session);
  for (int attempt = 0; attempt < kListAttempts && !list.complete(); ++attempt) {
    session.request_report(link::ReportKind::kChecks);
    link.run_until([&] { return list.complete(); }, kListTime);
  }
  PreflightFacts facts;
  for (const auto& job : reads) {
    link.wait(job);
    const auto& value = job.result().value;
    if (job.done() && value) facts.parameters.push_back({job.result().name, *value});
  }
  facts.checks = list.lines();
  facts.status = session.streams().status.value;
  facts.streams = session.streams();
  facts.link = session.statistics();
  facts.synchronised = session.time_sync().synchronised();
  facts.drift_ppm = session.time_sync().figures().drift_ppm;
  facts.firmware = session.firmware_version();
  facts.version = session.version_match();
  return facts;
}

int print_preflight(const std::vector<PreflightRow>& rows, bool json, std::ostream& out) {
  const auto count = [&rows](PreflightVerdict verdict) {
    return std::count_if(rows.begin(), rows.end(),
                         [=](const auto& r) { return r.verdict == verdict; });
  };
  const auto failed = count(kFail);
  if (json) {
    Json j;
    j["ready"] = failed == 0;
    j["checks"] = Json::array();
    for (const PreflightRow& row : rows) {
      constexpr std::array<const char*, 4> kWords{"pass", "warning", "fail", "not_told"};
      j["checks"].push_back({{"name", row.name},
                             {"result", kWords[static_cast<std::size_t>(row.verdict)]},
                             {"text", row.text}});
    }
    out << j.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
  } else {
    for (const PreflightRow& row : rows) {
      const std::string line =
          fmt::format("{:<9} {:<19} {}", verdict_text(row.verdict), row.name, row.text);
      out << line.substr(0, line.find_last_not_of(' ') + 1) << "\n";
    }
    out << fmt::format("{}: {} pass, {} warn, {} fail, {} not sent on this link\n",
                       failed == 0 ? "ready" : "NOT READY", count(kPass), count(kWarning), failed,
                       count(kNotTold));
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace rosflight::ground
