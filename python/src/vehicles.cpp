// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "python/src/bind.hpp"
#include "python/src/exclusive.hpp"
#include "python/src/interrupt.hpp"
#include "python/src/learner.hpp"
#include "python/src/pool.hpp"

namespace rosflight::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using config::Error;

template <class T>
using Row = nb::ndarray<T, nb::numpy, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class T>
using Table = nb::ndarray<T, nb::numpy, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// What distinguishes one vehicle from the others.
struct Individual {
  std::vector<std::string> overrides;  ///< After those of all.
  std::optional<std::string> wind;     ///< none: that of all
  int delay_steps{};
};

/// Learners on a pool of threads, a row of each array for each. What they compute does not depend on the
/// number of threads.
class Vehicles {
 public:
  /// @param individuals  empty, or one for each vehicle.
  Vehicles(const flight::FlightChoice& choice, const TaskConfig& task, const Connection& connection,
           std::size_t count, std::size_t threads, std::uint64_t seed,
           std::vector<Individual> individuals)
      : setup_{choice},
        task_{task},
        connection_{connection},
        individuals_{std::move(individuals)},
        pool_{threads} {
    build(count, seed);
  }

  std::size_t count() const { return learners_.size(); }

  /// Other vehicles of the same kind, with the noise and the episodes of this seed.
  void build(std::size_t count, std::uint64_t seed) {
    learners_.clear();
    learners_.resize(count);
    const sim::RandomSource source{seed};
    const auto make = [&](std::size_t k, flight::FlightSetup& setup, const Connection& connection) {
      learners_[k] = std::make_unique<Learner>(setup, task_, setup_, connection,
                                               source.child(std::to_string(k)).seed());
    };
    if (individuals_.empty()) {
      for (std::size_t k = 0; k < count; ++k) make(k, setup_, connection_);
      pool_.for_each(count, [this](std::size_t k) { learners_[k]->start(); });
    } else {
      setups_.clear();
      setups_.resize(count);
      pool_.for_each(count, [&](std::size_t k) {
        setups_[k] = individual_setup(k);
        Connection connection = connection_;
        connection.delay_steps = individuals_[k].delay_steps;
        make(k, *setups_[k], connection);
        learners_[k]->start();
        setups_[k]->vehicle.drop_file();
      });
    }
    seed_ = seed;
  }

  /// @param seed  of new noise and episodes; none: they go on. @param mask  which of them; none: all.
  void reset(Table<float> observations, std::optional<std::uint64_t> seed,
             std::optional<Row<const bool>> mask) {
    check_rows("observations", observations.shape(0));
    if (mask) check_rows("reset_mask", mask->shape(0));
    compute("reset", [&] {
      if (seed && *seed != seed_) build(count(), *seed);
      pool_.for_each(count(), [&](std::size_t k) {
        if (mask && !mask->data()[k]) return;
        if (seed) {
          learners_[k]->rewind();
        } else {
          learners_[k]->begin_episode();
        }
        learners_[k]->observe(row(observations, k));
      });
    });
  }

  /// @param begin  episodes that have ended begin again at once; `last` then receives their last observations.
  /// @param again  these begin an episode instead of a step; none: nobody.
  void step(Table<const float> actions, Table<float> observations, Row<float> rewards,
            Row<bool> terminated, Row<bool> truncated, Row<bool> success, Table<float> last,
            bool begin, std::optional<Row<const bool>> again) {
    check_rows("actions", actions.shape(0));
    const std::size_t columns = Task::action_size(task_.task);
    if (actions.shape(1) != columns)
      throw Error(fmt::format("actions: found {} columns, allowed {}", actions.shape(1), columns));
    const float* const given = actions.data();
    if (!std::all_of(given, given + actions.size(), [](float a) { return std::isfinite(a); })) {
      throw Error("actions: found NaN or infinity, allowed finite numbers");
    }
    if (again) check_rows("again", again->shape(0));
    compute("step", [&] {
      pool_.for_each(count(), [&](std::size_t k) {
        Learner& learner = *learners_[k];
        Learner::Result result;
        if (again && again->data()[k]) {
          learner.begin_episode();
        } else {
          Action action{};
          std::copy_n(given + k * columns, columns, action.begin());
          result = learner.step(action);
        }
        rewards.data()[k] = result.reward;
        terminated.data()[k] = result.terminated;
        truncated.data()[k] = result.truncated;
        success.data()[k] = result.success;
        if (begin && (result.terminated || result.truncated)) {
          learner.observe(row(last, k));
          learner.begin_episode();
        }
        learner.observe(row(observations, k));
      });
    });
  }

