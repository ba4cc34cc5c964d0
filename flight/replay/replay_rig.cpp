// SPDX-License-Identifier: BSD-3-Clause
#include "flight/replay/replay_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <set>

namespace rosflight::flight {
namespace {

constexpr float kTemperature_K = 298.15f;
constexpr std::size_t kRcColumns = 8;
constexpr std::int64_t kLatest_us = 1'000'000'000'000;  // eleven days

const char* state_name(core::State state) {
  switch (state) {
    case core::State::kArmed:
      return "armed";
    case core::State::kError:
      return "error";
    case core::State::kFailsafe:
      return "failsafe";
    case core::State::kCalibrating:
      return "calibrating";
    case core::State::kSaving:
      return "saving";
    case core::State::kMotorTest:
      return "motor_test";
    default:
      return "preflight";
  }
}

char type_letter(core::CommandType type) {
  switch (type) {
    case core::CommandType::kRate:
      return 'R';
    case core::CommandType::kAngle:
      return 'A';
    case core::CommandType::kThrottle:
      return 'T';
    default:
      return 'P';
  }
}

std::string number(float value) {
  return fmt::format("{:.9g}", static_cast<double>(value));
}

}  // namespace

/// One row of the table, cells by column name.
struct ReplayRig::Row {
  const CsvTable& table;
  std::size_t index;

