// SPDX-License-Identifier: BSD-3-Clause
// Flies every mission that the project answers for, in lock-step and on the estimate, and prints
// how it went: one JSON object, NAME -> {QUANTITY: number}.
//
// usage: missions [NAME...]
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "bench/mission_rows.hpp"
#include "flight/flight.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file
using rosflight::bench::Figures;
using rosflight::sim::Time;
using rosflight::sim::Vector3;

using rosflight::base::kDegPerRad;

struct Row {
  const char* name;
  const char* mission;
  const char* wind;   ///< "" for calm; SPEED,FROM,W20.
  const char* fault;  ///< "" for none.
  int seeds{1};
};

// Faults begin in the middle of the mission, which starts some 8 s after power-up.
constexpr Row kRows[]{
    {"default", "default", "", ""},
    {"figure_eight", "figure_eight", "", ""},
    {"survey", "survey", "", ""},
    {"hover", "hover", "6,270,6", ""},
    {"gnss_loss", "default", "", "gnss@20:20"},
    {"gnss_loss_fast", "figure_eight", "", "gnss@30:20"},
    {"gnss_loss_wind", "default", "6,270,6", "gnss@20:20"},
    {"baro_step", "default", "", "baro_step=5@20"},
    {"mag_turned", "default", "", "mag_turned=30@20"},
    {"accel_step_x", "default", "", "accel_step_x=0.3@20"},
    {"accel_step_y", "default", "", "accel_step_y=0.3@20"},
    {"accel_step_z", "default", "", "accel_step_z=0.3@20"},
    {"gyro_step_x", "default", "", "gyro_step_x=0.02@20"},
    {"gyro_step_y", "default", "", "gyro_step_y=0.02@20"},
    {"gyro_step_z", "default", "", "gyro_step_z=0.02@20"},
    {"default_gusts", "default", "6,270,6", "", 100},
};

/// When the fault of a row begins; what came before does not count.
double from_s(const Row& row) {
  const char* const at = std::strchr(row.fault, '@');
  return at == nullptr ? 0.0 : std::atof(at + 1);
}

/// Sums of one flight, from the start of its fault on.
struct Score {
  ErrorStatistics own;    ///< Horizontal, less the slow error of the satellites.
  ErrorStatistics total;  ///< Horizontal, as it was.
  double max_tilt_deg{};
  double max_height_error_m{};
  bool landed{};     ///< Softly, by the truth, and disarmed.
  bool completed{};  ///< Outcome mission_done.

  double from_s{};

  void look(Flight& flight) {
    const GuidanceOutput& guidance = flight.autonomy();
    if (flight.runner().stage() != Stage::kFly) return;
    if (rosflight::sim::to_seconds(flight.now()) < from_s) return;
    const auto& truth = flight.truth().body;
    const double cosine = (truth.q_WB * Vector3::UnitZ()).z();
    max_tilt_deg = std::max(max_tilt_deg, kDegPerRad * std::acos(std::clamp(cosine, -1.0, 1.0)));
    if (!guidance.tracking) return;
    own.add((flight.seen_position_W() - guidance.setpoint.p_W).head<2>().norm());
    total.add((truth.p_W - guidance.setpoint.p_W).head<2>().norm());
    max_height_error_m =
        std::max(max_height_error_m, std::abs(truth.p_W.z() - guidance.setpoint.p_W.z()));
  }
};

Score fly(const Row& row, std::uint64_t seed) {
  FlightChoice choice;
  choice.mission = row.mission;
  choice.seed = seed;
  if (std::strlen(row.wind) > 0) choice.wind = row.wind;
  if (std::strlen(row.fault) > 0) choice.faults = {row.fault};
  const FlightSetup setup(choice);
  const auto flight = std::make_unique<Flight>(setup);
  Score score;
  score.from_s = from_s(row);
  flight->set_script([&score](Flight& f, Time /*t*/) { score.look(f); });
  flight->run();
  const FlightScore judged = flight->score();
  score.landed = judged.landing.soft(judged.limits) && flight->runner().disarmed();
  score.completed = judged.success();
  return score;
}

Figures figures_of(const Row& row) {
  Figures out;
  if (row.seeds == 1) {
    const Score s = fly(row, 1);
    out["horizontal_rms_m"] = s.own.rms();
    out["horizontal_max_m"] = s.own.max;
    out["total_rms_m"] = s.total.rms();
    out["height_max_m"] = s.max_height_error_m;
    out["max_tilt_deg"] = s.max_tilt_deg;
    out["landed"] = s.landed ? 1.0 : 0.0;
    out["completed"] = s.completed ? 1.0 : 0.0;
  } else {
    double completed = 0.0, worst_m = 0.0, tilt_deg = 0.0;
    for (int seed = 1; seed <= row.seeds; ++seed) {
      const Score s = fly(row, static_cast<std::uint64_t>(seed));
      completed += s.completed ? 1.0 : 0.0;
      worst_m = std::max(worst_m, s.own.rms());
      tilt_deg = std::max(tilt_deg, s.max_tilt_deg);
    }
    out["completed"] = completed;
    out["worst_horizontal_rms_m"] = worst_m;
    out["max_tilt_deg"] = tilt_deg;
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  return rosflight::bench::print_rows("missions", kRows, figures_of, argc, argv);
}
