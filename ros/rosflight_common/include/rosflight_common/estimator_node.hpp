// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/attitude.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <std_msgs/msg/bool.hpp>
#include <string>
#include <utility>
#include <vector>

#include "autonomy/estimation/estimator.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_common/vehicle_file.hpp"

namespace rosflight_common {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace flight = rosflight::flight;

/// A parameter of ROSflight 2.x's name over a setting of the estimator; read at the start.
struct EstimatorView {
  const char* name;
  double min;
  double max;
  const char* text;
  double (*get)(const autonomy::estimation::EstimatorConfig&);
  void (*set)(autonomy::estimation::EstimatorConfig&, double);
};

/// Standard air at sea level: 1.225 kg/m^3 times 9.80665 m/s^2.
inline constexpr double kPascalPerMetre = 12.013;

/// The declination, which both stacks name alike; -1e6, as ROSflight 2.x has it: by the model.
inline EstimatorView declination_view() {
  using C = autonomy::estimation::EstimatorConfig;
  static constexpr double kNotGiven = -1e6;
  return {"declination",
          kNotGiven,
          180.0,
          "declination of the magnetic field [deg]; -1e6: by WMM2025",
          [](const C& c) {
            return c.declination_rad ? *c.declination_rad / autonomy::kRadPerDeg : kNotGiven;
          },
          [](C& c, double x) {
            if (x < -180.0 && x != kNotGiven) {
              throw config::Error("parameter declination: found " + config::number_text(x) +
                                  ", allowed -180 to 180, or -1e6 for the magnetic model");
            }
            c.declination_rad.reset();
            if (x != kNotGiven) c.declination_rad = x * autonomy::kRadPerDeg;
          }};
}

/// The estimator of autonomy/estimation as a node, for both stacks.
///
/// Policy: `kAirframe` (that of a fixed wing listens to airspeed), `Message` with a `header`, `views()` and
/// `fill(const StateEstimate&, const std::optional<Geodetic>&, Message&)`.
///
/// A state goes out with an IMU sample, under its stamp, at most estimator_update_frequency times a
/// second, and only when position, velocity and attitude are known. So it falls silent when the
/// IMU does; a controller that uses it must stop by itself. Silence of a sensor and its end are reported
/// once in the log; `/diagnostics` has the health at 1 Hz.
template <class Policy>
class EstimatorNode : public rclcpp::Node {
 public:
  using Message = typename Policy::Message;
  using Estimator = autonomy::estimation::Estimator;

  explicit EstimatorNode(const rclcpp::NodeOptions& options)
      : Node("estimator", options), estimator_{read_config(), Policy::kAirframe} {
    const double rate_Hz = declare_number(*this, "estimator_update_frequency", 400.0, 1.0, 2000.0,
                                          "maximum states per second [Hz]");
    interval_ns_ = static_cast<std::int64_t>(kAlmost * 1e9 / rate_Hz);
    min_fix_ = declare_integer(*this, "min_gnss_fix_type", 3, 2, 4,
                               "minimum fix_type of rosflight_msgs/GNSS that is used");
    if (declare_switch(*this, "hotstart_estimator", false,
                       "without effect; only false is allowed")) {
      throw config::Error(
          "parameter hotstart_estimator: found true, allowed false, because there is no hotstart "
          "file: the estimator starts in the air by itself");
    }
    for (Sensor& sensor : sensors_) {
      sensor.timeout_s =
          1e-3 * declare_number(*this, "max_" + sensor.name + "_sensor_silence_duration_ms",
                                sensor.timeout_s * 1e3, 1.0, 60'000.0,
                                "silence after which a warning is logged [ms]");
    }
    states_ = create_publisher<Message>("estimated_state", rclcpp::QoS(10));
    diagnostics_ =
        create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", rclcpp::QoS(10));
    listen();
    watch_ = rclcpp::create_timer(this, get_clock(), rclcpp::Duration::from_seconds(0.1),
                                  [this] { watch(); });
  }

 private:
  static constexpr double kAlmost = 0.9;  // of a period: jitter of stamps must not drop samples
  enum Which : std::uint8_t { kImu, kMag, kBaro, kGnss };
  struct Sensor {
    std::string name;
    const char* topic;
    double timeout_s;
    std::optional<rclcpp::Time> received{};
    bool silent{false};
  };

