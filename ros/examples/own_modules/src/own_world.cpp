// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "rosflight_sim/dynamics_interface.hpp"
#include "rosflight_sim/sensor_interface.hpp"
#include "rosflight_sim/time_manager_interface.hpp"
#include "run.hpp"

// A bridge to a simulator of your own. `Engine` stands for that simulator; its motion, its sensors and its clock are nodes in one
// thread.

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kGravity_m_s2 = 9.81;
constexpr double kMass_kg = 3.5;
constexpr double kFeet_m = 0.2;  // below the centre of mass
constexpr double kGround_N_m = 2000.0;
constexpr double kStanding_m = kMass_kg * kGravity_m_s2 / kGround_N_m - kFeet_m;  // down
const Vector3d kInertia_kg_m2{0.08, 0.08, 0.12};

Vector3d vector(const geometry_msgs::msg::Vector3& v) {
  return {v.x, v.y, v.z};
}

template <class Message>
void put(const Vector3d& from, Message& to) {
  to.x = from.x();
  to.y = from.y();
  to.z = from.z();
}

/// A rigid body over a soft ground. North-east-down, body axes front-right-down.
struct Engine {
  double time_s{0.0};
  Vector3d p{0.0, 0.0, kStanding_m}, v{0.0, 0.0, 0.0};  // NED
  Quaterniond q{1.0, 0.0, 0.0, 0.0};                    // body to NED
  Vector3d w{0.0, 0.0, 0.0};                            // body axes
  Vector3d specific_force{0.0, 0.0, -kGravity_m_s2};    // body axes

  void step(const Vector3d& force, const Vector3d& torque, double dt_s) {
    constexpr int kParts = 5;
    for (int k = 0; k < kParts; ++k) part(force, torque, dt_s / kParts);
  }

 private:
  void part(const Vector3d& force, const Vector3d& torque, double dt_s) {
    Vector3d outside = q * force;
    Vector3d turning = torque;
    const double depth_m = p.z() + kFeet_m;
    if (depth_m > 0.0) {
      outside.z() -= kGround_N_m * depth_m + 120.0 * v.z();
      outside.x() -= 50.0 * v.x();
      outside.y() -= 50.0 * v.y();
      const Vector3d up = q.conjugate() * Vector3d::UnitZ();
      turning += 8.0 * up.cross(Vector3d::UnitZ()) * -1.0 - 1.0 * w;
    }
    specific_force = q.conjugate() * outside / kMass_kg;
    v += dt_s * (outside / kMass_kg + Vector3d(0.0, 0.0, kGravity_m_s2));
    p += dt_s * v;
    const Vector3d gyroscopic = w.cross(kInertia_kg_m2.cwiseProduct(w));
    w += dt_s * (turning - gyroscopic).cwiseQuotient(kInertia_kg_m2);
    const double angle = w.norm() * dt_s;
    if (angle > 0.0) q = (q * Quaterniond(Eigen::AngleAxisd(angle, w.normalized()))).normalized();
  }
};

class Clock : public rosflight_sim::TimeManagerInterface {
 private:
  void update_time() override { now_us_ += get_clock_duration_us().count(); }
  unsigned long int get_seconds() override { return static_cast<unsigned long>(now_us_ / 1000000); }
  unsigned int get_nanoseconds() override {
    return static_cast<unsigned int>(now_us_ % 1000000 * 1000);
  }
  std::int64_t now_us_{0};
};

class Motion : public rosflight_sim::DynamicsInterface {
 public:
  explicit Motion(std::shared_ptr<Engine> engine) : engine_{std::move(engine)} {}

 private:
  void apply_forces_and_torques(const geometry_msgs::msg::WrenchStamped& msg) override {
    const double stamp_s = rclcpp::Time(msg.header.stamp).seconds();
    const double dt_s = last_s_ > 0.0 ? stamp_s - last_s_ : 0.0;
    last_s_ = stamp_s;
    if (dt_s > 0.0 && dt_s < 0.1)
      engine_->step(vector(msg.wrench.force), vector(msg.wrench.torque), dt_s);
  }

  rosflight_msgs::msg::SimState compute_truth() override {
    const Engine& e = *engine_;
    rosflight_msgs::msg::SimState state;
    put(e.p, state.pose.position);
    state.pose.orientation.w = e.q.w();
    put(e.q.vec(), state.pose.orientation);
    put(e.q.conjugate() * e.v, state.twist.linear);
    put(e.w, state.twist.angular);
    put(e.specific_force + e.q.conjugate() * Vector3d(0.0, 0.0, kGravity_m_s2),
        state.acceleration.linear);
    return state;
  }

  geometry_msgs::msg::Vector3Stamped compute_wind_truth() override {
    return geometry_msgs::msg::Vector3Stamped();
  }

  bool set_sim_state(const rosflight_msgs::msg::SimState state) override {
    if (state.pose.position.z > 0.0) return false;
    *engine_ = Engine();
    engine_->p = {state.pose.position.x, state.pose.position.y, state.pose.position.z};
    return true;
  }

