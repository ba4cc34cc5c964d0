// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/task.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "base/constants.hpp"
#include "python/src/attitude_task.hpp"
#include "sim/fixedwing/fixedwing.hpp"
#include "sim/fixedwing/trim.hpp"

namespace rosflight::python {
namespace {

using sim::Vector3;

constexpr double kCos10Deg = 0.98480775301220806;

Vector3 draw_in_ball(sim::RandomStream& random, double radius) {
  Vector3 v;
  do {
    for (int k = 0; k < 3; ++k) v[k] = random.uniform(-1.0, 1.0);
  } while (v.squaredNorm() > 1.0);
  return radius * v;
}

Vector3 along(double course_rad) {
  return {std::cos(course_rad), std::sin(course_rad), 0.0};
}

float* put(const Vector3& v, float* to) {
  for (int k = 0; k < 3; ++k) *to++ = static_cast<float>(v[k]);
  return to;
}

/// Stay at one point.
class Hover final : public Task {
 public:
  using Task::Task;

  Start begin(sim::RandomStream& random) override {
    return draw_start(random, target_W(Vector3::Zero()), 0.0, base::kPi);
  }
  Vector3 target_W(const Vector3& /*p_W*/) const override {
    return {0.0, 0.0, -config_.altitude_m};
  }
  Verdict judge(const sim::Truth& truth, double dt_s) override {
    constexpr double kLost_m = 10.0;
    constexpr double kThere_m = 0.3;
    const double d = distance_m(truth.body.p_W);
    Verdict verdict;
    verdict.lost = truth.on_ground || d > kLost_m || upright(truth.body) < 0.0;
    verdict.reward = turning(truth, dt_s) + dt_s / (1.0 + d * d);
    verdict.success = d < kThere_m;
    return verdict;
  }
};

/// Points, drawn in a ball, one after the other.
class Waypoints final : public Task {
 public:
  static constexpr std::size_t kSize = 3;
  using Task::Task;

  Start begin(sim::RandomStream& random) override {
    random_ = &random;
    target_W_ = next_W_ = {0.0, 0.0, -config_.altitude_m};
    next();
    next();
    reached_ = 0;
    Start start = draw_start(random, target_W_, 0.0, base::kPi);
    place(start.body);
    return start;
  }
  void place(const sim::BodyState& body) override { before_m_ = (target_W_ - body.p_W).norm(); }
  Vector3 target_W(const Vector3& /*p_W*/) const override { return target_W_; }
  Verdict judge(const sim::Truth& truth, double dt_s) override {
    constexpr double kLost_m = 20.0;
    constexpr double kThere_m = 0.5;
    constexpr std::size_t kWaypoints = 5;
    const double d = distance_m(truth.body.p_W);
    Verdict verdict;
    verdict.lost = truth.on_ground || d > kLost_m || upright(truth.body) < 0.0;
    verdict.reward = turning(truth, dt_s) + (before_m_ - d);
    if (d < kThere_m) {
      verdict.reward += 1.0;
      ++reached_;
      next();
    }
    before_m_ = distance_m(truth.body.p_W);
    verdict.done = verdict.success = reached_ >= kWaypoints;
    return verdict;
  }
  float* observe(const SeenState& /*seen*/, float* to) const override {
    return put(next_W_ - target_W_, to);
  }

 private:
  void next() {
    constexpr double kCourse_m = 4.0;
    const Vector3 centre_W{0.0, 0.0, -config_.altitude_m - 1.0};
    target_W_ = next_W_;
    next_W_ = centre_W + draw_in_ball(*random_, kCourse_m);
  }

  sim::RandomStream* random_{nullptr};
  Vector3 target_W_{Vector3::Zero()};
  Vector3 next_W_{Vector3::Zero()};
  double before_m_{0.0};
};

/// A closed course of gates, to be passed forwards in turn.
class Gates final : public Task {
 public:
  static constexpr std::size_t kSize = 9;

  Gates(const TaskConfig& config, const flight::FlightSetup& setup) : Task{config} {
    double reach_m = 0.0;
    for (const sim::RotorParameters& rotor : setup.rotors.rotors)
      reach_m = std::max(reach_m, rotor.p_B.head<2>().norm());
    radius_m_ = reach_m + 0.5 * setup.rotors.propeller.diameter_m;
    if (radius_m_ >= kHalf_m) {
      throw config::Error(
          fmt::format("vehicle: found {}, {:.2f} m wide, allowed less than a gate's {:.2f} m",
                      setup.choice.vehicle, 2.0 * radius_m_, 2.0 * kHalf_m));
    }
  }

