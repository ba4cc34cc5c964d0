// SPDX-License-Identifier: BSD-3-Clause
#include "flight/simulation.hpp"

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "companion/offboard.hpp"
#include "companion/parameter.hpp"
#include "python/src/bind.hpp"
#include "python/src/exclusive.hpp"
#include "python/src/interrupt.hpp"
#include "python/src/put.hpp"
#include "python/src/python_wrench.hpp"

namespace rosflight::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using config::Error;

/// Numbers that Python looks at without a copy: they change in place.
struct View {
  static constexpr std::size_t kTruth = 28;
  static constexpr std::size_t kEstimate = 22;

  std::array<double, kTruth> truth{};
  std::array<double, kEstimate> estimate{};
  std::array<double, std::tuple_size_v<hal::OutputValues>> outputs{};
};

link::OffboardControl command_of(const std::string& level, const std::vector<float>& u,
                                 companion::ThrottleAxis axis) {
  std::array<float, link::kCommandAxes> axes{};
  std::copy_n(u.begin(), std::min(u.size(), axes.size()), axes.begin());
  if (level == "mixer") return companion::pass_through(axes);
  if (level == "rates") return companion::body_rates(u[0], u[1], u[2], u[3], axis);
  if (level == "angles") return companion::angles(u[0], u[1], u[2], u[3], axis);
  return companion::surfaces(u[0], u[1], u[2], u[3]);
}

struct Snapshot {
  std::shared_ptr<const flight::Simulation::Moment> moment;
};

class Simulation final : private companion::Listener {
 public:
  explicit Simulation(const flight::FlightChoice& choice) : setup_{choice}, loop_{setup_} {
    loop_.session().add(*this);
    update();
  }
  ~Simulation() override { loop_.session().remove(*this); }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void start() {
    compute("start", [this](Interrupt& interrupt) {
      loop_.start([&] { return interrupt.raised() || external_wrench_.failed(); });
    });
  }
  void step(std::uint64_t steps) {
    compute("step", [this, steps](Interrupt& interrupt) {
      for (std::uint64_t k = 0; k < steps && !interrupt.raised() && !external_wrench_.failed(); ++k)
        loop_.step();
    });
  }
  double time_s() { return sim::to_seconds(use("time").now()); }

