// SPDX-License-Identifier: BSD-3-Clause
#include "flight/jsbsim/open_loop.hpp"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>

#include "base/constants.hpp"
#include "flight/flight.hpp"
#include "sim/fixedwing/trim.hpp"
#include "sim/registry.hpp"

namespace rosflight::flight {
namespace {

using base::kRadPerDeg;
constexpr std::size_t kBodyNumbers = 13;

std::vector<double> copy(std::span<const double> x) {
  return {x.begin(), x.end()};
}

std::size_t holds(double duration_s) {
  return static_cast<std::size_t>(
      std::llround(duration_s * 1e6 / static_cast<double>(RecordedFlight::kHold.count())));
}

/// Keeps what the visualiser of a flight sees.
class Keeper final : public sim::Visualiser {
 public:
  explicit Keeper(std::vector<hal::OutputValues>& outputs) : outputs_{outputs} {}
  void step(const sim::Truth&, const hal::OutputValues& outputs) override {
    if (on) outputs_.push_back(outputs);
  }
  bool on{false};

 private:
  std::vector<hal::OutputValues>& outputs_;
};

/// What the pilot of record_attitude_hold asks for at a time.
struct Wish {
  double roll_rad;
  double pitch_rad;
  double throttle;  ///< Added to that of the trim.
};

Wish wish_at(double t_s) {
  // Banks to both sides, climbs, dives, power on and off: a new one every 2.5 s.
  constexpr double kRoll_deg[] = {0, 25, 25, -30, -30, 0, 20, 0};
  constexpr double kPitch_deg[] = {4, 4, 10, 0, -8, 5, 2, 4};
  constexpr double kThrottle[] = {0.0, 0.1, 0.25, 0.0, -0.2, 0.1, 0.05, 0.0};
  const std::size_t i = static_cast<std::size_t>(t_s / 2.5) % std::size(kRoll_deg);
  return {kRoll_deg[i] * kRadPerDeg, kPitch_deg[i] * kRadPerDeg, kThrottle[i]};
}

/// Outputs for deflections: surfaces share them with the least angles.
class Servos {
 public:
  explicit Servos(const sim::FixedWingParameters& p) : p_{p} {
    Eigen::Matrix3Xd effect(3, p.surfaces.size());
    for (std::size_t i = 0; i < p.surfaces.size(); ++i)
      effect.col(static_cast<Eigen::Index>(i)) = p.surfaces[i].effect;
    share_ = effect.completeOrthogonalDecomposition().pseudoInverse();
  }
  void set(const sim::Vector3& deflection_rad, hal::OutputValues& outputs) const {
    const Eigen::VectorXd angles = share_ * deflection_rad;
    for (std::size_t i = 0; i < p_.surfaces.size(); ++i) {
      const double unit = angles[static_cast<Eigen::Index>(i)] / p_.surfaces[i].travel_rad;
      outputs[p_.surfaces[i].output] = static_cast<float>(std::clamp(0.5 + 0.5 * unit, 0.0, 1.0));
    }
  }

