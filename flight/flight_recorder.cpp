// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "firmware/core/pass_counters.hpp"
#include "flight/link_protocol.hpp"
#include "flight/vehicle_urdf.hpp"
#include "messages/link.hpp"

namespace rosflight::flight {
namespace {

using report::Tone;

/// Larger chunks compress better.
constexpr std::size_t kFullChunk_bytes = std::size_t{2} << 20U;

report::Vec3 to_vec3(const sim::Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

report::Vec3 euler(const sim::Quaternion& q) {
  const std::array<double, 3> e =
      messages::euler_angles({static_cast<float>(q.w()), static_cast<float>(q.x()),
                              static_cast<float>(q.y()), static_cast<float>(q.z())});
  return {static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2])};
}

Tone tone_of(link::Severity severity) {
  switch (severity) {
    case link::Severity::kCritical:
    case link::Severity::kError:
      return Tone::kBad;
    case link::Severity::kWarning:
      return Tone::kWarning;
    default:
      return Tone::kNote;
  }
}

std::string error_names(std::uint16_t errors) {
  struct Name {
    core::Error bit;
    const char* text;
  };
  constexpr std::array<Name, 8> kNames{{{core::Error::kInvalidMixer, "mixer"},
                                        {core::Error::kImuNotResponding, "IMU silent"},
                                        {core::Error::kRcLost, "RC lost"},
                                        {core::Error::kUnhealthyEstimator, "estimator"},
                                        {core::Error::kTimeGoingBackwards, "time"},
                                        {core::Error::kUncalibratedImu, "uncalibrated"},
                                        {core::Error::kBufferOverrun, "buffer"},
                                        {core::Error::kInvalidFailsafe, "failsafe throttle"}}};
  std::string text;
  for (const Name& name : kNames) {
    if ((errors & static_cast<std::uint16_t>(name.bit)) == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string{name.text};
  }
  return text;
}

/// Bins of the firmware's histograms, for people.
void name_counters(report::FlightRecord& record) {
  const auto& ends_us = core::PassCounters::kJitterEnds_us;
  record.jitter_names.push_back(fmt::format("below {} µs", ends_us.front()));
  for (std::size_t k = 1; k < ends_us.size(); ++k) {
    record.jitter_names.push_back(fmt::format("{} to {} µs", ends_us[k - 1], ends_us[k]));
  }
  record.jitter_names.push_back(fmt::format("{} µs and more", ends_us.back()));
  record.rejected_names = {"not a number, or no measurement", "IMU: stamp went back",
                           "IMU: stamp far from its arrival", "IMU: stuck",
                           "pressure out of range",           "other sensor out of range",
                           "external attitude rejected",      "gyro clipped, used"};
}

}  // namespace

FlightRecorder::FlightRecorder(Flight& flight, const std::filesystem::path& log_file,
                               LogLevel level, log::LogObserver* observer)
    : flight_{flight},
      from_board_{make_board_codec(flight.setup().choice.link_protocol)},
      from_companion_{make_board_codec(flight.setup().choice.link_protocol)} {
  const FlightSetup& setup = flight.setup();
  if (level != LogLevel::kNone) open_log(log_file, level, observer);
  record_.motor_count = setup.rotors.rotors.size();
  record_.estimated = setup.choice.state != "truth";
  record_.fixed_wing = setup.fixed_wing();
  for (const ShownWaypoint& waypoint : setup.waypoints) {
    report::Waypoint shown;
    shown.p_W_m = {waypoint.p_W.x(), waypoint.p_W.y(), waypoint.p_W.z()};
    shown.heading_rad = waypoint.heading_rad;
    shown.hold_s = waypoint.hold_s;
    record_.waypoints.push_back(shown);
    const bool elsewhere = record_.route.empty() || record_.route.back() != shown.p_W_m;
    if (!record_.fixed_wing && elsewhere) record_.route.push_back(shown.p_W_m);
  }
  name_counters(record_);
  if (record_.route.size() == 1) record_.route.clear();  // a single point is no route
  if (log_ && !record_.route.empty()) log_->write_path({}, record_.route);
  flight.set_tap(this);
  flight.add(*this);
}

void FlightRecorder::open_log(const std::filesystem::path& file, LogLevel level,
                              log::LogObserver* observer) {
  const FlightSetup& setup = flight_.setup();
  log::FlightLog::Options options;
  options.detail = level == LogLevel::kFull ? log::Detail::kFull : log::Detail::kPlot;
  logs_inputs_ = setup.choice.board == "in_process";  // an emulated one shows the bytes alone
  if (level == LogLevel::kPlot) {
    options.mcap.compression = log::Compression::kZstdFast;
  } else {
    options.mcap.chunk_bytes = kFullChunk_bytes;
  }
  options.observer = observer;
  options.gravity_m_s2 = setup.vehicle.environment().gravity_m_s2;
  options.epoch_ns =
      static_cast<std::uint64_t>(setup.vehicle.environment().start_unix_s) * 1'000'000'000U;
  const log::TextMap facts{{"vehicle", std::filesystem::path(setup.choice.vehicle).stem().string()},
                           {"mission", std::filesystem::path(setup.mission_file).stem().string()},
                           {"seed", std::to_string(setup.choice.seed)},
                           {"state", setup.choice.state},
                           {"link_protocol", setup.choice.link_protocol},
                           {"faults", fmt::format("{}", fmt::join(setup.choice.faults, " "))}};
  log_ = std::make_unique<log::FlightLog>(file, options, facts);
  log_->attach("vehicle.yaml", "application/yaml", setup.vehicle.text());
  log_->attach("mission.yaml", "application/yaml", setup.mission_text);
  log_->write_description({}, vehicle_urdf(setup));
}

void FlightRecorder::on_frame(Direction direction, hal::Time t, const std::uint8_t* data,
                              std::size_t size, bool taken) {
  if (!taken) ++dropped_;
  const bool down = direction == Direction::kToCompanion;
  if (down && flight_.autopilot().boot_time() != boot_) {
    boot_ = flight_.autopilot().boot_time();
    if (log_) log_->set_fcu_boot(boot_);
  }
  link::Codec& codec = down ? *from_board_ : *from_companion_;
  const link::Codec::Decoded decoded = codec.decode(data, size);
  if (down && decoded.complete) {
    follow_gyro(codec.message());
    if (const auto* counters = std::get_if<link::Counters>(&codec.message())) {
      record_.counters = *counters;
    }
  }
  if (!log_) return;
  log_->write_link(down ? log::Direction::kFcuToCompanion : log::Direction::kCompanionToFcu, t,
                   decoded.complete ? codec.message() : link::Message{}, {data, size});
}

/// Only in the air: what the motors do to the gyro is what its filters are for.
void FlightRecorder::follow_gyro(const link::Message& message) {
  const bool in_air = flight_.runner().stage() == Stage::kFly && flight_.autonomy().in_air;
  const auto* attitude = std::get_if<link::Attitude>(&message);
  const std::optional<hal::ImuSample>& imu = flight_.imu();
  if (!in_air || attitude == nullptr || !imu) return;
  hal::ImuSample sample = *imu;
  sample.stamp -= flight_.autopilot().boot_time();
  gyro_.sent(sample);
  gyro_.received(*attitude);
}

void FlightRecorder::note(const FlightNote& note) {
  // Before its parameters are loaded the firmware warns about what is not set yet.
  const bool in_flight = flight_.runner().stage() >= Stage::kFly;
  if (in_flight && note.severity == link::Severity::kWarning) ++warnings_;
  if (in_flight && note.severity < link::Severity::kWarning) ++errors_;
  record_.add_event(sim::to_seconds(note.t), tone_of(note.severity), note.source, note.text);
  if (log_ && note.source != "fcu") {
    log_->write_event(note.t, note.severity, note.source, note.text);
  }
}

void FlightRecorder::log_autonomy(sim::Time t) {
  if (flight_.runner().stage() != Stage::kFly) return;
  const GuidanceOutput& output = flight_.autonomy();
  if (output.phase != last_phase_) {
    last_phase_ = output.phase;
    if (log_) log_->write_phase(t, output.phase);
    if (const auto* wing = dynamic_cast<const FixedWingGuidance*>(&flight_.guidance())) {
      add_route(t, wing->manager());
    }
  }
  constexpr double kInterval_s = 0.0099;  // autonomy runs at 100 Hz
  if (!log_ || sim::to_seconds(t) - last_setpoint_s_ < kInterval_s) return;
  last_setpoint_s_ = sim::to_seconds(t);
  const autonomy::multirotor::Trajectory& s = output.setpoint;
  log_->write_setpoint(t, {{},
                           to_vec3(s.p_W),
                           to_vec3(s.v_W),
                           to_vec3(s.a_W),
                           static_cast<float>(s.psi_rad),
                           static_cast<float>(s.psi_dot_rad_s),
                           static_cast<float>(s.psi_ddot_rad_s2)});
}

/// All parameters of the firmware, once, as the vehicle is about to arm. Later changes are in the log as
/// messages of the link.
void FlightRecorder::log_parameters(sim::Time t) {
  if (!log_ || parameters_logged_ || flight_.runner().stage() < Stage::kArm) return;
  parameters_logged_ = true;
  for (const companion::NamedValue& entry : flight_.session().parameters().table().values())
    log_->write_parameter(t, entry.name, entry.value.type, entry.value.bits);
}

void FlightRecorder::step(const sim::Truth& truth, const hal::OutputValues& outputs) {
  if (log_) log_->write_truth(truth, outputs);
  log_parameters(truth.time);
  log_autonomy(truth.time);
  if (record_.wants(sim::to_seconds(truth.time))) add_sample(truth, outputs);
  follow_states(sim::to_seconds(truth.time));
}

/// The path as it is planned from here on.
void FlightRecorder::add_route(sim::Time t, const autonomy::fixedwing::FlightManager& manager) {
  if (!manager.path().started()) return;
  constexpr double kEvery_m = 5.0;
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  if (!record_.route.empty()) record_.route.push_back({kGap, kGap, kGap});
  const std::size_t start = record_.route.size();
  for (const autonomy::fixedwing::Segment& segment : manager.path().plan().segments) {
    const double turn_m = 2.0 * base::kPi * std::abs(segment.radius_m);
    const double length_m = std::isfinite(segment.length_m) ? segment.length_m : turn_m;
    const int pieces = segment.straight() ? 1 : 1 + static_cast<int>(length_m / kEvery_m);
    for (int k = 0; k <= pieces; ++k) {
      const double s_m = length_m * k / pieces;
      const auto p = segment.point_at(s_m);
      record_.route.push_back({p.x(), p.y(), -segment.height_at(s_m)});
    }
  }
  if (log_) log_->write_path(t, std::span(record_.route).subspan(start));
}

void FlightRecorder::add_estimate(const sim::Truth& truth, report::Sample& sample) {
  const StateEstimateSource& source = flight_.estimate_source();
  if (!record_.estimated || !source.health().initialised) return;
  estimate_ = source.estimate();
  if (log_) log_->write_estimate(truth.time, logged(estimate_, source.health()));
  estimates_.follow(record_, sample.t_s, estimate_, source.health());
  sample.estimate = estimates_.sample(estimate_, source.health(), truth, flight_.seen_position_W());
}

void FlightRecorder::add_sample(const sim::Truth& truth, const hal::OutputValues& outputs) {
  report::Sample sample;
  sample.t_s = sim::to_seconds(truth.time);
  sample.p_W_m = to_vec3(truth.body.p_W);
  sample.v_W_m_s = to_vec3(truth.body.q_WB * truth.body.v_B);
  sample.attitude_rad = euler(truth.body.q_WB);
  sample.rates_rad_s = to_vec3(truth.body.w_B);
  const FirmwareView firmware = flight_.autopilot().view();
  sample.firmware_rad = {firmware.roll_rad, firmware.pitch_rad, core::yaw_of(firmware.q_WB)};
  if (firmware.armed) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (firmware.command_type[3 + k] == core::CommandType::kAngle) {
        sample.attitude_command_rad[k] = firmware.command[3 + k];
      } else if (firmware.command_type[3 + k] == core::CommandType::kRate) {
        sample.rate_command_rad_s[k] = firmware.command[3 + k];
      }
    }
  }
  const GuidanceOutput& output = flight_.autonomy();
  if (flight_.runner().stage() == Stage::kFly && output.tracking) {
    sample.setpoint_W_m = to_vec3(output.setpoint.p_W);
  }
  for (std::size_t k = 0; k < std::min(record_.motor_count, report::kMaxMotors); ++k) {
    sample.motors[k] = outputs[flight_.setup().rotors.rotors[k].output];
  }
  for (std::size_t k = 0; k < std::min(truth.rotor_count, report::kMaxMotors); ++k) {
    sample.rotors_rad_s[k] = static_cast<float>(truth.rotor_speed_rad_s[k]);
  }
  sample.battery_V = static_cast<float>(truth.battery_voltage_V);
  sample.battery_A = static_cast<float>(truth.battery_current_A);
  add_estimate(truth, sample);
  if (const auto* wing = dynamic_cast<const FixedWingGuidance*>(&flight_.guidance())) {
    sample.wing = fixedwing_sample(wing->details(), truth, flight_.seen_position_W());
  }
  record_.add(sample);
}

