// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_recorder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/constants.hpp"
#include "flight/link_protocol.hpp"
#include "flight/logged_estimate.hpp"
#include "flight/vehicle_urdf.hpp"
#include "messages/link.hpp"

namespace rosflight::flight {
namespace {

/// Larger chunks compress better.
constexpr std::size_t kFullChunk_bytes = std::size_t{2} << 20U;
/// Steps of simulated time are sums; a moment a hair early is still due.
constexpr double kEarly = 0.999;

std::array<float, 3> to_vec3(const sim::Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace

log::TextMap log_facts(const FlightSetup& setup) {
  log::TextMap facts{{"vehicle", std::filesystem::path(setup.choice.vehicle).stem().string()},
                     {"mission", std::filesystem::path(setup.mission_file).stem().string()},
                     {"seed", std::to_string(setup.choice.seed)},
                     {"state", setup.choice.state},
                     {"link_protocol", setup.choice.link_protocol},
                     {"faults", fmt::format("{}", fmt::join(setup.choice.faults, " "))},
                     {"vehicle_argument", setup.choice.vehicle},
                     {"mission_argument", setup.choice.mission},
                     {"pilot", setup.choice.pilot},
                     {"wind", setup.choice.wind.value_or("")},
                     {"overrides", fmt::format("{}", fmt::join(setup.choice.overrides, "\n"))},
                     {"plugins", fmt::format("{}", fmt::join(setup.choice.plugins, "\n"))}};
  // Only where it says something, so that logs of before stay equal to the bit.
  if (setup.choice.physics != FlightChoice{}.physics) facts["physics"] = setup.choice.physics;
  if (!setup.choice.world.empty()) facts["world"] = setup.choice.world;
  return facts;
}

FlightRecorder::FlightRecorder(Flight& flight, const std::filesystem::path& log_file,
                               LogLevel level, std::vector<log::LogObserver*> observers)
    : flight_{flight},
      from_board_{make_board_codec(flight.setup().choice.link_protocol)},
      from_companion_{make_board_codec(flight.setup().choice.link_protocol)} {
  if (level != LogLevel::kNone) open_log(log_file, level, std::move(observers));
  log_route();
  flight.set_tap(this);
  flight.add(*this);
}

/// The waypoints of a multirotor; a fixed wing's path is planned as it flies.
void FlightRecorder::log_route() {
  const FlightSetup& setup = flight_.setup();
  if (!log_ || setup.fixed_wing()) return;
  std::vector<std::array<double, 3>> route;
  for (const ShownWaypoint& waypoint : setup.waypoints) {
    const std::array<double, 3> p_W{waypoint.p_W.x(), waypoint.p_W.y(), waypoint.p_W.z()};
    if (route.empty() || route.back() != p_W) route.push_back(p_W);
  }
  if (route.size() > 1) log_->write_path({}, route);  // a single point is no route
}

void FlightRecorder::open_log(const std::filesystem::path& file, LogLevel level,
                              std::vector<log::LogObserver*> observers) {
  const FlightSetup& setup = flight_.setup();
  log::FlightLog::Options options;
  options.detail = level == LogLevel::kFull ? log::Detail::kFull : log::Detail::kPlot;
  logs_inputs_ = setup.choice.board == "in_process";  // an emulated one shows the bytes alone
  if (level == LogLevel::kPlot) {
    options.mcap.compression = log::Compression::kZstdFast;
  } else {
    options.mcap.chunk_bytes = kFullChunk_bytes;
  }
  options.observers = std::move(observers);
  options.gravity_m_s2 = setup.vehicle.environment().gravity_m_s2;
  options.epoch_ns =
      static_cast<std::uint64_t>(setup.vehicle.environment().start_unix_s) * 1'000'000'000U;
  log::TextMap facts = log_facts(setup);
  facts["log"] = level == LogLevel::kFull ? "full" : "plot";
  if (!setup.choice.world.empty()) facts["world_sha256"] = flight_.world_sha256();
  log_ = std::make_unique<log::FlightLog>(file, options, facts);
  log_->attach("vehicle.yaml", "application/yaml", setup.vehicle.text());
  log_->attach("mission.yaml", "application/yaml", setup.mission_text);
  if (!setup.choice.world.empty())
    log_->attach("world.sdf", "application/xml", read_text(setup.choice.world));
  log_->write_description({}, vehicle_urdf(setup));
  log_world_sensors();
}

void FlightRecorder::log_world_sensors() {
  const sim::WorldSensors& sensors = flight_.world_sensors();
  if (sensors.empty()) return;
  const sim::Vector3& centre_B = flight_.setup().vehicle.body().centre_of_mass_B;
  for (const sim::WorldSensors::Entry& entry : sensors.entries()) {
    const sim::Mounting* mounting = entry.sensor->mounting();
    if (mounting == nullptr) continue;
    log_->write_sensor_frames({}, entry.name, mounting->position_m - centre_B,
                              sim::R_BS(*mounting));
  }
  flight_.set_world_receiver(
      [this](sim::Time t, const std::string& name, const sim::WorldSample& sample) {
        log_->write_world_sample(t, name, sample);
      });
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
      counters_ = *counters;
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
    if (const auto* fixedwing = dynamic_cast<const FixedWingGuidance*>(&flight_.guidance())) {
      add_route(t, fixedwing->manager());
    }
  }
  constexpr double kInterval_s = 0.0099;  // autonomy runs at 100 Hz
  if (!log_ || !output.on_path || sim::to_seconds(t) - last_setpoint_s_ < kInterval_s) return;
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

void FlightRecorder::log_settings(sim::Time t) {
  if (!log_ || flight_.vehicle_text() == logged_settings_) return;
  logged_settings_ = flight_.vehicle_text();
  log_->write_settings(t, logged_settings_);
}

void FlightRecorder::step(const sim::Truth& truth, const hal::OutputValues& outputs) {
  if (log_) log_->write_truth(truth, outputs);
  log_settings(truth.time);
  log_parameters(truth.time);
  log_autonomy(truth.time);
  log_estimate(truth);
  const double since_s = analysis_.moments.empty()
                             ? FlightAnalysis::kInterval_s
                             : sim::to_seconds(truth.time) - analysis_.moments.back().t_s;
  if (since_s >= kEarly * FlightAnalysis::kInterval_s)
    analysis_.moments.push_back(analysis_moment(flight_, truth));
}

/// The path as it is planned from here on.
void FlightRecorder::add_route(sim::Time t, const autonomy::fixedwing::FlightManager& manager) {
  if (!log_ || !manager.path().started()) return;
  constexpr double kEvery_m = 5.0;
  std::vector<std::array<double, 3>> route;
  for (const autonomy::fixedwing::Segment& segment : manager.path().plan().segments) {
    const double turn_m = 2.0 * base::kPi * std::abs(segment.radius_m);
    const double length_m = std::isfinite(segment.length_m) ? segment.length_m : turn_m;
    const int pieces = segment.straight() ? 1 : 1 + static_cast<int>(length_m / kEvery_m);
    for (int k = 0; k <= pieces; ++k) {
      const double s_m = length_m * k / pieces;
      const auto p = segment.point_at(s_m);
      route.push_back({p.x(), p.y(), -segment.height_at(s_m)});
    }
  }
  log_->write_path(t, route);
}

/// A hundred times a second, as autonomy runs.
void FlightRecorder::log_estimate(const sim::Truth& truth) {
  constexpr double kInterval_s = 0.01;
  const double t_s = sim::to_seconds(truth.time);
  if (t_s - last_estimate_s_ < kEarly * kInterval_s) return;
  last_estimate_s_ = t_s;
  const StateEstimateSource& source = flight_.estimate_source();
  const bool estimated = flight_.setup().choice.state != "truth";
  if (!log_ || !estimated || !source.health().initialised) return;
  log_->write_estimate(truth.time, logged(source.estimate(), source.health()));
}

std::optional<log::LogSummary> FlightRecorder::close() {
  flight_.set_tap(nullptr);
  flight_.set_world_receiver({});
  analysis_.gyro = gyro_.spectrum();
  if (!log_) return std::nullopt;
  return log_->close();
}

}  // namespace rosflight::flight
