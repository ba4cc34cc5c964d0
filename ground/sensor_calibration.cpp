// SPDX-License-Identifier: BSD-3-Clause
#include "ground/sensor_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/constants.hpp"

namespace rosflight::ground {
namespace {

using Figures = std::vector<Figure>;

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

double largest_deviation(const std::array<Statistics, 3>& axes) {
  return std::max({axes[0].deviation(), axes[1].deviation(), axes[2].deviation()});
}

double norm(const std::array<double, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

std::array<double, 3> mean(const std::array<Statistics, 3>& axes) {
  return {axes[0].mean(), axes[1].mean(), axes[2].mean()};
}

std::string text_of(const Figures& figures) {
  std::string text;
  for (const Figure& figure : figures) text += (text.empty() ? "" : "; ") + figure.text();
  return text;
}

}  // namespace

const Figure* first_bad(const std::vector<Figure>& figures) {
  const auto bad =
      std::find_if(figures.begin(), figures.end(), [](const Figure& f) { return !f.good(); });
  return bad == figures.end() ? nullptr : &*bad;
}

std::vector<double> numbers(const companion::ParameterSet& set) {
  std::vector<double> values;
  for (const companion::NamedValue& entry : set) values.push_back(entry.value.number());
  return values;
}

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

namespace {

const std::array<Sensor, 4> kSensors{
    Sensor{"gyro",
           link::Command::kGyroCalibration,
           {"GYRO_X_BIAS", "GYRO_Y_BIAS", "GYRO_Z_BIAS"},
           [](const SensorStatistics& s) { return s.gyro_rad_s[0].count(); },
           [](const SensorStatistics& s, const std::vector<double>&, bool after) {
             return gyro_figures(s, after);
           },
           "keep the vehicle still"},
    Sensor{"accel",
           link::Command::kAccelCalibration,
           {"ACC_X_BIAS", "ACC_Y_BIAS", "ACC_Z_BIAS"},
           [](const SensorStatistics& s) { return s.accel_m_s2[0].count(); },
           [](const SensorStatistics& s, const std::vector<double>& offset, bool after) {
             return accel_figures(s, {offset[0], offset[1], offset[2]}, after);
           },
           "put the vehicle level and keep it still"},
    Sensor{
        "baro",
        link::Command::kBaroCalibration,
        {"BARO_BIAS", "GROUND_LEVEL"},
        [](const SensorStatistics& s) { return s.pressure_Pa.count(); },
        [](const SensorStatistics& s, const std::vector<double>&, bool) { return baro_figures(s); },
        "keep the vehicle still and out of the wind"},
    Sensor{"airspeed",
           link::Command::kAirspeedCalibration,
           {"DIFF_PRESS_BIAS"},
           [](const SensorStatistics& s) { return s.diff_pressure_Pa.count(); },
           [](const SensorStatistics& s, const std::vector<double>&, bool after) {
             return airspeed_figures(s, after);
           },
           "cover the pitot tube"}};

}  // namespace

const Sensor* find_sensor(std::string_view name) {
  const auto* const found = std::find_if(kSensors.begin(), kSensors.end(),
                                         [name](const Sensor& s) { return s.name == name; });
  return found == kSensors.end() ? nullptr : found;
}

SensorCalibration::SensorCalibration(companion::Session& session, const Sensor& sensor)
    : session_{session}, sensor_{sensor}, former_{values()} {
  enter(Stage::kBefore);
  if (former_.size() != sensor_.parameters.size())
    end(false, "refused: the parameters of the vehicle are not known yet");
  if (session_.streams().status.value.armed) end(false, "refused: the vehicle is armed");
}

companion::ParameterSet SensorCalibration::values() const {
  companion::ParameterSet set;
  for (const std::string& name : sensor_.parameters) {
    if (const auto value = session_.parameters().get(name)) set.push_back({name, *value});
  }
  return set;
}

void SensorCalibration::enter(Stage stage) {
  stage_ = stage;
  entered_ = session_.now();
  recorder_.reset();
  if (stage == Stage::kBefore || stage == Stage::kAfter) recorder_.emplace(session_);
}

void SensorCalibration::end(bool good, std::string text) {
  enter(Stage::kEnded);
  good_ = good;
  text_ = std::move(text);
}

std::optional<std::vector<Figure>> SensorCalibration::judge(bool after) {
  const SensorStatistics& measured = recorder_->statistics;
  if (sensor_.samples(measured) < 2) {
    end(false, "refused: the sensor sends nothing");
    return std::nullopt;
  }
  Figures figures = sensor_.figures(measured, numbers(after ? values() : former_), after);
  const Figure* bad = first_bad(figures);
  if (bad == nullptr) return figures;
  const std::string why = fmt::format("refused: {}; {}", bad->text(), sensor_.advice);
  if (!after) {
    end(false, why + "; nothing changed");
  } else {
    text_ = why;
    restored_ = session_.parameters().load(former_);
    enter(Stage::kRestore);
  }
  return std::nullopt;
}

bool SensorCalibration::step() {
  const companion::Time past = session_.now() - entered_;
  switch (stage_) {
    case Stage::kBefore:
      if (past < kMeasuring || !judge(false)) break;
      command_ = session_.commands().start(sensor_.command);
      enter(Stage::kCommand);
      break;
    case Stage::kCommand:
      if (command_.pending()) break;
      if (command_.failed()) {
        end(false, command_.text());
      } else {
        enter(Stage::kSettle);
      }
      break;
    case Stage::kSettle:
      if (past >= kSettling) enter(Stage::kAfter);
      break;
    case Stage::kAfter:
      if (past < kMeasuring) break;
      if (const auto figures = judge(true)) end(true, text_of(*figures));
      break;
    case Stage::kRestore:
      if (restored_.pending()) break;
      end(false, text_ + (restored_.done() ? "; former values put back" : "; " + restored_.text()));
      break;
    case Stage::kEnded:
      break;
  }
  return stage_ == Stage::kEnded;
}

}  // namespace rosflight::ground