 private:
  const sim::FixedWingParameters& p_;
  Eigen::MatrixXd share_;
};

std::unique_ptr<sim::ForcesAndMoments> make_forces(const sim::Vehicle& vehicle) {
  sim::Registry registry;
  sim::register_physics(registry);
  return registry.make_forces(vehicle, sim::RandomSource{1});
}

std::string line_of(std::span<const double> numbers) {
  return fmt::format("{}\n", fmt::join(numbers, ","));
}

std::vector<std::vector<double>> read_rows(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(stream, line);) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      const auto number = config::parse_number(cell);
      if (!number)
        throw std::runtime_error(file.string() + ": found " + cell + ", allowed numbers");
      row.push_back(*number);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

RecordedFlight record_mission(const std::string& vehicle_file,
                              const std::vector<std::string>& overrides, double duration_s) {
  FlightChoice choice;
  choice.vehicle = vehicle_file;
  choice.overrides = overrides;
  const auto setup = std::make_unique<FlightSetup>(choice);
  const auto flight = std::make_unique<Flight>(*setup);
  RecordedFlight record;
  Keeper keeper(record.outputs);
  flight->add(keeper);
  while (!flight->runner().finished() && !flight->autonomy().tracking) flight->step();
  record.start = flight->truth().body;
  record.module_state = copy(flight->dynamics().module_state());
  keeper.on = true;
  while (!flight->runner().finished() && record.outputs.size() < holds(duration_s)) flight->step();
  if (record.outputs.size() < holds(duration_s))
    throw std::runtime_error("the flight is over too soon");
  record.end = flight->truth().body;
  return record;
}

RecordedFlight record_attitude_hold(const std::string& vehicle_file,
                                    const std::vector<std::string>& overrides, double duration_s) {
  const sim::Vehicle vehicle = sim::Vehicle::from_file(vehicle_file, overrides);
  const sim::FixedWing forces(sim::read_fixed_wing(vehicle.root()));
  vehicle.finish();
  const sim::Trim trim =
      sim::find_trim({forces, vehicle.body(), vehicle.environment()}, {17.0, 0.0, 0.0, 100.0});
  sim::RigidBody dynamics(vehicle.body(), vehicle.ground(), vehicle.environment(), forces,
                          sim::RandomSource{1});
  if (!dynamics.set_state(trim.body, trim.module_state))
    throw std::runtime_error("the trim is no state");
  RecordedFlight record;
  record.start = dynamics.truth().body;
  record.module_state = copy(dynamics.module_state());
  const Servos servos(forces.parameters());
  const sim::AirframeParameters& wing = forces.parameters().airframe;
  const auto sign = [](double x) { return x < 0.0 ? -1.0 : 1.0; };
  while (record.outputs.size() < holds(duration_s)) {
    const sim::BodyState& body = dynamics.truth().body;
    const sim::Matrix3 R = body.q_WB.toRotationMatrix();
    const double roll = std::atan2(R(2, 1), R(2, 2));
    const double pitch = std::asin(-R(2, 0));
    const double t_s = sim::to_seconds(dynamics.truth().time);
    const Wish wish = wish_at(t_s);
    constexpr double kRollGain = 0.4;
    constexpr double kPitchGain = 0.8;
    constexpr double kRateGain_s = 0.05;
    const sim::Vector3 effort(kRollGain * (wish.roll_rad - roll) - kRateGain_s * body.w_B.x(),
                              kPitchGain * (wish.pitch_rad - pitch) - kRateGain_s * body.w_B.y(),
                              -kRateGain_s * body.w_B.z());
    const sim::Vector3 deflection(
        trim.deflection.aileron_rad + sign(wing.roll.aileron) * effort.x(),
        trim.deflection.elevator_rad + sign(wing.pitch.elevator) * effort.y(),
        trim.deflection.rudder_rad + sign(wing.yaw.rudder) * effort.z());
    hal::OutputValues outputs = trim.outputs;
    servos.set(deflection, outputs);
    for (const auto& rotor : forces.parameters().propulsion.rotors) {
      outputs[rotor.output] =
          static_cast<float>(std::clamp(trim.throttle + wish.throttle, 0.0, 1.0));
    }
    record.outputs.push_back(outputs);
    dynamics.step(dynamics.truth().time + RecordedFlight::kHold, outputs);
  }
  record.end = dynamics.truth().body;
  return record;
}

Replay::Replay(const sim::Vehicle& vehicle, const RecordedFlight& flight)
    : forces_{make_forces(vehicle)},
      dynamics_{vehicle.body(), vehicle.ground(), vehicle.environment(), *forces_,
                sim::RandomSource{1}},
      flight_{flight} {
  if (!dynamics_.set_state(flight.start, flight.module_state))
    throw std::runtime_error("the start is no state of this vehicle");
}

bool Replay::step(int parts) {
  if (next_ == flight_.outputs.size()) return false;
  const hal::OutputValues& outputs = flight_.outputs[next_++];
  for (int i = 0; i < parts; ++i)
    dynamics_.step(dynamics_.truth().time + RecordedFlight::kHold / parts, outputs);
  return true;
}

void write(const RecordedFlight& flight, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const sim::BodyState& s = flight.start;
  std::vector<double> start{s.p_W.x(),  s.p_W.y(),  s.p_W.z(), s.q_WB.w(), s.q_WB.x(),
                            s.q_WB.y(), s.q_WB.z(), s.v_B.x(), s.v_B.y(),  s.v_B.z(),
                            s.w_B.x(),  s.w_B.y(),  s.w_B.z()};
  start.insert(start.end(), flight.module_state.begin(), flight.module_state.end());
  fmt::output_file((folder / "start.csv").string()).print("{}", line_of(start));
  fmt::ostream outputs = fmt::output_file((folder / "outputs.csv").string());
  for (const hal::OutputValues& row : flight.outputs) {
    const std::vector<double> numbers(row.begin(), row.end());
    outputs.print("{}", line_of(numbers));
  }
}

RecordedFlight read(const std::filesystem::path& folder) {
  RecordedFlight flight;
  const auto start = read_rows(folder / "start.csv");
  if (start.size() != 1 || start[0].size() < kBodyNumbers)
    throw std::runtime_error((folder / "start.csv").string() + ": allowed one line of 13 or more");
  const std::vector<double>& x = start[0];
  flight.start.p_W = {x[0], x[1], x[2]};
  flight.start.q_WB = {x[3], x[4], x[5], x[6]};
  flight.start.v_B = {x[7], x[8], x[9]};
  flight.start.w_B = {x[10], x[11], x[12]};
  flight.module_state.assign(x.begin() + kBodyNumbers, x.end());
  for (const auto& row : read_rows(folder / "outputs.csv")) {
    if (row.size() != hal::kOutputs)
      throw std::runtime_error((folder / "outputs.csv").string() + ": allowed 14 numbers a line");
    hal::OutputValues outputs{};
    std::ranges::transform(row, outputs.begin(), [](double v) { return static_cast<float>(v); });
    flight.outputs.push_back(outputs);
  }
  return flight;
}

}  // namespace rosflight::flight
