// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/phases.hpp"

#include <memory>
#include <stdexcept>
#include <vector>

namespace rosflight::bench::faults {
namespace {

using flight::Flight;

/// Begin and end of what guidance calls its phases, and the times of the waypoints.
class Watch {
 public:
  void look(Flight& flight, double t_s) {
    if (flight.runner().stage() != flight::Stage::kFly) return;
    if (armed_s_ == 0.0) armed_s_ = t_s;
    const flight::GuidanceOutput& now = flight.autonomy();
    if (now.phase != phase_) {
      phase_ = now.phase;
      begin_.try_emplace(phase_, t_s);
    }
    end_[phase_] = t_s;
    if (now.tracking && (passed_s_.empty() || now.waypoint != waypoint_)) {
      waypoint_ = now.waypoint;
      passed_s_.push_back(t_s);
    }
    if (lifted_s_ == 0.0 && !flight.truth().on_ground && now.phase == std::string("takeoff")) {
      lifted_s_ = t_s;
    }
  }

  std::map<std::string, double> multirotor(double touchdown_s) const {
    return {{"armed", armed_s_ + 0.05},
            {"take-off", middle("takeoff")},
            {"hold", begin("position_hold") + 0.5},
            {"leg", middle_of_leg(1)},
            {"turn", passed(2)},
            {"landing", middle("landing", touchdown_s)},
            {"touch", touchdown_s - 0.1}};
  }
  std::map<std::string, double> fixedwing() const {
    return {{"roll", 0.5 * (begin("takeoff") + lifted_s_)},
            {"lift", lifted_s_ + 0.3},
            {"climb", middle("climb")},
            {"leg", middle_of_leg(1)},
            {"arc", passed(1)},
            {"approach", middle("approach")},
            {"flare", begin("flare") + 0.3}};
  }
  double armed_s() const { return armed_s_; }

 private:
  double begin(const char* phase) const { return begin_.at(phase); }
  double middle(const char* phase) const { return 0.5 * (begin(phase) + end_.at(phase)); }
  double middle(const char* phase, double end_s) const { return 0.5 * (begin(phase) + end_s); }
  /// Time at which the leg to waypoint k began.
  double passed(std::size_t k) const { return passed_s_.at(k); }
  double middle_of_leg(std::size_t k) const { return 0.5 * (passed(k) + passed(k + 1)); }

  std::string phase_;
  std::map<std::string, double> begin_;
  std::map<std::string, double> end_;
  std::vector<double> passed_s_;  ///< Beginning of each leg.
  std::size_t waypoint_{};
  double armed_s_{};
  double lifted_s_{};
};

}  // namespace

Phases find_phases(const flight::FlightSetup& setup,
                   const std::function<void(flight::Flight&, sim::Time)>& also) {
  const auto flight = std::make_unique<Flight>(setup);
  Watch watch;
  flight->set_script([&](Flight& f, sim::Time t) {
    watch.look(f, sim::to_seconds(t));
    if (also) also(f, t);
  });
  flight->run();
  const flight::FlightScore score = flight->score();
  const auto& touchdown = score.landing.touchdown();
  if (!score.success() || !touchdown) {
    throw std::runtime_error("the flight without faults failed: " + score.verdict);
  }
  const double touchdown_s = touchdown->t_s;
  return {setup.fixed_wing() ? watch.fixedwing() : watch.multirotor(touchdown_s), watch.armed_s(),
          touchdown_s};
}

}  // namespace rosflight::bench::faults