  /// Position 3, velocity 3, attitude 4, rates 3, distance from the target, waypoints or gates passed, outputs.
  static constexpr std::size_t kTruth = 15 + std::tuple_size_v<hal::OutputValues>;
  void truth(Table<double> out) {
    check_rows("out", out.shape(0));
    const Exclusive::Use use(exclusive_, "truth");
    for (std::size_t k = 0; k < count(); ++k) {
      const Learner& learner = *learners_[k];
      const sim::BodyState& body = learner.truth().body;
      const sim::Vector3 v_W = body.q_WB * body.v_B;
      double* to = out.data() + k * kTruth;
      to = std::copy_n(body.p_W.data(), 3, to);
      to = std::copy_n(v_W.data(), 3, to);
      *to++ = body.q_WB.w(), *to++ = body.q_WB.x(), *to++ = body.q_WB.y(), *to++ = body.q_WB.z();
      to = std::copy_n(body.w_B.data(), 3, to);
      *to++ = learner.distance_m();
      *to++ = static_cast<double>(learner.reached());
      std::ranges::copy(learner.outputs(), to);
    }
  }

 private:
  void check_rows(const char* what, std::size_t rows) const {
    if (rows != count())
      throw Error(fmt::format("{}: found {} rows, allowed {}", what, rows, count()));
  }
  static float* row(Table<float>& table, std::size_t k) {
    return table.data() + k * table.shape(1);
  }

  template <class F>
  void compute(const char* what, F&& f) {
    const Exclusive::Use use(exclusive_, what);
    const nb::gil_scoped_release free;
    f();
  }

  std::unique_ptr<flight::FlightSetup> individual_setup(std::size_t k) const {
    const Individual& one = individuals_[k];
    flight::FlightChoice choice = setup_.choice;
    choice.overrides.insert(choice.overrides.end(), one.overrides.begin(), one.overrides.end());
    if (one.wind) choice.wind = one.wind;
    return std::make_unique<flight::FlightSetup>(choice);
  }

  Exclusive exclusive_;
  flight::FlightSetup setup_;
  TaskConfig task_;
  Connection connection_;
  std::vector<Individual> individuals_;
  std::vector<std::unique_ptr<flight::FlightSetup>> setups_;  ///< One for each individual.
  std::uint64_t seed_{};
  std::vector<std::unique_ptr<Learner>> learners_;
  Pool pool_;
};

}  // namespace

void bind_vehicles(nb::module_& m) {
  nb::class_<Individual>(m, "Individual")
      .def(
          "__init__",
          [](Individual* self, std::vector<std::string> overrides, std::optional<std::string> wind,
             int delay_steps) {
            new (self) Individual{std::move(overrides), std::move(wind), delay_steps};
          },
          "overrides"_a, "wind"_a.none(), "delay_steps"_a);
  nb::class_<Vehicles>(m, "Vehicles")
      .def(
          "__init__",
          [](Vehicles* self, std::string vehicle, std::optional<std::string> wind,
             std::vector<std::string> overrides, std::string task, const std::string& action,
             std::string observation, bool link, int substeps, int delay_steps, std::size_t count,
             std::size_t threads, std::uint64_t seed, double episode_s, double altitude_m,
             double start_radius_m, double start_tilt_rad, double start_speed_m_s,
             double start_rates_rad_s, std::vector<Individual> individuals) {
            flight::FlightChoice choice;
            choice.vehicle = std::move(vehicle);
            choice.wind = std::move(wind);
            choice.overrides = std::move(overrides);
            const TaskConfig config{std::move(task),  episode_s,      altitude_m,
                                    start_radius_m,   start_tilt_rad, start_speed_m_s,
                                    start_rates_rad_s};
            const Connection connection{std::move(observation), link, action, substeps,
                                        delay_steps};
            const nb::gil_scoped_release free;
            new (self)
                Vehicles(choice, config, connection, count, threads, seed, std::move(individuals));
          },
          "vehicle"_a, "wind"_a.none(), "overrides"_a, "task"_a, "action"_a, "observation"_a,
          "link"_a, "substeps"_a, "delay_steps"_a, "count"_a, "threads"_a, "seed"_a, "episode_s"_a,
          "altitude_m"_a, "start_radius_m"_a, "start_tilt_rad"_a, "start_speed_m_s"_a,
          "start_rates_rad_s"_a, "individuals"_a)
      .def_prop_ro("count", &Vehicles::count)
      .def("reset", &Vehicles::reset, "observations"_a, "seed"_a.none(), "mask"_a.none())
      .def("step", &Vehicles::step, "actions"_a, "observations"_a, "rewards"_a, "terminated"_a,
           "truncated"_a, "success"_a, "last"_a, "begin"_a, "again"_a.none())
      .def("truth", &Vehicles::truth, "out"_a);
  m.attr("TRUTH_COLUMNS") = Vehicles::kTruth;
  m.def("tasks", &task_names, "Names of the tasks.");
  m.def("observation_size", &Learner::observation_size, "task"_a, "observation"_a,
        "How many numbers an observation of a task has.");
  m.def("action_size", &Task::action_size, "task"_a, "How many numbers an action of a task has.");
}

}  // namespace rosflight::python
