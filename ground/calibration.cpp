// SPDX-License-Identifier: BSD-3-Clause
#include "ground/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

#include "base/constants.hpp"
#include "companion/mag_calibration.hpp"

namespace rosflight::ground {
namespace {

using companion::NamedValue;
using companion::ParameterSet;
using Figures = std::vector<Figure>;

constexpr Time kMeasuring = std::chrono::milliseconds{1500};
constexpr Time kSettling = std::chrono::milliseconds{200};

// At rest. Gyros on boards have 0.01 rad/s of noise at most; the firmware accepts a spread of 0.3 rad/s
// over 1001 samples, some six standard deviations.
constexpr double kMaxGyroDeviation_rad_s = 0.05;
constexpr double kMaxGyroOffset_rad_s = 0.01;
// The firmware accepts a spread of 1 m/s^2 and a tilt of 5 deg.
constexpr double kMaxAccelDeviation_m_s2 = 0.15;
constexpr double kMaxTilt_deg = 5.0;
constexpr double kMaxTiltAfter_deg = 0.5;
constexpr double kMaxGravityError_m_s2 = 0.1;
constexpr double kMaxPressureDeviation_Pa = 5.0;       // as the firmware: 0.4 m
constexpr double kMaxDiffPressureDeviation_Pa = 10.0;  // likewise: 4 m/s
constexpr double kMaxDiffPressureOffset_Pa = 2.0;

/// Adds up what arrives while it lives.
class SensorRecorder final : public companion::Listener {
 public:
  explicit SensorRecorder(Session& session) : session_(session) { session_.add(*this); }
  ~SensorRecorder() override { session_.remove(*this); }
  SensorRecorder(const SensorRecorder&) = delete;
  SensorRecorder& operator=(const SensorRecorder&) = delete;

  void on_imu(const link::Imu& imu, const companion::Stamp& /*stamp*/) override {
    for (std::size_t i = 0; i < 3; ++i) {
      statistics.gyro_rad_s[i].add(static_cast<double>(imu.gyro_rad_s[i]));
      statistics.accel_m_s2[i].add(static_cast<double>(imu.accel_m_s2[i]));
    }
  }
  void on_baro(const link::Baro& baro, const companion::Stamp& /*stamp*/) override {
    statistics.pressure_Pa.add(static_cast<double>(baro.pressure_Pa));
  }
  void on_diff_pressure(const link::DiffPressure& m, const companion::Stamp& /*stamp*/) override {
    statistics.diff_pressure_Pa.add(static_cast<double>(m.pressure_Pa));
  }

  SensorStatistics statistics;