  Start begin(sim::RandomStream& random) override {
    constexpr double kCircle_m = 8.0;
    constexpr double kMoved_m = 1.5;
    constexpr double kTurned_rad = base::kPi / 6.0;
    const double turn = random.uniform() < 0.5 ? -1.0 : 1.0;
    const double first_rad = random.uniform(-base::kPi, base::kPi);
    for (std::size_t k = 0; k < gates_.size(); ++k) {
      const double at_rad = first_rad + turn * 2.0 * base::kPi * static_cast<double>(k) /
                                            static_cast<double>(gates_.size());
      const double course_rad =
          at_rad + turn * 0.5 * base::kPi + random.uniform(-kTurned_rad, kTurned_rad);
      gates_[k].centre_W = Vector3{0.0, 0.0, -config_.altitude_m} + kCircle_m * along(at_rad) +
                           draw_in_ball(random, kMoved_m);
      gates_[k].forward_W = along(course_rad);
    }
    reached_ = rewarded_ = 0;
    hit_ = false;
    made_m_ = 0.0;
    constexpr double kBefore_m = 3.0;
    const Gate& gate = gates_.front();
    Start start = draw_start(random, gate.centre_W - kBefore_m * gate.forward_W,
                             std::atan2(gate.forward_W.y(), gate.forward_W.x()), 0.25 * base::kPi);
    place(start.body);
    return start;
  }
  void place(const sim::BodyState& body) override { before_W_ = body.p_W; }
  Vector3 target_W(const Vector3& /*p_W*/) const override { return gate(0).centre_W; }

  void advance(const sim::Truth& now) override {
    const Vector3& p_W = now.body.p_W;
    made_m_ += distance_m(before_W_) - distance_m(p_W);
    for (std::size_t k = 0; k < gates_.size(); ++k) {
      const Crossing crossing = cross(gates_[k], before_W_, p_W);
      if (crossing == Crossing::kFrame) hit_ = true;
      if (crossing == Crossing::kForward && &gates_[k] == &gate(0)) ++reached_;
    }
    before_W_ = p_W;
  }
  Verdict judge(const sim::Truth& truth, double dt_s) override {
    constexpr double kLost_m = 20.0;
    constexpr double kPassed = 1.0;
    Verdict verdict;
    verdict.done = verdict.success = reached_ >= kLaps * gates_.size() && !hit_;
    verdict.lost = truth.on_ground || hit_ || distance_m(truth.body.p_W) > kLost_m;
    verdict.reward =
        turning(truth, dt_s) + made_m_ + kPassed * static_cast<double>(reached_ - rewarded_);
    made_m_ = 0.0;
    rewarded_ = reached_;
    return verdict;
  }
  float* observe(const SeenState& /*seen*/, float* to) const override {
    to = put(gate(0).forward_W, to);
    to = put(gate(1).centre_W - gate(0).centre_W, to);
    return put(gate(1).forward_W, to);
  }

 private:
  static constexpr std::size_t kGates = 6;
  static constexpr std::size_t kLaps = 2;
  static constexpr double kHalf_m = 1.2;   ///< Half of the opening.
  static constexpr double kFrame_m = 0.3;  ///< Width of the frame around it.

  struct Gate {
    Vector3 centre_W{Vector3::Zero()};
    Vector3 forward_W{Vector3::UnitX()};
  };
  enum class Crossing { kNone, kForward, kBackward, kFrame };

  const Gate& gate(std::size_t ahead) const { return gates_[(reached_ + ahead) % kGates]; }

  /// A ball of the vehicle's size that moves straight on through the gate's plane.
  Crossing cross(const Gate& gate, const Vector3& from_W, const Vector3& to_W) const {
    const double a_m = gate.forward_W.dot(from_W - gate.centre_W);
    const double b_m = gate.forward_W.dot(to_W - gate.centre_W);
    if ((a_m < 0.0) == (b_m < 0.0)) return Crossing::kNone;
    const Vector3 at_W = from_W + a_m / (a_m - b_m) * (to_W - from_W) - gate.centre_W;
    const double aside_m = std::abs(at_W.y() * gate.forward_W.x() - at_W.x() * gate.forward_W.y());
    const double off_m = std::max(aside_m, std::abs(at_W.z()));
    if (off_m > kHalf_m + kFrame_m + radius_m_) return Crossing::kNone;
    if (off_m > kHalf_m - radius_m_) return Crossing::kFrame;
    return b_m >= 0.0 ? Crossing::kForward : Crossing::kBackward;
  }

