// SPDX-License-Identifier: BSD-3-Clause
// Records a closed-loop flight and flies it again in open loop, for comparison with JSBSim.
//
// usage: open_loop record VEHICLE_FILE FOLDER SECONDS [KEY=VALUE...]
//        open_loop replay VEHICLE_FILE FOLDER PARTS OUT.csv [KEY=VALUE...]
//
// A line of OUT.csv: time, p_W, q_WB (w x y z), v_B, w_B; every 2.5 ms, beginning at the start.
#include <fmt/format.h>
#include <fmt/os.h>

#include <cstdlib>
#include <iostream>

#include "flight/jsbsim/open_loop.hpp"

namespace {

using namespace rosflight;          // NOLINT(google-build-using-namespace): a program of one file
using namespace rosflight::flight;  // NOLINT(google-build-using-namespace)

std::string line_of(const sim::Truth& truth) {
  const sim::BodyState& s = truth.body;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", sim::to_seconds(truth.time),
                     s.p_W.x(), s.p_W.y(), s.p_W.z(), s.q_WB.w(), s.q_WB.x(), s.q_WB.y(),
                     s.q_WB.z(), s.v_B.x(), s.v_B.y(), s.v_B.z(), s.w_B.x(), s.w_B.y(), s.w_B.z());
}

int run(const std::vector<std::string>& words) {
  const bool record = words.size() >= 4 && words[0] == "record";
  const bool replay = words.size() >= 5 && words[0] == "replay";
  if (!record && !replay) {
    std::cerr << "usage: open_loop record VEHICLE_FILE FOLDER SECONDS [KEY=VALUE...]\n"
                 "       open_loop replay VEHICLE_FILE FOLDER PARTS OUT.csv [KEY=VALUE...]\n";
    return 2;
  }
  const std::vector<std::string> overrides(words.begin() + (record ? 4 : 5), words.end());
  const sim::Vehicle vehicle = sim::Vehicle::from_file(words[1], overrides);
  if (record) {
    const double seconds = std::stod(words[3]);
    write(vehicle.type() == "fixedwing" ? record_attitude_hold(words[1], overrides, seconds)
                                        : record_mission(words[1], overrides, seconds),
          words[2]);
    return 0;
  }
  const RecordedFlight flight = read(words[2]);
  Replay again(vehicle, flight);
  fmt::ostream out = fmt::output_file(words[4]);
  const int parts = std::stoi(words[3]);
  do out.print("{}", line_of(again.dynamics().truth()));
  while (again.step(parts));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::cerr << "open_loop: " << e.what() << "\n";
    return 2;
  }
}