 private:
  Session& session_;
};

double largest_deviation(const std::array<Statistics, 3>& axes) {
  return std::max({axes[0].deviation(), axes[1].deviation(), axes[2].deviation()});
}

double norm(const std::array<double, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

std::array<double, 3> mean(const std::array<Statistics, 3>& axes) {
  return {axes[0].mean(), axes[1].mean(), axes[2].mean()};
}

/// What differs between the sensors.
struct Sensor {
  const char* name;
  link::Command command;
  std::vector<std::string> parameters;
  std::function<std::size_t(const SensorStatistics&)> samples;
  /// @param values  of `parameters`.
  std::function<Figures(const SensorStatistics&, const std::vector<double>& values, bool after)>
      figures;
  std::string advice;
};

SensorStatistics measure(GroundLink& link, const Sensor& sensor) {
  const SensorRecorder recorder(link.session());
  link.run_for(kMeasuring);
  if (sensor.samples(recorder.statistics) < 2) {
    throw NoAnswer(fmt::format("{}: no samples from {} within {:g} s", sensor.name, link.name(),
                               companion::to_seconds(kMeasuring)));
  }
  return recorder.statistics;
}

std::vector<double> numbers(const ParameterSet& set) {
  std::vector<double> values;
  for (const NamedValue& entry : set) values.push_back(entry.value.number());
  return values;
}

void say_figures(const char* name, const char* when, const Figures& figures, std::ostream& out) {
  for (const Figure& figure : figures)
    say(out, fmt::format("{} {}: {}", name, when, figure.text()));
}

int refuse(const Sensor& sensor, const Figure& figure, const std::string& consequence,
           std::ostream& out) {
  say(out, fmt::format("{} calibration refused: {}; {}; {}", sensor.name, figure.text(),
                       sensor.advice, consequence));
  return 1;
}

int calibrate_sensor(GroundLink& link, const Sensor& sensor, bool write, std::ostream& out) {
  Session& session = link.session();
  const bool armed = link.streams().status.value.armed;
  const ParameterSet before = read_values(link, sensor.parameters);
  if (!armed) {  // otherwise the vehicle says why it refuses
    const Figures figures = sensor.figures(measure(link, sensor), numbers(before), false);
    say_figures(sensor.name, "before", figures, out);
    if (const Figure* bad = first_bad(figures)) return refuse(sensor, *bad, "nothing changed", out);
  }
  const auto job = session.commands().start(sensor.command);
  link.wait(job);
  say(out, job.text());
  if (job.failed()) return 1;
  link.run_for(kSettling);
  const ParameterSet now = read_values(link, sensor.parameters);
  const Figures figures = sensor.figures(measure(link, sensor), numbers(now), true);
  say_figures(sensor.name, "after", figures, out);
  for (const auto& d : companion::diff(before, now)) say(out, d.text());
  if (const Figure* bad = first_bad(figures)) {
    const auto restored = session.parameters().load(before);
    link.finish(restored);
    return refuse(sensor, *bad, restored.done() ? "former values put back" : restored.text(), out);
  }
  return store_calibration(link, write, out);
}

}  // namespace

std::string Figure::text() const {
  return fmt::format("{} {:.3g} {}, limit {:g} {}", name, value, unit, limit, unit);
}

std::vector<Figure> gyro_figures(const SensorStatistics& s, bool after) {
  Figures figures{
      {"standard deviation", largest_deviation(s.gyro_rad_s), kMaxGyroDeviation_rad_s, "rad/s"}};
  if (after)
    figures.push_back({"offset left", norm(mean(s.gyro_rad_s)), kMaxGyroOffset_rad_s, "rad/s"});
  return figures;
}

std::vector<Figure> accel_figures(const SensorStatistics& s,
                                  const std::array<double, 3>& offset_m_s2, bool after) {
  std::array<double, 3> force = mean(s.accel_m_s2);
  if (!after) {  // the tilt that the vehicle will measure: without its offset
    for (std::size_t i = 0; i < 3; ++i) force[i] += offset_m_s2[i];
  }
  const double tilt_deg = base::kDegPerRad * std::atan2(std::hypot(force[0], force[1]), -force[2]);
  Figures figures{
      {"standard deviation", largest_deviation(s.accel_m_s2), kMaxAccelDeviation_m_s2, "m/s^2"},
      {"tilt", tilt_deg, after ? kMaxTiltAfter_deg : kMaxTilt_deg, "deg"}};
  if (after) {
    figures.push_back({"residual against g", norm(force) - base::kStandardGravity_m_s2,
                       kMaxGravityError_m_s2, "m/s^2"});
  }
  return figures;
}

std::vector<Figure> baro_figures(const SensorStatistics& s) {
  return {{"noise", s.pressure_Pa.deviation(), kMaxPressureDeviation_Pa, "Pa"}};
}

std::vector<Figure> airspeed_figures(const SensorStatistics& s, bool after) {
  Figures figures{{"noise", s.diff_pressure_Pa.deviation(), kMaxDiffPressureDeviation_Pa, "Pa"}};
  if (after)
    figures.push_back({"offset left", s.diff_pressure_Pa.mean(), kMaxDiffPressureOffset_Pa, "Pa"});
  return figures;
}

int calibrate_gyro(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  const Sensor sensor{"gyro",
                      link::Command::kGyroCalibration,
                      {"GYRO_X_BIAS", "GYRO_Y_BIAS", "GYRO_Z_BIAS"},
                      [](const SensorStatistics& s) { return s.gyro_rad_s[0].count(); },
                      [](const SensorStatistics& s, const std::vector<double>&, bool after) {
                        return gyro_figures(s, after);
                      },
                      "keep the vehicle still"};
  return calibrate_sensor(link, sensor, options.write, out);
}

int calibrate_accel(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  const Sensor sensor{"accel",
                      link::Command::kAccelCalibration,
                      {"ACC_X_BIAS", "ACC_Y_BIAS", "ACC_Z_BIAS"},
                      [](const SensorStatistics& s) { return s.accel_m_s2[0].count(); },
                      [](const SensorStatistics& s, const std::vector<double>& offset, bool after) {
                        return accel_figures(s, {offset[0], offset[1], offset[2]}, after);
                      },
                      "put the vehicle level and keep it still"};
  return calibrate_sensor(link, sensor, options.write, out);
}

int calibrate_baro(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  const Sensor sensor{
      "baro",
      link::Command::kBaroCalibration,
      {"BARO_BIAS", "GROUND_LEVEL"},
      [](const SensorStatistics& s) { return s.pressure_Pa.count(); },
      [](const SensorStatistics& s, const std::vector<double>&, bool) { return baro_figures(s); },
      "keep the vehicle still and out of the wind"};
  const int code = calibrate_sensor(link, sensor, options.write, out);
  if (code == 0) {
    const ParameterSet ground = read_values(link, sensor.parameters);
    say(out, fmt::format("ground: {:.0f} Pa, altitude {:.1f} m", ground[0].value.number(),
                         ground[1].value.number()));
  }
  return code;
}

int calibrate_airspeed(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  const Sensor sensor{"airspeed",
                      link::Command::kAirspeedCalibration,
                      {"DIFF_PRESS_BIAS"},
                      [](const SensorStatistics& s) { return s.diff_pressure_Pa.count(); },
                      [](const SensorStatistics& s, const std::vector<double>&, bool after) {
                        return airspeed_figures(s, after);
                      },
                      "cover the pitot tube"};
  return calibrate_sensor(link, sensor, options.write, out);
}

int calibrate_mag(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  if (!link.run_until([&] { return link.streams().mag.count > 0; }, link.timeout())) {
    throw NoAnswer(fmt::format("mag: no samples from {} within {:g} s", link.name(),
                               companion::to_seconds(link.timeout())));
  }
  link.receive_parameters();
  companion::MagCalibration::Options procedure;
  procedure.face_timeout = options.wait;
  companion::MagCalibration calibration(link.session(), procedure);
  calibration.on_prompt([&out](const std::string& line) { say(out, line); });
  const auto job = calibration.start();
  std::size_t faces = 0;
  try {
    link.run_until(
        [&] {
          faces = std::max(faces, calibration.progress().faces_done);
          return !job.pending();
        },
        companion::kNever);
  } catch (const Stopped&) {
    calibration.cancel();
    say(out, link.finish(job).text());
    throw;
  }
  const companion::MagFit& fit = job.result();
  const double field_uT = 1e6 * fit.field;
  if (fit.field > 0.0) {
    say(out, fmt::format(
                 "mag: fit residual {:.2f} % of the field, limit {:g} %; {:.0f} % of the sphere; "
                 "field {:.1f} uT",
                 100.0 * fit.residual, 100.0 * procedure.fit.max_residual, 100.0 * fit.coverage,
                 field_uT));
  }
  if (job.failed()) {
    const bool covered = faces == companion::MagCalibration::kFaces;
    say(out,
        job.text() + (covered ? "" : fmt::format("; coverage: {} of 6 faces, limit 6", faces)));
    return 1;
  }
  say(out, job.text());
  return store_calibration(link, options.write, out);
}

void say(std::ostream& out, const std::string& line) {
  out << line << '\n' << std::flush;
}

const Figure* first_bad(const std::vector<Figure>& figures) {
  const auto bad =
      std::find_if(figures.begin(), figures.end(), [](const Figure& f) { return !f.good(); });
  return bad == figures.end() ? nullptr : &*bad;
}

ParameterSet read_values(GroundLink& link, const std::vector<std::string>& names) {
  ParameterSet set;
  for (const std::string& name : names) {
    const auto job = link.session().parameters().read(name);
    link.wait(job);
    const auto& value = job.result().value;
    if (job.failed() || !value) throw NoAnswer(job.text() + " from " + link.name());
    set.push_back({name, *value});
  }
  return set;
}

int store_calibration(GroundLink& link, bool write, std::ostream& out) {
  if (!write) {
    say(out, "not stored: lost at the next restart of the vehicle; --write stores it");
    return 0;
  }
  const auto job = link.session().commands().start(link::Command::kWriteParams);
  say(out, link.wait(job).text());
  return job.done() ? 0 : 1;
}

}  // namespace rosflight::ground
