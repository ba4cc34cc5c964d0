// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/sensor_parameters.hpp"

#include <cmath>

#include "base/constants.hpp"
#include "sim/parameter_tables.hpp"
#include "sim/sensors/read_config.hpp"

namespace rosflight_sim {

namespace base = rosflight::base;
namespace config = rosflight::config;
namespace sim = rosflight::sim;
namespace {

using sim::Timing;
using sim::sensors::SensorsConfig;
using Row = config::Row<SensorSettings>;
using List = std::vector<Row>;
using config::Range;
using Errors = sim::ErrorParameters;

template <class T>
using Part = std::function<T&(SensorSettings&)>;

/// A part of settings that are not to be changed.
template <class T>
T look(const Part<T>& part, const SensorSettings& settings) {
  SensorSettings copy = settings;
  return part(copy);
}

void add_number(List& list, const char* name, double least, double most, config::Unit unit,
                const char* text, const Part<double>& part) {
  list.emplace_back(name, part, unit, Range::between(least, most), text);
}

/// A number of the vehicle file: with its unit and range.
template <class S>
void add_key(List& list, const char* name, const config::Table<S>& table, std::string_view key,
             const char* text, S SensorSettings::*part) {
  for (const config::Parameter<S>& parameter : table.parameters()) {
    if (parameter.row.key != key) continue;
    list.emplace_back(
        name, [parameter, part](const SensorSettings& s) { return parameter.get(s.*part)[0]; },
        [parameter, part](SensorSettings& s, double value) { parameter.set(s.*part, {value}); },
        config::Unit{parameter.row.unit}, parameter.row.allowed, text);
  }
}

void add_rate(List& list, const char* name, const Part<Timing>& part) {
  constexpr double kMicroseconds = 1e6;
  list.emplace_back(
      name,
      [part](const SensorSettings& s) {
        return kMicroseconds / static_cast<double>(look(part, s).period.count());
      },
      [part](SensorSettings& s, double rate_Hz) {
        part(s).period = sim::Time{std::llround(kMicroseconds / rate_Hz)};
      },
      "Hz", Range::between(0.1, 10'000.0), "samples per second");
}

/// White noise per sample: what a density amounts to at this rate, and the rest.
void add_noise(List& list, const char* name, double most, config::Unit unit, const char* text,
               const Part<Errors>& part, const Part<Timing>& timing) {
  list.emplace_back(
      name,
      [part, timing](const SensorSettings& s) {
        const Errors e = look(part, s);
        const double period_s = sim::to_seconds(look(timing, s).period);
        return std::hypot(e.noise_sigma, e.noise_density / std::sqrt(period_s));
      },
      [part](SensorSettings& s, double sigma) {
        part(s).noise_sigma = sigma;
        part(s).noise_density = 0.0;
      },
      unit, Range::between(0.0, most), text);
}

/// b <- b + step N per sample.
void add_walk(List& list, const char* name, double most, config::Unit unit, const char* text,
              const Part<Errors>& part, const Part<Timing>& timing) {
  const auto root_period = [timing](const SensorSettings& s) {
    return std::sqrt(sim::to_seconds(look(timing, s).period));
  };
  list.emplace_back(
      name,
      [part, root_period](const SensorSettings& s) {
        return look(part, s).bias_walk * root_period(s);
      },
      [part, root_period](SensorSettings& s, double step) {
        part(s).bias_walk = step / root_period(s);
      },
      unit, Range::between(0.0, most), text);
}

/// x <- exp(-k T) x + T drive N: its stationary spread and time constant are ours.
struct Markov {
  Part<Errors> part;
  Part<Timing> timing;
  double usual_decay_1_s;  ///< While there is no such error.

  double decay(const SensorSettings& s) const {
    const double time_s = look(part, s).drift_time_s;
    return time_s > 0.0 ? 1.0 / time_s : usual_decay_1_s;
  }
  double spread_per_drive(const SensorSettings& s, double decay_1_s) const {
    const double period_s = sim::to_seconds(look(timing, s).period);
    return period_s / std::sqrt(1.0 - std::exp(-2.0 * decay_1_s * period_s));
  }
  double drive(const SensorSettings& s) const {
    return look(part, s).drift_sigma / spread_per_drive(s, decay(s));
  }
  void put(SensorSettings& s, double drive, double decay_1_s) const {
    part(s).drift_time_s = 1.0 / decay_1_s;
    part(s).drift_sigma = drive * spread_per_drive(s, decay_1_s);
  }
};

void add_drive(List& list, const char* name, double most, const Markov& law) {
  list.emplace_back(
      name, [law](const SensorSettings& s) { return law.drive(s); },
      [law](SensorSettings& s, double drive) { law.put(s, drive, law.decay(s)); }, "unit/s",
      Range::between(0.0, most), "drive of the wandering error");
}

void add_decay(List& list, const char* name, const std::vector<Markov>& laws) {
  list.emplace_back(
      name, [laws](const SensorSettings& s) { return laws.front().decay(s); },
      [laws](SensorSettings& s, double decay_1_s) {
        for (const Markov& law : laws) law.put(s, law.drive(s), decay_1_s);
      },
      "1/s", Range::between(1e-6, 1000.0), "decay of the wandering error");
}

// ---- where things are ---------------------------------------------------------------------------

template <class T>
Part<T> at(T& (*place)(SensorsConfig&)) {
  return [place](SensorSettings& s) -> T& { return place(s.sensors); };
}

Errors& gyro(SensorsConfig& c) {
  return c.imu.gyro_rad_s.axis;
}
Errors& accel(SensorsConfig& c) {
  return c.imu.accel_m_s2.axis;
}
Errors& field(SensorsConfig& c) {
  return c.mag.field_T.axis;
}
Errors& baro(SensorsConfig& c) {
  return c.baro.pressure_Pa;
}
Errors& pitot(SensorsConfig& c) {
  return c.diff_pressure.pressure_Pa;
}
Errors& range(SensorsConfig& c) {
  return c.range.range_m;
}
Errors& voltage(SensorsConfig& c) {
  return c.battery.voltage_V;
}
Errors& horizontal(SensorsConfig& c) {
  return c.gnss.horizontal_m;
}
Errors& vertical(SensorsConfig& c) {
  return c.gnss.vertical_m;
}
Errors& velocity(SensorsConfig& c) {
  return c.gnss.velocity_m_s.axis;
}
Timing& imu_timing(SensorsConfig& c) {
  return c.imu.timing;
}
Timing& mag_timing(SensorsConfig& c) {
  return c.mag.timing;
}
Timing& baro_timing(SensorsConfig& c) {
  return c.baro.timing;
}
Timing& pitot_timing(SensorsConfig& c) {
  return c.diff_pressure.timing;
}
Timing& range_timing(SensorsConfig& c) {
  return c.range.timing;
}
Timing& gnss_timing(SensorsConfig& c) {
  return c.gnss.timing;
}
Timing& battery_timing(SensorsConfig& c) {
  return c.battery.timing;
}

void add_imu(List& list) {
  const Markov law{at(gyro), at(imu_timing), 20.0};
  add_noise(list, "gyro_stdev", 10.0, "rad/s", "white noise per sample", at(gyro), at(imu_timing));
  add_number(list, "gyro_bias_range", 0.0, 10.0, "rad/s", "maximum size of the bias at start",
             [](SensorSettings& s) -> double& { return gyro(s.sensors).turn_on_bias; });
  add_drive(list, "gyro_bias_walk_stdev", 10.0, law);
  add_decay(list, "k_gyro", {law});
  add_number(list, "gyro_bias_model_tau", 0.0, 1e6, "s", "decay time of the bias at start",
             [](SensorSettings& s) -> double& { return s.sensors.imu.gyro_transient_time_s; });
  const char* names[] = {"gyro_bias_model_x0", "gyro_bias_model_y0", "gyro_bias_model_z0"};
  for (int i = 0; i < 3; ++i)
    add_number(list, names[i], -1.0, 1.0, "rad/s", "initial value of a decaying bias",
               [i](SensorSettings& s) -> double& { return s.sensors.imu.gyro_transient_rad_s[i]; });
  add_noise(list, "acc_stdev", 100.0, "m/s^2", "white noise per sample", at(accel), at(imu_timing));
  add_number(list, "acc_bias_range", 0.0, 100.0, "m/s^2", "maximum size of the bias at start",
             [](SensorSettings& s) -> double& { return accel(s.sensors).turn_on_bias; });
  add_walk(list, "acc_bias_walk_stdev", 1.0, "m/s^2", "step of the bias per sample", at(accel),
           at(imu_timing));
}

/// The field in place of the world magnetic model's: intensity, inclination (down), declination
/// (east).
struct Field {
  double total_T, inclination_rad, declination_rad;

  static Field of(const SensorSettings& s) {
    const sim::Vector3& b = s.environment.magnetic_field_W_T;
    return {b.norm(), std::atan2(b.z(), std::hypot(b.x(), b.y())), std::atan2(b.y(), b.x())};
  }
  void put(SensorSettings& s) const {
    s.environment.magnetic_field_W_T =
        total_T * sim::Vector3(std::cos(inclination_rad) * std::cos(declination_rad),
                               std::cos(inclination_rad) * std::sin(declination_rad),
                               std::sin(inclination_rad));
  }
};

void add_field(List& list, const char* name, double most, config::Unit unit, const char* text,
               double Field::*part) {
  list.emplace_back(
      name, [part](const SensorSettings& s) { return Field::of(s).*part; },
      [part](SensorSettings& s, double value) {
        Field f = Field::of(s);
        f.*part = value;
        f.put(s);
      },
      unit, Range::between(-most, most), text);
}

void add_mag(List& list) {
  const Markov law{at(field), at(mag_timing), 7.0};
  add_drive(list, "mag_stdev", 1.0, law);
  add_decay(list, "k_mag", {law});
  add_field(list, "inclination", base::kPi / 2, "rad", "inclination of the magnetic field, down",
            &Field::inclination_rad);
  add_field(list, "declination", base::kPi, "rad", "declination of the magnetic field, east",
            &Field::declination_rad);
  add_field(list, "total_intensity", 1e-3, "T", "intensity of the magnetic field", &Field::total_T);
}

void add_pressures_and_range(List& list) {
  add_noise(list, "baro_stdev", 1e4, "Pa", "white noise per sample", at(baro), at(baro_timing));
  add_number(list, "baro_bias_range", 0.0, 1e4, "Pa", "maximum size of the bias at start",
             [](SensorSettings& s) -> double& { return baro(s.sensors).turn_on_bias; });
  add_walk(list, "baro_bias_walk_stdev", 1e3, "Pa", "step of the bias per sample", at(baro),
           at(baro_timing));
  add_noise(list, "airspeed_stdev", 1e4, "Pa", "white noise per sample", at(pitot),
            at(pitot_timing));
  add_number(list, "airspeed_bias_range", 0.0, 1e4, "Pa", "maximum size of the bias at start",
             [](SensorSettings& s) -> double& { return pitot(s.sensors).turn_on_bias; });
  add_walk(list, "airspeed_bias_walk_stdev", 1e3, "Pa", "step of the bias per sample", at(pitot),
           at(pitot_timing));
  add_noise(list, "range_stdev", 100.0, "m", "white noise per sample", at(range), at(range_timing));
  const auto sensors = sim::sensors::sensor_tables();
  add_key(list, "range_min_range", sensors, "range.min_m", "minimum distance that is measured",
          &SensorSettings::sensors);
  add_key(list, "range_max_range", sensors, "range.max_m", "maximum distance that is measured",
          &SensorSettings::sensors);
}

void add_gnss_and_battery(List& list) {
  constexpr double kDecay_1_s = 1.0 / 1100.0;
  const Markov north_east{at(horizontal), at(gnss_timing), kDecay_1_s};
  const Markov down{at(vertical), at(gnss_timing), kDecay_1_s};
  add_drive(list, "horizontal_gnss_stdev", 1e3, north_east);
  add_drive(list, "vertical_gnss_stdev", 1e3, down);
  add_decay(list, "k_gnss", {north_east, down});
  add_noise(list, "gnss_velocity_stdev", 100.0, "m/s", "white noise per sample", at(velocity),
            at(gnss_timing));
  add_noise(list, "battery_stdev", 100.0, "V", "white noise per sample", at(voltage),
            at(battery_timing));
  add_number(list, "battery_voltage", 0.0, 100.0, "V",
             "constant voltage; 0: that of the forces and moments",
             [](SensorSettings& s) -> double& { return s.sensors.battery.fixed_voltage_V; });
}

void add_place(List& list) {
  const auto environment = sim::environment_parameters();
  const auto add = [&](const char* name, std::string_view key, const char* text) {
    add_key(list, name, environment, key, text, &SensorSettings::environment);
  };
  add("origin_altitude", "origin.altitude_m", "altitude of the start above mean sea level");
  add("origin_latitude", "origin.latitude_deg", "latitude of the start");
  add("origin_longitude", "origin.longitude_deg", "longitude of the start");
  add("gravity", "gravity_m_s2", "gravity");
}

}  // namespace

std::vector<std::string> rosflight_rates(const config::Section& sensors) {
  struct Rate {
    const char* sensor;
    const char* rate_Hz;
  };
  constexpr Rate kRates[] = {{"imu", "400"},    {"mag", "50"},   {"baro", "100"},
                             {"gnss", "10"},    {"range", "20"}, {"diff_pressure", "100"},
                             {"battery", "200"}};
  std::vector<std::string> out;
  if (sensors.text("module", "standard") != "standard") return out;
  for (const Rate& rate : kRates) {
    const auto own = sensors.optional_section(rate.sensor);
    if (!own || !own->has("rate_Hz"))
      out.push_back(std::string("sensors.") + rate.sensor + ".rate_Hz=" + rate.rate_Hz);
  }
  return out;
}

config::Table<SensorSettings> sensor_parameters() {
  List list;
  add_rate(list, "imu_update_frequency", at(imu_timing));
  add_rate(list, "mag_update_frequency", at(mag_timing));
  add_rate(list, "baro_update_frequency", at(baro_timing));
  add_rate(list, "gnss_update_frequency", at(gnss_timing));
  add_rate(list, "range_update_frequency", at(range_timing));
  add_rate(list, "diff_pressure_update_frequency", at(pitot_timing));
  add_rate(list, "battery_update_frequency", at(battery_timing));
  add_imu(list);
  add_mag(list);
  add_pressures_and_range(list);
  add_gnss_and_battery(list);
  add_place(list);
  return config::Table<SensorSettings>(list);
}

}  // namespace rosflight_sim