void FlightRecorder::follow_states(double t_s) {
  const FirmwareView firmware = flight_.autopilot().view();
  const Stage stage = flight_.runner().stage();
  const States states{firmware.state,          firmware.armed,        firmware.failsafe,
                      firmware.errors,         firmware.primary_axes, stage,
                      flight_.autonomy().phase};
  if (states_ == states) return;
  states_ = states;
  const bool armed = firmware.armed;
  if (firmware.failsafe) {
    record_.set_state("firmware", t_s, "failsafe", Tone::kBad);
  } else if (firmware.state == core::State::kCalibrating) {
    record_.set_state("firmware", t_s, "calibrating", Tone::kNote);
  } else {
    record_.set_state("firmware", t_s, armed ? "armed" : "disarmed",
                      armed ? Tone::kGood : Tone::kNeutral);
  }
  record_.set_state("errors", t_s, error_names(firmware.errors), Tone::kBad);
  const std::uint16_t primary = firmware.primary_axes & 0x3FU;
  const char* who = primary == 0 ? "companion" : (primary == 0x3F ? "pilot" : "shared");
  record_.set_state("control", t_s, armed ? (firmware.failsafe ? "failsafe" : who) : "",
                    primary == 0 ? Tone::kGood : Tone::kWarning);
  const bool flying = stage == Stage::kFly;
  record_.set_state("autonomy", t_s, flying ? flight_.autonomy().phase : stage_name(stage),
                    flying ? Tone::kGood : Tone::kNeutral);
}

std::optional<log::LogSummary> FlightRecorder::close() {
  flight_.set_tap(nullptr);
  record_.gyro = gyro_.spectrum();
  if (!log_) return std::nullopt;
  return log_->close();
}

}  // namespace rosflight::flight