  bool has(const std::string& column) const {
    const auto k = table.find(column);
    return k && !table.blank(index, *k);
  }
  float value(const std::string& column, float missing = 0.0f) const {
    const auto k = table.find(column);
    return k && !table.blank(index, *k) ? table.number_f(index, *k) : missing;
  }
  /// A whole number from 0 to `high`; 0 if the cell is blank.
  std::int64_t integer(const std::string& column, std::int64_t high) const {
    const auto k = table.find(column);
    if (!k || table.blank(index, *k)) return 0;
    const std::int64_t value = table.integer(index, *k);
    if (value < 0 || value > high) {
      throw table.error(index, *k, fmt::format("found {}, allowed 0..{}", value, high));
    }
    return value;
  }
  std::string_view text(const std::string& column) const {
    const auto k = table.find(column);
    return k ? table.cell(index, *k) : std::string_view{};
  }
  InputError error(const std::string& column, const std::string& text) const {
    return table.error(index, table.find(column).value_or(0), text);
  }
};

ReplayRig::ReplayRig()
    : serial_{1 << 16},
      codec_{{1, link::MavlinkCodec::kFcuComponent}},
      companion_{{1, link::MavlinkCodec::kCompanionComponent}},
      firmware_{board_.roles(serial_), codec_} {
  firmware_.start();
}

void ReplayRig::send(const link::Message& message) {
  link::Frame frame;
  if (companion_.encode(message, frame)) serial_.put(frame.bytes.data(), frame.size);
}

void ReplayRig::set_parameter(const std::string& name, double value) {
  const link::ParamName padded = core::padded_name(name.c_str());
  const std::size_t index = core::Parameters::find(padded);
  if (name.size() > padded.size() || index == core::kParamCount) {
    throw InputError(fmt::format("found parameter '{}', allowed a name of the firmware", name));
  }
  const auto id = static_cast<core::Param>(index);
  const core::ParamRow& row = core::Parameters::row(id);
  const bool whole = row.type == core::ParamType::kInt32;
  if (whole && value != std::trunc(value)) {
    throw InputError(fmt::format("{}: found {}, allowed a whole number", name, value));
  }
  constexpr double kMaxInteger = 2147483647.0;
  const auto i = static_cast<std::int32_t>(std::clamp(value, -kMaxInteger, kMaxInteger));
  const auto f = static_cast<float>(value);
  link::ParamSet set;
  set.name = padded;
  set.type = static_cast<std::uint8_t>(row.type);
  std::memcpy(&set.value.bits, whole ? static_cast<const void*>(&i) : &f, sizeof set.value.bits);
  const bool representable = !whole || static_cast<double>(i) == value;
  if (!representable ||
      !core::Parameters::in_range(id, whole ? core::ParamValue{i} : core::ParamValue{f})) {
    throw InputError(fmt::format("{}: found {}, allowed {}..{}", name, value, row.min, row.max));
  }
  send(set);
}

void ReplayRig::feed_imu(const Row& row) {
  if (!row.has("imu_stamp_us")) return;
  hal::ImuSample imu;
  imu.stamp = hal::microseconds(row.integer("imu_stamp_us", kLatest_us));
  imu.accel_m_s2 = {row.value("ax"), row.value("ay"), row.value("az")};
  imu.gyro_rad_s = {row.value("gx"), row.value("gy"), row.value("gz")};
  imu.temperature_K = kTemperature_K;
  board_.imu.put(imu);
}

void ReplayRig::feed_receiver(const Row& row) {
  if (row.integer("rc_new", 1) == 0) return;
  hal::RcFrame frame;
  frame.stamp = board_.clock.now();
  frame.channel_count = kRcColumns;
  frame.channels.fill(0.5f);
  for (std::size_t k = 0; k < kRcColumns; ++k) {
    frame.channels[k] = row.value(fmt::format("rc{}", k));
  }
  frame.frame_lost = row.integer("rc_frame_lost", 1) != 0;
  frame.failsafe = row.integer("rc_failsafe", 1) != 0;
  board_.receiver.put(frame);
}

void ReplayRig::feed_link(const Row& row) {
  if (row.integer("ob_new", 1) != 0) {
    link::OffboardControl command;
    command.mode = static_cast<std::uint8_t>(row.integer("ob_mode", 255));
    command.ignore = static_cast<std::uint16_t>(row.integer("ob_ignore", 65535));
    for (std::size_t k = 0; k < command.u.size(); ++k) {
      command.u[k] = row.value(fmt::format("ob_u{}", k));
    }
    send(command);
  }
  if (row.integer("ext_new", 1) != 0) {
    send(link::ExternalAttitude{
        {row.value("ext_qw"), row.value("ext_qx"), row.value("ext_qy"), row.value("ext_qz")}});
  }
}

void ReplayRig::feed_events(const Row& row) {
  std::string_view rest = row.text("event");
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string event{rest.substr(0, end)};
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t space = event.find(' ');
    const std::string what = event.substr(0, space);
    const std::string argument = space == std::string::npos ? "" : event.substr(space + 1);
    if (what == "CAL_IMU" && argument.empty()) {
      send(link::CommandRequest{static_cast<std::uint8_t>(link::Command::kAccelCalibration)});
    } else if (what == "PARAM" || what == "BARO") {
      const std::size_t equals = argument.find('=');
      const std::string value =
          what == "BARO" ? argument : argument.substr(std::min(equals + 1, argument.size()));
      double v = 0.0;
      const auto [stop, status] = std::from_chars(value.data(), value.data() + value.size(), v);
      const bool parsed = status == std::errc{} && stop == value.data() + value.size();
      if (!parsed || (what == "PARAM" && equals == std::string::npos)) {
        throw row.error("event",
                        fmt::format("found '{}', allowed PARAM NAME=NUMBER or BARO NUMBER", event));
      }
      if (what == "BARO") {
        board_.baro.put({board_.clock.now(), static_cast<float>(v), kTemperature_K});
        continue;
      }
      try {
        set_parameter(argument.substr(0, equals), v);
      } catch (const InputError& e) {
        throw row.error("event", e.what());
      }
    } else if (what == "AUX" && !argument.empty()) {
      feed_auxiliary(row, argument);
    } else if (!event.empty()) {
      throw row.error("event", fmt::format("found '{}', allowed CAL_IMU, PARAM, BARO, AUX", event));
    }
  }
}

void ReplayRig::feed_auxiliary(const Row& row, std::string_view text) {
  link::AuxCommand aux;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view item = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (item.empty()) continue;
    std::size_t index = 0;
    float value = 0.0f;
    const char* stop = item.data() + item.size();
    const auto first = std::from_chars(item.data(), stop, index);
    const bool shaped = first.ec == std::errc{} && index < link::kOutputs && stop - first.ptr > 3 &&
                        first.ptr[0] == ':' && (first.ptr[1] == 'S' || first.ptr[1] == 'M') &&
                        first.ptr[2] == ':';
    const auto second = shaped ? std::from_chars(first.ptr + 3, stop, value) : first;
    if (!shaped || second.ec != std::errc{} || second.ptr != stop) {
      throw row.error("event",
                      fmt::format("found AUX '{}', allowed INDEX:S|M:NUMBER, index 0..13", item));
    }
    aux.type[index] = static_cast<std::uint8_t>(first.ptr[1] == 'S' ? link::AuxType::kServo
                                                                    : link::AuxType::kMotor);
    aux.value[index] = value;
  }
  send(aux);
}

