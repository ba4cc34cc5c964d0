// SPDX-License-Identifier: BSD-3-Clause
// How good the estimate of the default flights is: errors against the truth, the normalised squared
// errors (NEES) of position, velocity and attitude and of the innovations of each aid (NIS), and how
// often a state is outside its own 3 sigma, over seeded flights. Errors are those of the step in which the estimate
// is used; what is compared with a covariance is that of the estimate's own time. Multirotor: with
// the shipped sensors and with sensors whose noise is the white one that the filter models (its
// biases walk, those of the sensors do not: that leaves the filter a little too careful). Fixed
// wing: shipped sensors, in calm air, in steady wind and in gusts, with the errors of airspeed and wind
// (against the air at the aircraft, gusts included).
//
// usage: estimation [FLIGHTS [KEY=VALUE...]]        (default 100 of each; keys of the vehicle file)
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/constants.hpp"
#include "bench/estimate_error.hpp"
#include "bench/in_parallel.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file
using rosflight::autonomy::estimation::kAids;
using rosflight::autonomy::estimation::log_rotation;
using rosflight::bench::in_sigmas;
using rosflight::bench::kStates;
using rosflight::bench::TruePast;
using rosflight::sim::BodyState;
using rosflight::sim::Vector3;

using rosflight::base::kDegPerRad;

/// Root mean square and the value that 95 of 100 samples stay below.
struct Spread {
  std::vector<double> values;
  double rms() const {
    double sum = 0.0;
    for (const double v : values) sum += v * v;
    return std::sqrt(sum / static_cast<double>(values.size()));
  }
  double p95() {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }
  void add(const Spread& other) {
    values.insert(values.end(), other.values.begin(), other.values.end());
  }
};

/// Mean of what is 1 if the filter has the errors that it reports.
struct Ratio {
  double sum{};
  std::uint64_t count{};
  void add(double value) {
    sum += value;
    ++count;
  }
  void add(const Ratio& other) {
    sum += other.sum;
    count += other.count;
  }
  double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0.0; }
};

struct Errors {
  Spread horizontal_m, vertical_m, velocity_m_s, tilt_deg, heading_deg;
  Spread airspeed_m_s, wind_m_s;                            ///< Fixed wing only.
  Ratio nees, attitude_nees, velocity_nees, position_nees;  ///< Over their degrees of freedom.
  std::array<Ratio, kAids> nis;
  std::array<Ratio, 9> outside;  ///< 3 sigma, of position, velocity, attitude: 1 or 0.
  std::uint64_t unreliable{};    ///< Samples in which the position counted as unreliable.
  std::uint64_t widened{};       ///< Variances widened without need.

  void add(const Errors& other) {
    for (Spread Errors::*spread :
         {&Errors::horizontal_m, &Errors::vertical_m, &Errors::velocity_m_s, &Errors::tilt_deg,
          &Errors::heading_deg, &Errors::airspeed_m_s, &Errors::wind_m_s}) {
      (this->*spread).add(other.*spread);
    }
    for (Ratio Errors::*ratio :
         {&Errors::nees, &Errors::attitude_nees, &Errors::velocity_nees, &Errors::position_nees}) {
      (this->*ratio).add(other.*ratio);
    }
    for (std::size_t k = 0; k < nis.size(); ++k) nis[k].add(other.nis[k]);
    for (std::size_t k = 0; k < outside.size(); ++k) outside[k].add(other.outside[k]);
    unreliable += other.unreliable;
    widened += other.widened;
  }
};