  std::shared_ptr<Engine> engine_;
  double last_s_{0.0};
};

/// Sensors without errors. The IMU has a little noise, because the firmware takes twenty identical samples for a broken IMU.
class Sensors : public rosflight_sim::SensorInterface {
 public:
  explicit Sensors(std::shared_ptr<Engine> engine) : engine_{std::move(engine)} {}

 private:
  using State = rosflight_msgs::msg::SimState;
  static constexpr double kLatitude_deg = 40.2463724, kLongitude_deg = -111.6474138;
  static constexpr double kNorth_m_deg = 111219.0, kEast_m_deg = 84888.0;  // there
  static constexpr double kAltitude_m = 1387.0, kPressure_Pa = 85729.0, kPressureScale_m = 8172.0;
  static constexpr double kTemperature_K = 288.15;

  Vector3d noise(double deviation) {
    return deviation * Vector3d(normal_(random_), normal_(random_), normal_(random_));
  }
  double altitude_m() const { return kAltitude_m - engine_->p.z(); }
  double pressure_Pa() const { return kPressure_Pa * std::exp(engine_->p.z() / kPressureScale_m); }

  sensor_msgs::msg::Imu imu_update(const State& /*state*/,
                                   const geometry_msgs::msg::WrenchStamped& /*forces*/) override {
    sensor_msgs::msg::Imu imu;
    put(engine_->specific_force + noise(0.02), imu.linear_acceleration);
    put(engine_->w + noise(0.001), imu.angular_velocity);
    return imu;
  }
  sensor_msgs::msg::Temperature imu_temperature_update(const State& /*state*/) override {
    sensor_msgs::msg::Temperature temperature;
    temperature.temperature = 25.0;
    return temperature;
  }
  sensor_msgs::msg::Imu get_imu_biases() override { return sensor_msgs::msg::Imu(); }
  sensor_msgs::msg::MagneticField mag_update(const State& /*state*/) override {
    sensor_msgs::msg::MagneticField field;
    put(engine_->q.conjugate() * Vector3d(2.084e-5, 3.917e-6, 4.607e-5), field.magnetic_field);
    return field;
  }
  rosflight_msgs::msg::Barometer baro_update(const State& /*state*/) override {
    rosflight_msgs::msg::Barometer baro;
    baro.pressure = static_cast<float>(pressure_Pa());
    baro.altitude = static_cast<float>(altitude_m());
    baro.temperature = static_cast<float>(kTemperature_K);
    return baro;
  }
  rosflight_msgs::msg::GNSS gnss_update(const State& state) override {
    rosflight_msgs::msg::GNSS gnss;
    gnss.fix_type = rosflight_msgs::msg::GNSS::GNSS_FIX_TYPE_3D_FIX;
    gnss.num_sat = 12;
    gnss.lat = kLatitude_deg + engine_->p.x() / kNorth_m_deg;
    gnss.lon = kLongitude_deg + engine_->p.y() / kEast_m_deg;
    gnss.alt = static_cast<float>(altitude_m());
    gnss.vel_n = static_cast<float>(engine_->v.x());
    gnss.vel_e = static_cast<float>(engine_->v.y());
    gnss.vel_d = static_cast<float>(engine_->v.z());
    gnss.horizontal_accuracy = gnss.vertical_accuracy = 1.0F;
    gnss.speed_accuracy = 0.2F;
    gnss.gnss_unix_seconds = 1780336800 + state.header.stamp.sec;
    gnss.gnss_unix_nanos = static_cast<int32_t>(state.header.stamp.nanosec);
    return gnss;
  }
  sensor_msgs::msg::Range range_update(const State& /*state*/) override {
    sensor_msgs::msg::Range range;
    range.min_range = 0.1F;
    range.max_range = 8.0F;
    range.range = static_cast<float>(-engine_->p.z());
    return range;
  }
  rosflight_msgs::msg::Airspeed diff_pressure_update(
      const State& /*state*/, const geometry_msgs::msg::Vector3Stamped& /*wind*/) override {
    rosflight_msgs::msg::Airspeed airspeed;
    airspeed.temperature = static_cast<float>(kTemperature_K);
    return airspeed;
  }
  rosflight_msgs::msg::BatteryStatus battery_update(const State& /*state*/) override {
    rosflight_msgs::msg::BatteryStatus battery;
    battery.voltage = 25.2F;
    return battery;
  }

  std::shared_ptr<Engine> engine_;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

}  // namespace

int main(int argc, char** argv) {
  const auto engine = std::make_shared<Engine>();
  return run(argc, argv,
             {{"dynamics", [&] { return std::make_shared<Motion>(engine); }},
              {"sensors", [&] { return std::make_shared<Sensors>(engine); }},
              {"clock", [] { return std::make_shared<Clock>(); }}});
}