  /// Sent now and 100 times per second from now on.
  void command(const std::string& level, const std::vector<float>& u) {
    constexpr double kRate_hz = 100.0;
    constexpr companion::Time kLongest = std::chrono::hours(100'000);
    const auto axis =
        static_cast<companion::ThrottleAxis>(flight::firmware_value(setup_.firmware, "RC_F_AXIS"));
    const companion::SendStatus status =
        use("command").session().offboard().hold(command_of(level, u, axis), kRate_hz, kLongest);
    if (status == companion::SendStatus::kNotFinite || status == companion::SendStatus::kBadMode) {
      throw Error(fmt::format("{}: found {}, allowed finite numbers", level,
                              companion::send_status_text(status)));
    }
  }
  void release() { use("release").session().offboard().release(); }

  void move(const std::string& control, float to) {
    const auto name = std::ranges::find(sim::rc::kControlNames, control);
    const auto which = static_cast<sim::rc::Control>(name - sim::rc::kControlNames.begin());
    const bool possible = name != sim::rc::kControlNames.end() && to >= 0.0F && to <= 1.0F;
    if (!possible || !use("rc").pilot().set(which, to)) {
      throw Error(fmt::format("rc: found {}={}, allowed 0 to 1 for {}", control, to,
                              fmt::join(sim::rc::kControlNames, ", ")));
    }
  }

  std::vector<std::tuple<std::string, double, bool>> parameters() {
    std::vector<std::tuple<std::string, double, bool>> out;
    const companion::ParameterTable& table = use("parameters").session().parameters().table();
    for (std::size_t k = 0; k < table.count(); ++k) {
      const companion::ParameterTable::Entry& entry = table[k];
      const bool whole = entry.value.type == link::ParamType::kInt32;
      if (entry.known)
        out.emplace_back(companion::text_of(entry.name), entry.value.number(), whole);
    }
    return out;
  }
  std::optional<std::pair<double, bool>> parameter(const std::string& name) {
    const auto value = use("parameters").session().parameters().get(name);
    if (!value) return std::nullopt;
    return std::pair{value->number(), value->type == link::ParamType::kInt32};
  }
  /// Steps until the firmware has confirmed the value.
  void set_parameter(const std::string& name, double value) {
    std::string error;
    compute("parameters", [&](Interrupt& interrupt) {
      const auto job = loop_.session().parameters().set(name, value);
      while (job.pending() && !interrupt.raised() && !external_wrench_.failed()) loop_.step();
      if (job.done() && !job.result().ok()) error = job.result().text;
      if (job.failed()) error = job.text();
    });
    if (!error.empty()) throw Error("parameters: " + error);
  }

  void add_fault(const std::string& text) {
    const sim::Fault fault = sim::parse_fault(text);
    setup_.check(fault);
    use("fault").faults().add(fault);
  }
  void end_faults() { use("faults").faults().end_all(loop_.now()); }
  void set_wind(const std::string& text) {
    const flight::WindChoice wind = flight::parse_wind(text);
    use("wind").set_wind(wind.steady_W_m_s, wind.w20_m_s.value_or(0.0));
  }

  void set_state(const std::array<double, 13>& s) {
    sim::BodyState state;
    state.p_W = {s[0], s[1], s[2]};
    const sim::Vector3 v_W{s[3], s[4], s[5]};
    state.q_WB = sim::Quaternion(s[6], s[7], s[8], s[9]);
    state.w_B = {s[10], s[11], s[12]};
    const double norm = state.q_WB.norm();
    if (std::isfinite(norm) && norm > 0.0) state.v_B = state.q_WB.normalized().conjugate() * v_W;
    if (!use("set_state").set_state(state)) {
      throw Error(
          "set_state: found a state that is not finite, has no attitude or is below the ground; "
          "allowed others");
    }
    update();
    external_wrench_.rethrow();
  }
  /// @param function  without arguments; it reads external_wrench().inputs() and changes its wrench(). None: no function.
  void set_forces(const nb::object& function) {
    use("forces").set_external_wrench(function.is_none() ? nullptr : &external_wrench_);
    external_wrench_.set_function(function);
  }
  PythonWrench& external_wrench() { return external_wrench_; }
  void set_held(bool held) { use("held").set_held(held); }

  Snapshot snapshot() { return {use("snapshot").save()}; }
  void restore(const Snapshot& snapshot) {
    use("restore").restore(*snapshot.moment);
    update();
  }

  /// Armed, failsafe, errors.
  std::tuple<bool, bool, int> status() {
    const flight::FirmwareView view = use("status").view();
    return {view.armed, view.failsafe, view.errors};
  }
  bool on_ground() { return use("on_ground").truth().on_ground; }
  bool estimate_usable() { return use("estimate").estimate().usable(); }
  std::vector<std::tuple<double, int, std::string>> take_texts() {
    return std::exchange(texts_, {});
  }
  View& view() { return view_; }
  const flight::FlightSetup& setup() const { return setup_; }

 private:
  /// The simulation, if no other thread computes with it.
  flight::Simulation& use(const char* what) {
    const Exclusive::Use use(exclusive_, what);
    return loop_;
  }

  /// Without the interpreter's lock; a signal of Python ends it.
  template <class F>
  void compute(const char* what, F&& f) {
    const Exclusive::Use use(exclusive_, what);
    Interrupt interrupt;
    {
      const nb::gil_scoped_release free;
      f(interrupt);
      update();
    }
    interrupt.rethrow();
    external_wrench_.rethrow();
  }

  void update() {
    const sim::Truth& truth = loop_.truth();
    const sim::BodyState& body = truth.body;
    double* to = put(view_.truth.data(), body.p_W);
    to = put(to, body.q_WB * body.v_B);
    to = put(to, body.q_WB);
    to = put(to, body.w_B);
    to = put(to, truth.specific_force_B);
    *to++ = truth.battery_voltage_V;
    *to++ = truth.battery_current_A;
    std::ranges::copy(truth.rotor_speed_rad_s, to);
    const autonomy::StateEstimate estimate = loop_.estimate();
    to = put(view_.estimate.data(), estimate.p_W);
    to = put(to, estimate.v_W);
    to = put(to, estimate.q_WB);
    to = put(to, estimate.w_B);
    to = put(to, estimate.wind_W);
    to = put(to, estimate.p_sigma_W_m);
    put(to, estimate.v_sigma_W_m_s);
    std::ranges::copy(loop_.outputs(), view_.outputs.begin());
  }

  void on_event(const companion::Event& event) override {
    constexpr std::size_t kMaxTexts = 10'000;
    const auto* log = std::get_if<companion::LogEvent>(&event);
    if (log == nullptr || texts_.size() >= kMaxTexts) return;
    texts_.emplace_back(companion::to_seconds(log->time), static_cast<int>(log->line.severity),
                        std::string{companion::text_of(log->line.text)});
  }

  Exclusive exclusive_;
  flight::FlightSetup setup_;
  PythonWrench external_wrench_{[this] { return sim::to_seconds(loop_.truth().time); }};
  flight::Simulation loop_;
  View view_;
  std::vector<std::tuple<double, int, std::string>> texts_;
};

/// Read-only; the array keeps the simulation.
template <std::size_t kSize>
auto view_of(std::array<double, kSize> View::*member) {
  return [member](nb::handle self) {
    View& view = nb::cast<Simulation&>(self).view();
    return nb::ndarray<nb::numpy, const double, nb::ndim<1>>((view.*member).data(), {kSize}, self);
  };
}

}  // namespace

