// SPDX-License-Identifier: BSD-3-Clause
#include "flight/fly.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "python/src/bind.hpp"
#include "python/src/interrupt.hpp"
#include "python/src/series.hpp"

namespace rosflight::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;

/// What a flight is looked at for without its log.
class FlightSeries {
 public:
  /// @param every  steps between two rows; 0: none.
  explicit FlightSeries(unsigned every) : every_{every} {}

  void step(const flight::Flight& flight) {
    if (every_ == 0 || steps_++ % every_ != 0) return;
    const sim::Truth& truth = flight.truth();
    const sim::BodyState& body = truth.body;
    const autonomy::StateEstimate& estimate = flight.runner().estimate();
    const flight::GuidanceOutput& guidance = flight.autonomy();
    constexpr double kNone = flight::ErrorStatistics::kNone;
    series_.add(t_, sim::to_seconds(truth.time));
    series_.add_vector(p_, body.p_W);
    series_.add_vector(v_, body.q_WB * body.v_B);
    series_.add(q_, body.q_WB.w(), body.q_WB.x(), body.q_WB.y(), body.q_WB.z());
    series_.add_vector(w_, body.w_B);
    series_.add_vector(estimate_, estimate.p_W);
    series_.add_vector(setpoint_,
                       guidance.tracking ? guidance.setpoint.p_W : sim::Vector3::Constant(kNone));
    series_.add(battery_, truth.battery_voltage_V);
  }
  nb::dict take() { return every_ == 0 ? nb::dict{} : series_.take(); }

 private:
  unsigned every_;
  unsigned steps_{0};
  Series series_;
  std::size_t t_{series_.column("t_s")};
  std::size_t p_{series_.column("position_m", 3)};
  std::size_t v_{series_.column("velocity_m_s", 3)};
  std::size_t q_{series_.column("attitude", 4)};
  std::size_t w_{series_.column("rates_rad_s", 3)};
  std::size_t estimate_{series_.column("estimated_position_m", 3)};
  std::size_t setpoint_{series_.column("setpoint_m", 3)};
  std::size_t battery_{series_.column("battery_V")};
};

nb::list notes_of(const std::vector<flight::FlightNote>& notes) {
  nb::list out;
  for (const flight::FlightNote& note : notes) {
    out.append(nb::make_tuple(sim::to_seconds(note.t), note.source, static_cast<int>(note.severity),
                              note.text));
  }
  return out;
}

/// Vehicle, mission, seed, wind, faults, overrides, state, pilot and link protocol, as ./rosflight fly takes them.
using Choice = std::tuple<std::string, std::string, std::uint64_t, std::optional<std::string>,
                          std::vector<std::string>, std::vector<std::string>, std::string,
                          std::string, std::string>;

flight::FlightChoice choice_of(Choice given) {
  flight::FlightChoice choice;
  std::tie(choice.vehicle, choice.mission, choice.seed, choice.wind, choice.faults,
           choice.overrides, choice.state, choice.pilot, choice.link_protocol) = std::move(given);
  return choice;
}

/// Reads and checks what fly() would read. @returns the vehicle with all that it extends, and the mission, as texts.
nb::tuple check(Choice choice) {
  const flight::FlightSetup setup(choice_of(std::move(choice)));
  return nb::make_tuple(setup.vehicle.text(), setup.mission_text);
}

/// ./rosflight fly. @returns summary as JSON, series, notes, flight folder.
nb::tuple fly(Choice choice, std::string log, std::optional<std::string> out,
              unsigned series_every) {
  flight::FlyOptions options;
  options.choice = choice_of(std::move(choice));
  options.leave_folder = out || log != "none";
  options.log = std::move(log);
  if (out) options.folder = *out;

  std::vector<flight::FlightNote> notes;
  FlightSeries series(series_every);
  Interrupt interrupt;
  options.on_note = [&notes](const flight::FlightNote& note) { notes.push_back(note); };
  options.on_step = [&series](const flight::Flight& flight) { series.step(flight); };
  options.interrupted = [&interrupt] { return interrupt.raised(); };
  std::string summary;
  std::string folder;
  {
    const nb::gil_scoped_release free;
    const flight::FlightSummary flown = flight::fly(options);
    summary = flight::summary_json(flown);
    folder = flown.folder.string();
  }
  interrupt.rethrow();
  return nb::make_tuple(summary, series.take(), notes_of(notes), folder);
}

}  // namespace

void bind_fly(nb::module_& m) {
  m.def(
      "check", &check, "choice"_a,
      nb::sig("def check(choice: tuple[str, str, int, str | None, list[str], list[str], str, str, "
              "str]) -> tuple[str, str]"));
  m.def("fly", &fly, "choice"_a, "log"_a, "out"_a.none(), "series_every"_a,
        nb::sig("def fly(choice: tuple[str, str, int, str | None, list[str], list[str], str, str, "
                "str], log: str, out: str | None, series_every: int) -> tuple[str, dict[str, "
                "numpy.typing.NDArray[numpy.float64]], list[tuple[float, str, int, str]], str]"));
}

}  // namespace rosflight::python
