// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "companion/session.hpp"
#include "ground/statistics.hpp"

/// Calibrations at rest, with a figure of quality.
namespace rosflight::ground {

/// A measured quality and the limit of its magnitude.
struct Figure {
  std::string name;
  double value{};
  double limit{};
  std::string unit;

  bool good() const { return std::abs(value) <= limit; }  ///< False for NaN.
  /// "standard deviation 0.0021 rad/s, limit 0.05 rad/s".
  std::string text() const;
};

/// Statistics of what the sensors sent for a while.
struct SensorStatistics {
  std::array<Statistics, 3> gyro_rad_s;
  std::array<Statistics, 3> accel_m_s2;
  Statistics pressure_Pa;
  Statistics diff_pressure_Pa;
};

/// Figures before a calibration, when the old offsets are in force, and after it.
/// @param offset  that the vehicle subtracts from the measured specific force.
std::vector<Figure> gyro_figures(const SensorStatistics& s, bool after);
std::vector<Figure> accel_figures(const SensorStatistics& s,
                                  const std::array<double, 3>& offset_m_s2, bool after);
std::vector<Figure> baro_figures(const SensorStatistics& s);
std::vector<Figure> airspeed_figures(const SensorStatistics& s, bool after);

/// The first figure beyond its limit; nullptr if all are good.
const Figure* first_bad(const std::vector<Figure>& figures);

/// What differs between the sensors that are calibrated at rest.
struct Sensor {
  const char* name;
  link::Command command;
  std::vector<std::string> parameters;
  std::function<std::size_t(const SensorStatistics&)> samples;
  /// @param values  of `parameters`.
  std::function<std::vector<Figure>(const SensorStatistics&, const std::vector<double>& values,
                                    bool after)>
      figures;
  std::string advice;
};

/// gyro, accel, baro or airspeed; nullptr for another name.
const Sensor* find_sensor(std::string_view name);

/// Numbers of a set, in its order.
std::vector<double> numbers(const companion::ParameterSet& set);

inline constexpr companion::Time kMeasuring = std::chrono::milliseconds{1500};
inline constexpr companion::Time kSettling = std::chrono::milliseconds{200};

/// Adds up what arrives while it lives.
class SensorRecorder final : public companion::Listener {
 public:
  explicit SensorRecorder(companion::Session& session) : session_(session) { session_.add(*this); }
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
  companion::Session& session_;
};

/// One calibration over a session that somebody else steps: measures, calibrates, measures again, and puts the
/// former values back when the result is not good enough.
class SensorCalibration {
 public:
  /// Begins at session.now(). @param session  must outlive this, with the whole parameter table.
  SensorCalibration(companion::Session& session, const Sensor& sensor);

  /// Goes on if something is due. @returns whether it has ended.
  bool step();

  // After the end:
  bool good() const { return good_; }
  /// One line with the figures, or why it was refused.
  const std::string& text() const { return text_; }

 private:
  enum class Stage : std::uint8_t { kBefore, kCommand, kSettle, kAfter, kRestore, kEnded };
  companion::ParameterSet values() const;
  void enter(Stage stage);
  void end(bool good, std::string text);
  /// @returns the figures of what was measured; ends it without samples or beyond a limit.
  std::optional<std::vector<Figure>> judge(bool after);

  companion::Session& session_;
  const Sensor& sensor_;
  companion::ParameterSet former_;
  Stage stage_{Stage::kBefore};
  companion::Time entered_{};
  std::optional<SensorRecorder> recorder_;
  companion::Job<companion::CommandResult> command_;
  companion::Job<companion::LoadReport> restored_;
  bool good_{false};
  std::string text_;
};

}  // namespace rosflight::ground