void bind_simulation(nb::module_& m) {
  nb::exception<flight::Simulation::Error>(m, "SimulationError", PyExc_RuntimeError);
  nb::class_<Snapshot>(m, "Snapshot");
  nb::class_<Simulation>(m, "Simulation")
      .def(
          "__init__",
          [](Simulation* self, std::string vehicle, std::uint64_t seed,
             std::optional<std::string> wind, std::vector<std::string> faults,
             std::vector<std::string> overrides, std::string link_protocol) {
            flight::FlightChoice choice;
            choice.vehicle = std::move(vehicle);
            choice.seed = seed;
            choice.wind = std::move(wind);
            choice.faults = std::move(faults);
            choice.overrides = std::move(overrides);
            choice.link_protocol = std::move(link_protocol);
            const nb::gil_scoped_release free;
            new (self) Simulation(choice);
          },
          "vehicle"_a, "seed"_a, "wind"_a.none(), "faults"_a, "overrides"_a, "link_protocol"_a)
      .def("start", &Simulation::start)
      .def("step", &Simulation::step, "steps"_a)
      .def_prop_ro("time_s", &Simulation::time_s)
      .def_prop_ro("truth", view_of(&View::truth))
      .def_prop_ro("estimate", view_of(&View::estimate))
      .def_prop_ro("outputs", view_of(&View::outputs))
      .def_prop_ro("on_ground", &Simulation::on_ground)
      .def_prop_ro("estimate_usable", &Simulation::estimate_usable)
      .def_prop_ro("status", &Simulation::status)
      .def_prop_ro("fixed_wing", [](const Simulation& s) { return s.setup().fixed_wing(); })
      .def_prop_ro("hover_throttle", [](const Simulation& s) { return s.setup().hover_throttle; })
      .def("command", &Simulation::command, "level"_a, "axes"_a)
      .def("release", &Simulation::release)
      .def("move", &Simulation::move, "control"_a, "to"_a)
      .def("parameters", &Simulation::parameters)
      .def("parameter", &Simulation::parameter, "name"_a)
      .def("set_parameter", &Simulation::set_parameter, "name"_a, "value"_a)
      .def("add_fault", &Simulation::add_fault, "text"_a)
      .def("end_faults", &Simulation::end_faults)
      .def("set_wind", &Simulation::set_wind, "text"_a)
      .def("set_state", &Simulation::set_state, "state"_a)
      .def("set_held", &Simulation::set_held, "held"_a)
      .def("set_forces", &Simulation::set_forces, "function"_a.none())
      .def_prop_ro("forces_inputs",
                   [](nb::handle self) {
                     auto& inputs = nb::cast<Simulation&>(self).external_wrench().inputs();
                     return nb::ndarray<nb::numpy, const double, nb::ndim<1>>(
                         inputs.data(), {inputs.size()}, self);
                   })
      .def_prop_ro("forces_wrench",
                   [](nb::handle self) {
                     auto& wrench = nb::cast<Simulation&>(self).external_wrench().wrench();
                     return nb::ndarray<nb::numpy, double, nb::ndim<1>>(wrench.data(),
                                                                        {wrench.size()}, self);
                   })
      .def("snapshot", &Simulation::snapshot)
      .def("restore", &Simulation::restore, "snapshot"_a)
      .def("take_texts", &Simulation::take_texts);
}

}  // namespace rosflight::python