  double radius_m_{};
  std::array<Gate, kGates> gates_{};
  Vector3 before_W_{Vector3::Zero()};
  std::size_t rewarded_{0};
  bool hit_{false};
  double made_m_{0.0};
};

/// Come down on a point of the ground.
class Landing final : public Task {
 public:
  Landing(const TaskConfig& config, const Vector3& rest_W) : Task{config}, rest_W_{rest_W} {}

  Start begin(sim::RandomStream& random) override {
    touched_ = false;
    Start start =
        draw_start(random, rest_W_ - config_.altitude_m * Vector3::UnitZ(), 0.0, base::kPi);
    place(start.body);
    return start;
  }
  void place(const sim::BodyState& body) override {
    above_ = body;
    before_m_ = (rest_W_ - body.p_W).norm();
  }
  Vector3 target_W(const Vector3& /*p_W*/) const override { return rest_W_; }

  void advance(const sim::Truth& now) override {
    if (touched_) return;
    touched_ = now.on_ground;
    if (!touched_) above_ = now.body;
  }
  Verdict judge(const sim::Truth& truth, double dt_s) override {
    constexpr double kLost_m = 20.0;
    constexpr double kBest = 5.0;
    const double d = distance_m(truth.body.p_W);
    Verdict verdict;
    verdict.reward = turning(truth, dt_s) + (before_m_ - d);
    before_m_ = d;
    if (!touched_) {
      verdict.lost = d > kLost_m || upright(truth.body) < 0.0;
      return verdict;
    }
    constexpr double kNear_m = 0.5;
    constexpr double kSoft_m_s = 1.0;
    constexpr double kHard_m_s = 2.0;
    const Vector3 off_W = above_.p_W - rest_W_;
    const double off_m = off_W.head<2>().norm();
    const double speed_m_s = above_.v_B.norm();
    const bool level = upright(above_) > kCos10Deg;
    verdict.success = off_m < kNear_m && speed_m_s < kSoft_m_s && level;
    verdict.lost = speed_m_s > kHard_m_s || !level;
    verdict.done = true;
    if (!verdict.lost)
      verdict.reward += kBest / ((1.0 + off_m * off_m) * (1.0 + speed_m_s * speed_m_s));
    return verdict;
  }

 private:
  Vector3 rest_W_;
  bool touched_{false};
  sim::BodyState above_;  ///< The last state before the ground acted.
  double before_m_{0.0};
};

/// Fly along a level line, in its direction.
class FixedWingLine final : public Task {
 public:
  static constexpr std::size_t kSize = 4;

  FixedWingLine(const TaskConfig& config, const flight::FlightSetup& setup)
      : Task{config}, wind_W_{setup.vehicle.environment().wind.steady_W_m_s} {
    const sim::FixedWing forces{sim::read_fixed_wing(setup.vehicle.root())};
    const double cruise_m_s =
        std::get<flight::FixedWingPlan>(setup.plan).autonomy.flight.controller.cruise_m_s;
    try {
      trim_ = sim::find_trim({forces, setup.vehicle.body(), setup.vehicle.environment()},
                             {.airspeed_m_s = cruise_m_s, .height_m = config.altitude_m});
    } catch (const std::runtime_error& error) {
      throw config::Error(
          fmt::format("vehicle: found {}, allowed one that can hold its cruise of {} m/s: it {}",
                      setup.choice.vehicle, cruise_m_s, error.what()));
    }
  }

  Start begin(sim::RandomStream& random) override {
    constexpr double kOff_rad = 0.5;
    const double course_rad = random.uniform(-base::kPi, base::kPi);
    forward_W_ = along(course_rad);
    point_W_ = above_start_W();
    // The nose of a trim points up; what is drawn comes on top.
    Start start = draw_start(random, point_W_, course_rad, kOff_rad);
    sim::BodyState& body = start.body;
    body.q_WB = body.q_WB * trim_.body.q_WB;
    body.v_B += trim_.body.v_B + body.q_WB.conjugate() * wind_W_;
    start.module_state = trim_.module_state;
    off_W_ = body.p_W - point_W_;
    return start;
  }
  /// The line is moved, so that the vehicle is beside it as it was drawn; its altitude stays.
  void place(const sim::BodyState& body) override {
    point_W_.head<2>() = (body.p_W - off_W_).head<2>();
  }
  Vector3 target_W(const Vector3& p_W) const override {
    return point_W_ + forward_W_.dot(p_W - point_W_) * forward_W_;
  }
  Verdict judge(const sim::Truth& truth, double dt_s) override {
    constexpr double kLost_m = 100.0;
    constexpr double kWide_m = 5.0;
    constexpr double kThere_m = 2.0;
    const double d = distance_m(truth.body.p_W);
    const Vector3 v_W = truth.body.q_WB * truth.body.v_B;
    const double speed_m_s = v_W.norm();
    const double forward = speed_m_s > 0.0 ? std::max(forward_W_.dot(v_W) / speed_m_s, 0.0) : 0.0;
    Verdict verdict;
    verdict.lost = truth.on_ground || d > kLost_m || upright(truth.body) < 0.0;
    verdict.reward = turning(truth, dt_s) + dt_s * forward / (1.0 + d * d / (kWide_m * kWide_m));
    verdict.success = d < kThere_m && forward > kCos10Deg;
    return verdict;
  }
  float* observe(const SeenState& seen, float* to) const override {
    to = put(forward_W_, to);
    *to++ = static_cast<float>((seen.v_W - seen.wind_W).norm());
    return to;
  }

