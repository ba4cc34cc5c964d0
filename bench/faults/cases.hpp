// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// What the fault campaign flies: every single fault in every phase of a mission, and pairs of faults.
namespace rosflight::bench::faults {

/// A kind of vehicle with its mission.
struct Subject {
  const char* vehicle;
  bool fixed_wing;
  std::vector<const char*> phases;       ///< Phases of the single faults, defined in phases.hpp.
  std::vector<const char*> pair_phases;  ///< Phases of the pairs.
  unsigned motors;
  unsigned surfaces;
  double
      wind_m_s;  ///< The strongest wind of random flights; within its limit in vehicles/README.md.
};
const std::vector<Subject>& subjects();

/// One fault as `--fault` spells it, without its time: "imu:0.3", "baro_step=5".
struct FaultRow {
  std::string text;
  bool first_of_kind;  ///< Takes part in the pairs.
};
/// The faults that a vehicle of this kind can have, in the order of the matrix.
std::vector<FaultRow> fault_rows(bool fixed_wing);

/// "imu:0.3" at 12.5 s: "imu@12.5:0.3".
std::string at_time(const std::string& fault, double t_s);

/// One flight of the campaign, or a random one.
struct Case {
  std::size_t subject{};
  std::string pilot;   ///< "hover" or "idle".
  std::string first;   ///< A row of fault_rows().
  std::string second;  ///< Second fault of a pair, in the campaign 1 s later; else empty.
  std::string phase;   ///< When the first fault begins: a phase, or kRandom, which `moments` says.
  /// The receiver's failsafe flies its own command though the companion's commands are fresh.
  bool failsafe_command{};
  std::uint64_t seed{1};
  // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers leave it out
  std::string wind{};  ///< As `--wind` takes it; empty: calm.
  /// When the faults of kRandom begin: 0 is arming, 1 the touchdown of the flight without faults in calm air.
  std::array<double, 2> moments{};
  double second_after_s{};  ///< > 0: the second fault begins this long after the first.
};
inline constexpr const char* kRandom = "random";
/// What stands for kRandom when the flight has been flown: whether the vehicle had taken off when the first
/// fault began, as docs/scoring.md counts it (0.5 m above the ground, a fixed wing 2 m).
inline constexpr const char* kBeforeLiftOff = "before lift-off";
inline constexpr const char* kAfterLiftOff = "after lift-off";
/// Every flight: singles, then those with the failsafe command, then pairs, each in both orders.
std::vector<Case> all_cases();

/// What continuous integration flies: of the singles a fixed quarter, with each pilot other cells; of
/// the pairs each one once, in one of its two phases, with one of the pilots and in one order.
std::vector<Case> quarter();

}  // namespace rosflight::bench::faults
