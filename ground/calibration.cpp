// SPDX-License-Identifier: BSD-3-Clause
#include "ground/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "companion/mag_calibration.hpp"

namespace rosflight::ground {
namespace {

using companion::NamedValue;
using companion::ParameterSet;
using Figures = std::vector<Figure>;

SensorStatistics measure(GroundLink& link, const Sensor& sensor) {
  const SensorRecorder recorder(link.session());
  link.run_for(kMeasuring);
  if (sensor.samples(recorder.statistics) < 2) {
    throw NoAnswer(fmt::format("{}: no samples from {} within {:g} s", sensor.name, link.name(),
                               companion::to_seconds(kMeasuring)));
  }
  return recorder.statistics;
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
  if (!armed) {  // otherwise the vehicle sends the reason
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

int calibrate_gyro(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  return calibrate_sensor(link, *find_sensor("gyro"), options.write, out);
}

int calibrate_accel(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  return calibrate_sensor(link, *find_sensor("accel"), options.write, out);
}

int calibrate_baro(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  const Sensor& sensor = *find_sensor("baro");
  const int code = calibrate_sensor(link, sensor, options.write, out);
  if (code == 0) {
    const ParameterSet ground = read_values(link, sensor.parameters);
    say(out, fmt::format("ground: {:.0f} Pa, altitude {:.1f} m", ground[0].value.number(),
                         ground[1].value.number()));
  }
  return code;
}

int calibrate_airspeed(GroundLink& link, const CalibrationOptions& options, std::ostream& out) {
  return calibrate_sensor(link, *find_sensor("airspeed"), options.write, out);
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