  autonomy::estimation::EstimatorConfig read_config() {
    auto config = flight::read_estimator(VehicleFile::declare(*this, Policy::kVehicle).read());
    for (const EstimatorView& view : Policy::views()) {
      const double from_file = view.get(config);
      const double value =
          declare_number(*this, view.name, from_file, view.min, view.max, view.text);
      if (value != from_file) view.set(config, value);
    }
    return config;
  }

  template <class Kind, class Take>
  void subscribe(const char* topic, Take take, const rclcpp::QoS& qos = stream(kDepth)) {
    subscriptions_.push_back(create_subscription<Kind>(
        topic, qos, [take](typename Kind::ConstSharedPtr message) { take(*message); }));
  }

  void listen() {
    namespace est = autonomy::estimation;
    subscribe<rosflight_msgs::msg::Status>(
        "status", [this](const rosflight_msgs::msg::Status& m) { armed_ = m.armed; },
        rclcpp::QoS(kDepth));
    subscribe<rosflight_msgs::msg::Attitude>(
        "attitude", [this](const rosflight_msgs::msg::Attitude& m) {
          if (!estimator_.wants_attitude_hint()) return;
          const auto& q = m.attitude;
          estimator_.set_attitude_hint(seconds(m.header), {q.w, q.x, q.y, q.z}, !restarted_);
        });
    subscribe<std_msgs::msg::Bool>(
        "status/restarted",
        [this](const std_msgs::msg::Bool& m) { restarted_ = restarted_ || m.data; },
        rclcpp::QoS(kDepth));
    subscribe<rosflight_msgs::msg::GNSS>("gnss", [this](const rosflight_msgs::msg::GNSS& m) {
      received(kGnss, m.header);
      estimator_.add(gnss_sample(m));
    });
    subscribe<rosflight_msgs::msg::Barometer>(
        "baro", [this](const rosflight_msgs::msg::Barometer& m) {
          received(kBaro, m.header);
          estimator_.add(est::BaroSample{seconds(m.header), static_cast<double>(m.pressure)});
        });
    subscribe<sensor_msgs::msg::MagneticField>(
        "magnetometer", [this](const sensor_msgs::msg::MagneticField& m) {
          received(kMag, m.header);
          const auto& b = m.magnetic_field;
          estimator_.add(est::MagSample{seconds(m.header), {b.x, b.y, b.z}});
        });
    subscribe<sensor_msgs::msg::Range>("range", [this](const sensor_msgs::msg::Range& m) {
      estimator_.add(est::RangeSample{seconds(m.header), static_cast<double>(m.range),
                                      static_cast<double>(m.min_range),
                                      static_cast<double>(m.max_range)});
    });
    if constexpr (Policy::kAirframe == autonomy::estimation::Airframe::kFixedWing) {
      subscribe<rosflight_msgs::msg::Airspeed>(
          "airspeed", [this](const rosflight_msgs::msg::Airspeed& m) {
            estimator_.add(
                est::PitotSample{seconds(m.header), static_cast<double>(m.differential_pressure)});
          });
    }
    subscribe<sensor_msgs::msg::Imu>("imu/data",
                                     [this](const sensor_msgs::msg::Imu& m) { step(m); });
  }

  autonomy::estimation::GnssSample gnss_sample(const rosflight_msgs::msg::GNSS& m) const {
    autonomy::estimation::GnssSample sample;
    sample.t_s = seconds(m.header);
    sample.unix_s =
        static_cast<double>(m.gnss_unix_seconds) + 1e-9 * static_cast<double>(m.gnss_unix_nanos);
    sample.fix_3d = m.fix_type >= min_fix_ &&
                    m.fix_type <= rosflight_msgs::msg::GNSS::GNSS_FIX_TYPE_GNSS_PLUS_DEAD_RECKONING;
    sample.position = {m.lat, m.lon, static_cast<double>(m.alt)};
    sample.v_W_m_s = {static_cast<double>(m.vel_n), static_cast<double>(m.vel_e),
                      static_cast<double>(m.vel_d)};
    return sample;
  }

