// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/test/synthetic_flight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rosflight::report {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGravity_m_s2 = 9.80665;
constexpr double kTakeOff_s = 5.0;
constexpr double kLeg_s = 7.0;
constexpr double kLand_s = 58.0;
constexpr double kEnd_s = 64.0;

using Place = std::array<double, 4>;  // North, east, up, heading.
constexpr std::array<Place, 8> kPlaces{{{0, 0, 0, 0},
                                        {0, 0, 6, 0},
                                        {14, 0, 6, 0},
                                        {14, 12, 8, kPi / 2},
                                        {4, 18, 11, kPi},
                                        {-6, 12, 8, -kPi / 2},
                                        {-6, -4, 6, -kPi / 4},
                                        {0, 0, 6, 0}}};

/// Uniform noise in -1..1, always the same.
class Noise {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 33U) / 1073741824.0 - 1.0;
  }

 private:
  std::uint64_t state_{1};
};

/// Where the setpoint is at t, and how fast it moves.
struct Motion {
  Place place{};
  Place speed{};
  Place acceleration{};
};

Motion motion_at(double t_s) {
  if (t_s >= kLand_s) {  // Straight down.
    const double left = std::max(6.0 - 1.5 * (t_s - kLand_s), 0.0);
    return {{0, 0, left, 0}, {0, 0, left > 0.0 ? -1.5 : 0.0, 0}, {}};
  }
  const double since = std::max(t_s - kTakeOff_s, 0.0);
  const auto leg = std::min(static_cast<std::size_t>(since / kLeg_s), kPlaces.size() - 2);
  const double s = std::min(since / kLeg_s - static_cast<double>(leg), 1.0);
  const double blend = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const double rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / kLeg_s;
  const double bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (kLeg_s * kLeg_s);
  Motion motion;
  for (std::size_t k = 0; k < 4; ++k) {
    double step = kPlaces[leg + 1][k] - kPlaces[leg][k];
    if (k == 3) step = std::remainder(step, 2.0 * kPi);
    motion.place[k] = kPlaces[leg][k] + blend * step;
    motion.speed[k] = rate * step;
    motion.acceleration[k] = bend * step;
  }
  return motion;
}

float single(double x) {
  return static_cast<float>(x);
}