 private:
  Vector3 above_start_W() const { return {0.0, 0.0, -config_.altitude_m}; }

  Vector3 wind_W_;
  sim::Trim trim_;
  Vector3 forward_W_{Vector3::UnitX()};
  Vector3 point_W_{Vector3::Zero()};  ///< A point of the line.
  Vector3 off_W_{Vector3::Zero()};    ///< From there to the start.
};

struct Kind {
  const char* name;
  bool fixed_wing;
  std::size_t size;
  std::size_t actions{kActions};
};
constexpr std::array kKinds{
    Kind{"hover", false, 0},
    Kind{"waypoints", false, Waypoints::kSize},
    Kind{"gates", false, Gates::kSize},
    Kind{"landing", false, 0},
    Kind{"fixed_wing_line", true, FixedWingLine::kSize},
    Kind{"attitude", false, 0, kAttitudeActions},
};

const Kind& kind_of(const std::string& name) {
  const auto found = std::ranges::find(kKinds, name, &Kind::name);
  if (found == kKinds.end()) {
    throw config::Error(
        fmt::format("task: found '{}', allowed {}", name, fmt::join(task_names(), ", ")));
  }
  return *found;
}

}  // namespace

std::vector<std::string> task_names() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::size_t Task::observation_size(const std::string& task) {
  return kind_of(task).size;
}

std::size_t Task::action_size(const std::string& task) {
  return kind_of(task).actions;
}

double Task::turning(const sim::Truth& truth, double dt_s) {
  constexpr double kTurning = 0.02;  // weight of the squared rate [s/rad^2]
  return -dt_s * kTurning * truth.body.w_B.squaredNorm();
}

double Task::upright(const sim::BodyState& body) {
  return (body.q_WB * Vector3::UnitZ()).z();
}

std::unique_ptr<Task> Task::make(const TaskConfig& config, const flight::FlightSetup& setup,
                                 const Vector3& rest_W) {
  const Kind& kind = kind_of(config.task);
  if (setup.quadplane()) {
    throw config::Error(
        fmt::format("vehicle: found {}, a quad-plane, allowed a multirotor or a fixed wing",
                    setup.choice.vehicle));
  }
  if (kind.fixed_wing != setup.fixed_wing()) {
    const auto text = [](bool fixed_wing) { return fixed_wing ? "fixed wing" : "multirotor"; };
    throw config::Error(fmt::format("vehicle: found {}, a {}, allowed a {}", setup.choice.vehicle,
                                    text(setup.fixed_wing()), text(kind.fixed_wing)));
  }
  const std::string& name = config.task;
  if (name == "waypoints") return std::make_unique<Waypoints>(config);
  if (name == "gates") return std::make_unique<Gates>(config, setup);
  if (name == "landing") return std::make_unique<Landing>(config, rest_W);
  if (name == "fixed_wing_line") return std::make_unique<FixedWingLine>(config, setup);
  if (name == "attitude") return make_attitude_task(config, setup);
  return std::make_unique<Hover>(config);
}

Task::Start Task::draw_start(sim::RandomStream& random, const Vector3& at_W, double heading_rad,
                             double heading_spread_rad) const {
  Start start;
  sim::BodyState& state = start.body;
  state.p_W = at_W + draw_in_ball(random, config_.start_radius_m);
  const double yaw = heading_rad + random.uniform(-heading_spread_rad, heading_spread_rad);
  const double axis_rad = random.uniform(-base::kPi, base::kPi);
  const double tilt = random.uniform(0.0, config_.start_tilt_rad);
  state.q_WB = Eigen::AngleAxisd(tilt, along(axis_rad)) * Eigen::AngleAxisd(yaw, Vector3::UnitZ());
  state.v_B = state.q_WB.conjugate() * draw_in_ball(random, config_.start_speed_m_s);
  state.w_B = draw_in_ball(random, config_.start_rates_rad_s);
  return start;
}

}  // namespace rosflight::python