void ReplayRig::step(const CsvTable& table, std::size_t index) {
  const Row row{table, index};
  board_.clock.set(hal::microseconds(row.integer("time_us", kLatest_us)));
  feed_imu(row);
  feed_receiver(row);
  if (row.has("batt_v")) {
    board_.battery.put({board_.clock.now(), row.value("batt_v"), 0.0f});
  }
  feed_link(row);
  feed_events(row);
  firmware_.run();
  static_cast<void>(serial_.take_sent());
}

const std::vector<std::string>& ReplayRig::output_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> c{"armed",       "failsafe",  "error_codes", "fsm",
                               "rc_override", "ob_active", "cmd_types"};
    const auto add = [&c](const char* prefix, int count) {
      for (int k = 0; k < count; ++k) c.push_back(fmt::format("{}{}", prefix, k));
    };
    add("cmd_u", 6);
    for (const char* name : {"qw", "qx", "qy", "qz", "wx", "wy", "wz", "bx", "by", "bz"}) {
      c.emplace_back(name);
    }
    add("ctl", 10);
    add("mix", 10);
    add("out", 14);
    return c;
  }();
  return columns;
}

bool ReplayRig::is_input(std::string_view column) {
  static const std::set<std::string, std::less<>> names = [] {
    std::set<std::string, std::less<>> n{"step",
                                         "time_us",
                                         "imu_stamp_us",
                                         "ax",
                                         "ay",
                                         "az",
                                         "gx",
                                         "gy",
                                         "gz",
                                         "rc_new",
                                         "rc_frame_lost",
                                         "rc_failsafe",
                                         "batt_v",
                                         "ob_new",
                                         "ob_mode",
                                         "ob_ignore",
                                         "ext_new",
                                         "ext_qw",
                                         "ext_qx",
                                         "ext_qy",
                                         "ext_qz",
                                         "event"};
    for (int k = 0; k < 8; ++k) n.insert(fmt::format("rc{}", k));
    for (int k = 0; k < 10; ++k) n.insert(fmt::format("ob_u{}", k));
    return n;
  }();
  return names.find(column) != names.end() || column.substr(0, 5) == "true_";
}

std::string ReplayRig::output(const std::string& column) const {
  const core::StateMachine& state = firmware_.state();
  const core::CommandVector& command = firmware_.command().combined();
  const auto& estimate = firmware_.estimator().estimate();
  const core::Quaternion& q = estimate.q_WB;
  if (column == "armed") return state.armed() ? "1" : "0";
  if (column == "failsafe") return state.failsafe() ? "1" : "0";
  if (column == "error_codes") return fmt::format("{}", state.errors());
  if (column == "fsm") return state_name(state.state());
  if (column == "rc_override") return fmt::format("{}", firmware_.command().override_word());
  if (column == "ob_active") return firmware_.command().offboard_active() ? "1" : "0";
  if (column == "cmd_types") {
    std::string letters;
    for (std::size_t k = 0; k < 6; ++k) letters += type_letter(command.type[k]);
    return letters;
  }
  const auto at = [&column](std::size_t prefix) {
    return static_cast<std::size_t>(std::stoul(column.substr(prefix)));
  };
  if (column.rfind("cmd_u", 0) == 0) return number(command.value[at(5)]);
  if (column.rfind("ctl", 0) == 0) return number(firmware_.controller().output()[at(3)]);
  if (column.rfind("mix", 0) == 0) return number(firmware_.mixer().mixed()[at(3)]);
  if (column.rfind("out", 0) == 0) return number(board_.outputs.values()[at(3)]);
  if (column[0] == 'q') {
    return number(column[1] == 'w' ? q.w
                                   : (column[1] == 'x' ? q.x : (column[1] == 'y' ? q.y : q.z)));
  }
  const core::Vector3& v =
      column[0] == 'w' ? estimate.rates_rad_s : firmware_.estimator().bias_rad_s();
  return number(v[column[1] - 'x']);
}

}  // namespace rosflight::flight