void judge_output(const Flight& flight, const TruePast& past, Errors& errors) {
  const auto estimate = flight.estimate_source().estimate();
  const BodyState& truth = flight.truth().body;
  const Vector3 p = estimate.p_W - flight.seen_position_W();
  const Vector3 turn_W = truth.q_WB * log_rotation(truth.q_WB.conjugate() * estimate.q_WB);
  errors.horizontal_m.values.push_back(p.head<2>().norm());
  errors.vertical_m.values.push_back(std::abs(estimate.p_W.z() - truth.p_W.z()));
  errors.velocity_m_s.values.push_back((estimate.v_W - truth.q_WB * truth.v_B).norm());
  errors.tilt_deg.values.push_back(kDegPerRad * turn_W.head<2>().norm());
  errors.heading_deg.values.push_back(kDegPerRad * std::abs(turn_W.z()));
  errors.unreliable += estimate.position_unreliable ? 1 : 0;
  if (const TruePast::Moment* then = past.at(estimate.t_s)) {
    const auto off = in_sigmas(estimate, *then);
    for (std::size_t k = 0; k < kStates.size(); ++k) {
      errors.outside[k].add(std::abs(off(static_cast<Eigen::Index>(k))) > 3.0 ? 1.0 : 0.0);
    }
  }
  if (!estimate.wind_valid || !estimate.air_valid) return;
  const Vector3& wind_W = flight.truth().air.wind_W;
  const double through_air = (truth.q_WB * truth.v_B - wind_W).norm();
  errors.airspeed_m_s.values.push_back(std::abs(estimate.airspeed_m_s - through_air));
  errors.wind_m_s.values.push_back((estimate.wind_W - wind_W).head<2>().norm());
}

void judge_filter(const Flight& flight, const TruePast& past, Errors& errors) {
  const auto* estimate_source = dynamic_cast<const LinkStateEstimator*>(&flight.estimate_source());
  const auto& estimator = estimate_source->estimator();
  const TruePast::Moment* at = past.at(estimator.filter_time_s());
  if (at == nullptr) return;
  const Vector3 lever_B = estimator.config().imu_position_B;
  const auto& x = estimator.filter().state();
  Eigen::Matrix<double, 9, 1> e;
  e << log_rotation(x.q_WB.conjugate() * at->body.q_WB),
      at->body.q_WB * (at->body.v_B + at->body.w_B.cross(lever_B)) - x.v_W,
      at->seen_W + at->body.q_WB * lever_B - x.p_W;
  const Eigen::Matrix<double, 9, 9> P = estimator.filter().covariance().topLeftCorner<9, 9>();
  errors.nees.add(e.dot(P.ldlt().solve(e)) / 9.0);
  const auto block = [&e, &P](int first) {
    const Vector3 part = e.segment<3>(first);
    const Eigen::Matrix3d of_part = P.block<3, 3>(first, first);
    return part.dot(of_part.ldlt().solve(part)) / 3.0;
  };
  errors.attitude_nees.add(block(0));
  errors.velocity_nees.add(block(3));
  errors.position_nees.add(block(6));
}

/// The innovations since the last step; those of one aid come one at a time.
void judge_innovations(const Flight& flight, std::array<std::uint64_t, kAids>& seen,
                       Errors& errors) {
  const auto& health = flight.estimate_source().health();
  for (std::size_t k = 0; k < kAids; ++k) {
    const std::uint64_t count = health.aids[k].accepted + health.aids[k].rejected;
    if (count != seen[k] && flight.autonomy().tracking) errors.nis[k].add(health.aids[k].nis);
    seen[k] = count;
  }
}

/// One flight.
Errors fly(const FlightChoice& choice) {
  Errors errors;
  const FlightSetup setup(choice);
  const auto flight = std::make_unique<Flight>(setup);
  TruePast past;
  std::array<std::uint64_t, kAids> seen{};
  int step = 0;
  flight->set_script([&](Flight& f, rosflight::sim::Time t) {
    if (f.runner().stage() != Stage::kFly) return;
    past.add(f, t);
    judge_innovations(f, seen, errors);
    constexpr int kEvery = 40;  // ten times a second
    if (!f.autonomy().tracking || ++step % kEvery != 0) return;
    judge_output(f, past, errors);
    judge_filter(f, past, errors);
  });
  flight->run();
  const auto& health = flight->estimate_source().health();
  errors.widened += health.imu_widenings + health.heading_widenings + health.gnss_resets +
                    health.gnss_jumps + health.baro_relearned;
  if (flight->runner().stage() != Stage::kDone) {
    throw std::runtime_error("a flight failed: " + flight->runner().failure());
  }
  return errors;
}

/// Seeds from 1 on, on all processors. The sums are those of one flight after the other.
Errors fly(std::size_t flights, FlightChoice choice, const std::vector<std::string>& overrides) {
  choice.overrides.insert(choice.overrides.end(), overrides.begin(), overrides.end());
  std::vector<Errors> of_flights(flights);
  rosflight::bench::in_parallel(flights, 0, [&] {
    return [&, own = choice](std::size_t k) mutable {
      own.seed = k + 1;
      of_flights[k] = fly(own);
    };
  });
  Errors errors;
  for (const Errors& one : of_flights) errors.add(one);
  return errors;
}

