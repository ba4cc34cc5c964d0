// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "sim/dynamics/rigid_body.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::flight {

/// A piece of a closed-loop flight in the air: where it began and what the outputs were then, each
/// held for 2.5 ms. With it the same flight can be flown again in open loop, here and elsewhere.
struct RecordedFlight {
  static constexpr sim::Time kHold{2500};

  sim::BodyState start;
  std::vector<double> module_state;  ///< State of the forces-and-moments module at the start.
  std::vector<hal::OutputValues> outputs;
  sim::BodyState end;
};

/// The default mission of the vehicle, with the firmware and over the link, from the moment it
/// follows its first leg. For multirotors.
RecordedFlight record_mission(const std::string& vehicle_file,
                              const std::vector<std::string>& overrides, double duration_s);

/// Attitudes and throttles in turn, held by proportional and derivative feedback of the true state,
/// beginning trimmed at 17 m/s and 100 m. For fixed wings.
RecordedFlight record_attitude_hold(const std::string& vehicle_file,
                                    const std::vector<std::string>& overrides, double duration_s);

/// The recorded flight again, in open loop.
class Replay {
 public:
  Replay(const sim::Vehicle& vehicle, const RecordedFlight& flight);

  /// One more held output, in steps of kHold/parts. @returns false when there is none left.
  bool step(int parts);
  const sim::RigidBody& dynamics() const { return dynamics_; }

 private:
  std::unique_ptr<sim::ForcesAndMoments> forces_;
  sim::RigidBody dynamics_;
  const RecordedFlight& flight_;
  std::size_t next_{0};
};

/// start.csv (one line: p, q (w x y z), v, w, states of the module) and outputs.csv.
/// @throws std::runtime_error if a file cannot be written or read, or is malformed.
void write(const RecordedFlight& flight, const std::filesystem::path& folder);
RecordedFlight read(const std::filesystem::path& folder);

}  // namespace rosflight::flight