Sample sample_at(double t_s, Noise& noise) {
  constexpr double kLag_s = 0.22;
  const Motion wanted = motion_at(t_s);
  const Motion now = motion_at(t_s - kLag_s);
  const bool flying = t_s > kTakeOff_s && t_s < kLand_s + 4.0;
  const double gust = std::exp(-std::pow((t_s - 33.0) / 1.2, 2.0));
  const double heading = now.place[3];
  const double forward =
      now.acceleration[0] * std::cos(heading) + now.acceleration[1] * std::sin(heading);
  const double right =
      now.acceleration[1] * std::cos(heading) - now.acceleration[0] * std::sin(heading);
  const double wave = 0.012 * std::sin(9.0 * t_s) * (flying ? 1.0 : 0.0);

  Sample s;
  s.t_s = t_s;
  s.p_W_m = {single(now.place[0] + 0.4 * gust), single(now.place[1] - 0.9 * gust),
             single(-now.place[2] - 0.02 * gust)};
  s.v_W_m_s = {single(now.speed[0]), single(now.speed[1] - 0.5 * gust), single(-now.speed[2])};
  const std::array command{right / kGravity_m_s2 + 0.1 * gust, -forward / kGravity_m_s2,
                           std::remainder(wanted.place[3], 2.0 * kPi)};
  const std::array angle{0.94 * command[0] + wave, 0.94 * command[1] - 0.7 * wave,
                         std::remainder(heading, 2.0 * kPi)};
  for (std::size_t k = 0; k < 3; ++k) {
    s.attitude_rad[k] = single(angle[k]);
    s.firmware_rad[k] =
        single(angle[k] + 0.004 * std::sin(0.3 * t_s + static_cast<double>(k)) + 0.001 * noise());
    s.rates_rad_s[k] =
        single((k == 2 ? now.speed[3] : 9.0 * 0.012 * std::cos(9.0 * t_s) * (flying ? 1.0 : 0.0)) +
               0.02 * noise() * (flying ? 1.0 : 0.0));
  }
  if (flying) {
    s.setpoint_W_m = {single(wanted.place[0]), single(wanted.place[1]), single(-wanted.place[2])};
    for (std::size_t k = 0; k < 2; ++k) s.attitude_command_rad[k] = single(command[k]);
    s.attitude_command_rad[2] = single(command[2]);
    s.rate_command_rad_s[2] = single(wanted.speed[3]);
  }
  double total = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double sign_roll = k == 1 || k == 2 ? 1.0 : -1.0;
    const double sign_pitch = k < 2 ? 1.0 : -1.0;
    const double output = flying ? 0.52 + 0.02 * now.acceleration[2] +
                                       0.3 * wave * (sign_roll + sign_pitch) +
                                       0.05 * gust * sign_roll + 0.008 * noise()
                                 : (t_s > 3.0 && t_s < kLand_s + 5.0 ? 0.1 : 0.0);
    s.motors[k] = single(output);
    s.rotors_rad_s[k] = single(620.0 * std::sqrt(output) + 2.0 * noise() * (flying ? 1.0 : 0.0));
    total += output;
  }
  s.estimate.p_W_m = s.p_W_m;
  s.estimate.innovation[0] = single(1.0 + 0.2 * std::sin(t_s));
  for (std::size_t k = 0; k < 3; ++k) {
    const double swing = std::sin(0.4 * t_s + static_cast<double>(k));
    s.estimate.p_error_m[k] = single(0.1 * swing);
    s.estimate.p_sigma_m[k] = single(0.1 + 0.5 * std::exp(-t_s));
    s.estimate.v_error_m_s[k] = single(0.03 * swing);
    s.estimate.v_sigma_m_s[k] = 0.03F;
    s.estimate.turn_error_rad[k] = single(0.005 * swing);
    s.estimate.turn_sigma_rad[k] = 0.004F;
  }
  s.battery_A = single(0.4 + 5.2 * total + 0.2 * noise());
  s.battery_V =
      single(16.6 - 0.012 * t_s - 0.02 * static_cast<double>(s.battery_A) + 0.01 * noise());
  return s;
}

void add_story(FlightRecord& record) {
  record.set_state("Firmware", 0.0, "disarmed", Tone::kNeutral);
  record.set_state("Firmware", 2.9, "armed", Tone::kGood);
  record.set_state("Firmware", 41.0, "failsafe", Tone::kBad);
  record.set_state("Firmware", 42.6, "armed", Tone::kGood);
  record.set_state("Firmware", 63.1, "disarmed", Tone::kNeutral);
  record.set_state("Control", 0.0, "pilot", Tone::kNeutral);
  record.set_state("Control", 4.2, "offboard, angles", Tone::kNote);
  record.set_state("Control", 63.0, "pilot", Tone::kNeutral);
  record.set_state("Override", 0.0, "attitude switch, throttle switch", Tone::kWarning);
  record.set_state("Override", 4.0, "", Tone::kWarning);
  record.set_state("Errors", 0.0, "uncalibrated IMU", Tone::kBad);
  record.set_state("Errors", 1.6, "", Tone::kBad);
  record.set_state("Errors", 41.0, "RC lost", Tone::kBad);
  record.set_state("Errors", 42.6, "", Tone::kBad);
  record.set_state("Autonomy", 0.0, "waiting", Tone::kNeutral);
  record.set_state("Autonomy", kTakeOff_s, "take-off", Tone::kNote);
  record.set_state("Autonomy", kTakeOff_s + kLeg_s, "mission", Tone::kGood);
  record.set_state("Autonomy", kLand_s - 1.0, "hold", Tone::kNote);
  record.set_state("Autonomy", kLand_s, "landing", Tone::kNote);
  record.set_state("Autonomy", 63.0, "landed", Tone::kNeutral);
  record.add_event(0.02, Tone::kNote, "fcu", "Rebooting");
  record.add_event(0.41, Tone::kNote, "companion", "333 parameters received");
  record.add_event(1.62, Tone::kNote, "fcu", "IMU offsets captured");
  record.add_event(2.90, Tone::kGood, "companion", "armed");
  record.add_event(41.0, Tone::kBad, "fcu", "RC lost: failsafe");
  record.add_event(42.6, Tone::kGood, "fcu", "RC is back");
  record.add_event(47.3, Tone::kWarning, "autonomy",
                   "waypoint 5 missed by 1.32 m (tolerance 1.00 m)");
  record.add_event(63.1, Tone::kGood, "companion", "disarmed");
}