  void step(const sensor_msgs::msg::Imu& m) {
    received(kImu, m.header);
    const auto& w = m.angular_velocity;
    const auto& a = m.linear_acceleration;
    estimator_.set_at_rest(!armed_);
    estimator_.add(
        autonomy::estimation::ImuSample{seconds(m.header), {w.x, w.y, w.z}, {a.x, a.y, a.z}});
    const std::int64_t stamp_ns = nanoseconds(m.header.stamp);
    const bool back = stamp_ns < last_ns_;
    if (!back && stamp_ns - last_ns_ < interval_ns_) return;
    const autonomy::StateEstimate estimate = estimator_.estimate();
    if (!worth_telling(estimate)) return;
    last_ns_ = stamp_ns;
    Message out;
    Policy::fill(estimate, estimator_.origin(), out);
    out.header.stamp = m.header.stamp;
    out.header.frame_id = "NED";
    states_->publish(out);
  }

  void received(Which which, const std_msgs::msg::Header& header) {
    Sensor& sensor = sensors_[which];
    sensor.received = received_at(*this, header.stamp);
    if (!sensor.silent) return;
    sensor.silent = false;
    RCLCPP_INFO(get_logger(), "%s is back", sensor.topic);
  }

  void watch() {
    const rclcpp::Time time = now();
    for (Sensor& sensor : sensors_) {
      if (!sensor.received || sensor.silent) continue;
      if ((time - *sensor.received).seconds() < sensor.timeout_s) continue;
      sensor.silent = true;
      RCLCPP_WARN(get_logger(), "%s is silent%s", sensor.topic,
                  sensor.name == "imu" ? ": no state goes out" : "");
    }
    constexpr int kOnceIn = 10;
    if (++watches_ % kOnceIn == 0) publish_health(time);
  }

  void publish_health(const rclcpp::Time& time) {
    using diagnostic_msgs::msg::DiagnosticStatus;
    const autonomy::estimation::EstimatorHealth& health = estimator_.health();
    const autonomy::StateEstimate estimate = estimator_.estimate();
    DiagnosticStatus status;
    status.name = std::string(get_fully_qualified_name()) + ": estimate";
    status.hardware_id = "estimator";
    const bool flowing = worth_telling(estimate) && !sensors_[kImu].silent;
    const bool good = flowing && estimate.horizontal == autonomy::Quality::kGood &&
                      estimate.vertical == autonomy::Quality::kGood;
    status.level =
        good ? DiagnosticStatus::OK : (flowing ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR);
    status.message = good ? "good" : (flowing ? "dead reckoning" : "no estimate");
    const auto add = [&status](const char* key, double value) {
      diagnostic_msgs::msg::KeyValue entry;
      entry.key = key;
      entry.value = std::to_string(value);
      status.values.push_back(entry);
    };
    add("GNSS age [s]", health.gnss_age_s);
    add("position sigma, north [m]", estimate.p_sigma_W_m.x());
    add("position sigma, east [m]", estimate.p_sigma_W_m.y());
    add("position sigma, down [m]", estimate.p_sigma_W_m.z());
    add("late samples", static_cast<double>(health.late));
    add("unusable samples", static_cast<double>(health.unusable));
    add("holes in the IMU", static_cast<double>(health.imu_holes));
    add("restarts", static_cast<double>(health.restarts));
    add("moves to GNSS", static_cast<double>(health.gnss_resets));
    diagnostic_msgs::msg::DiagnosticArray all;
    all.header.stamp = time;
    all.status.push_back(status);
    diagnostics_->publish(all);
  }

  /// A policy may tell states that are not whole.
  static bool worth_telling(const autonomy::StateEstimate& estimate) {
    if constexpr (requires { Policy::worth_telling(estimate); }) {
      return estimate.attitude != autonomy::Quality::kNone && Policy::worth_telling(estimate);
    } else {
      return estimate.usable();
    }
  }

  static constexpr std::size_t kDepth = 10;
  Estimator estimator_;
  std::array<Sensor, 4> sensors_{Sensor{"imu", "imu/data", 0.1}, Sensor{"mag", "magnetometer", 0.5},
                                 Sensor{"baro", "baro", 0.5}, Sensor{"gnss", "gnss", 1.0}};
  std::int64_t interval_ns_{};
  std::int64_t last_ns_{};
  std::int64_t min_fix_{};
  std::uint64_t watches_{};
  bool armed_{false};
  bool restarted_{false};  ///< The firmware began again, with a heading of its own.
  typename rclcpp::Publisher<Message>::SharedPtr states_;
  rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr diagnostics_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  rclcpp::TimerBase::SharedPtr watch_;
};

}  // namespace rosflight_common