nlohmann::ordered_json json_of(Errors& errors) {
  nlohmann::ordered_json json;
  const auto one = [&json](const std::string& key, Spread& s) {
    json[key + "_rms"] = s.rms();
    json[key + "_p95"] = s.p95();
  };
  one("horizontal_m", errors.horizontal_m);
  one("vertical_m", errors.vertical_m);
  one("velocity_m_s", errors.velocity_m_s);
  one("tilt_deg", errors.tilt_deg);
  one("heading_deg", errors.heading_deg);
  if (!errors.wind_m_s.values.empty()) {
    one("airspeed_m_s", errors.airspeed_m_s);
    one("wind_m_s", errors.wind_m_s);
  }
  json["nees"] = errors.nees.mean();
  json["nees_attitude"] = errors.attitude_nees.mean();
  json["nees_velocity"] = errors.velocity_nees.mean();
  json["nees_position"] = errors.position_nees.mean();
  constexpr std::array<const char*, kAids> kNames{
      "gnss_horizontal", "gnss_altitude", "gnss_velocity", "baro", "heading",     "range",
      "pitot",           "air_force",     "rest",          "pose", "pose_heading"};
  for (std::size_t k = 0; k < kAids; ++k) {
    if (errors.nis[k].count > 0) json[std::string("nis_") + kNames[k]] = errors.nis[k].mean();
  }
  for (std::size_t k = 0; k < kStates.size(); ++k) {
    json[std::string("outside_") + kStates[k]] = errors.outside[k].mean();
  }
  json["unreliable_samples"] = errors.unreliable;
  json["recoveries"] = errors.widened;
  return json;
}

FlightChoice fixedwing_in(const std::optional<std::string>& wind) {
  FlightChoice choice;
  choice.vehicle = "anaconda";
  choice.wind = wind;
  return choice;
}

/// Sensors of the preset `ideal` with the white noise of the filter's configuration on top. The
/// pressure is that at the place the vehicle flies, 1387 m: 10.3 Pa for each metre.
std::vector<std::string> as_modelled() {
  return {
      "sensors.preset=ideal",
      "sensors.imu.gyro_rad_s.noise_density=2.6e-4",
      "sensors.imu.accel_vibration=5.15e-4",  // 0.2 m/s^2 at the 388 rad/s of hover
      "sensors.range.delay_us=20000",
      "sensors.range.range_m.noise_sigma=0.012",
      "sensors.gnss.delay_us=22000",
      "sensors.gnss.horizontal_m.noise_sigma=0.022",
      "sensors.gnss.horizontal_m.drift_sigma=1.7",
      "sensors.gnss.horizontal_m.drift_time_s=1100",
      "sensors.gnss.vertical_m.noise_sigma=0.045",
      "sensors.gnss.vertical_m.drift_sigma=2.55",
      "sensors.gnss.vertical_m.drift_time_s=1100",
      "sensors.gnss.velocity_m_s.noise_sigma=0.051",
      "sensors.baro.pressure_Pa.noise_sigma=0.515",
      "sensors.mag.field_T.noise_sigma=3e-7",
  };
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const long asked = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 100;
    if (asked < 1) throw std::invalid_argument("FLIGHTS is a number from 1");
    const auto flights = static_cast<std::size_t>(asked);
    const std::vector<std::string> keys(argv + std::min(argc, 2), argv + argc);
    FlightChoice modelled;
    modelled.overrides = as_modelled();
    const std::pair<const char*, FlightChoice> rows[]{{"shipped", {}},
                                                      {"modelled", modelled},
                                                      {"fixedwing_calm", fixedwing_in({})},
                                                      {"fixedwing", fixedwing_in("6,270")},
                                                      {"fixedwing_gusts", fixedwing_in("6,270,6")}};
    nlohmann::ordered_json json;
    for (const auto& [name, choice] : rows) {
      Errors errors = fly(flights, choice, keys);
      json[name] = json_of(errors);
    }
    std::cout << json.dump(1) << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "estimation: %s\n", e.what());
    return 1;
  }
}