void add_facts(FlightRecord& record) {
  record.estimated = true;
  record.route = {{0, 0, -6}, {14, 0, -6}};
  record.title = "Quadrotor, six waypoints";
  record.vehicle = "quadrotor";
  record.mission = "missions/demo.yaml";
  record.seed = "42";
  record.command_line =
      "./rosflight fly --vehicle quadrotor --mission missions/demo.yaml --seed 42 --fault "
      "rc@41:1.6";
  record.success = true;
  record.verdict = "Landed 0.08 m from the start and disarmed; 6 of 7 waypoints reached.";
  record.facts = {
      {"Flight time", "58.0", "s", true, Tone::kNeutral},
      {"Waypoints", "6 / 7", "", true, Tone::kWarning},
      {"Tracking rms", "0.31", "m", true, Tone::kNeutral},
      {"Tracking max", "1.42", "m", true, Tone::kNeutral},
      {"Path flown", "86.4", "m", true, Tone::kNeutral},
      {"Battery used", "0.21", "Ah", true, Tone::kNeutral},
      {"Faults", "1", "", true, Tone::kBad},
      {"Against real time", "612", "×", true, Tone::kNeutral},
      {"Simulated time", "64.00", "s", false, Tone::kNeutral},
      {"Wind", "2 m/s from the west, light turbulence", "", false, Tone::kNeutral},
      {"State for guidance", "truth", "", false, Tone::kNeutral},
      {"Log",
       "flight.mcap, sha256 3f79bb7b435b05321651daefd374cdc681dc06faa65e374e38337b88ca046dea", "",
       false, Tone::kNeutral}};
  for (std::size_t k = 1; k < kPlaces.size(); ++k) {
    Waypoint waypoint;
    waypoint.p_W_m = {kPlaces[k][0], kPlaces[k][1], -kPlaces[k][2]};
    waypoint.heading_rad = kPlaces[k][3];
    waypoint.hold_s = k == 4 ? 2.0 : 0.0;
    const bool missed = k == 5;
    if (!missed) waypoint.reached_s = kTakeOff_s + kLeg_s * static_cast<double>(k) - 0.4;
    waypoint.truth_m = missed ? 2.32 : 0.35 + 0.02 * static_cast<double>(k);
    waypoint.estimate_m = 0.05 + 0.02 * static_cast<double>(k);
    if (k == 2) waypoint.measure = "fly-by";
    record.waypoints.push_back(waypoint);
  }
  record.faults = {{"RC silent", 41.0, 42.6}};
  record.changed_parameters = {{"PRIMARY_MIXER", "255", "2", ""},
                               {"PID_ROLL_RATE_P", "0.070", "0.092", "N m s/rad"},
                               {"BATT_VOLT_MAX", "25.0", "16.8", "V"}};
  record.counters = link::Counters{};
  record.counters->longest_pass_us = 431;
  record.counters->pass_budget_us = 2000;
  record.counters->imu_jitter = {25000, 6};
  record.counters->rejected = {0, 3};
  record.jitter_names = {"below 10 µs", "10 to 30 µs"};
  record.rejected_names = {"IMU: not a number", "IMU: stuck"};
  for (int k = 1; k <= 128; ++k) {
    record.gyro.frequency_Hz.push_back(1.5625 * k);
    record.gyro.before.push_back(1e-3 * (1.0 + 1.0 / k));
    record.gyro.after.push_back(1e-3 / k);
  }
  record.gyro.latency_s = 0.00107;
  record.files = {"flight.mcap", "parameters.yaml", "mission.yaml", "vehicle.yaml", "summary.json"};
}

}  // namespace

FlightRecord synthetic_flight(double interval_s) {
  FlightRecord record(0.0);
  Noise noise;
  const auto count = static_cast<int>(kEnd_s / interval_s);
  for (int k = 0; k <= count; ++k) record.add(sample_at(k * interval_s, noise));
  add_story(record);
  add_facts(record);
  return record;
}

}  // namespace rosflight::report
