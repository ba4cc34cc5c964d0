// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/cases.hpp"

#include <fmt/format.h>

#include <functional>
#include <utility>

namespace rosflight::bench::faults {
namespace {

enum class For : unsigned char { kBoth, kMultirotor, kFixedWing };

struct Listed {
  const char* text;
  bool first_of_kind;
  For vehicles{For::kBoth};
};

constexpr Listed kListed[]{
    {"imu:0.3", true},
    {"imu_nan:0.3", true},
    {"imu_stuck:0.3", true},
    {"imu_stuck:1", false},
    {"mag", true},
    {"baro", true},
    {"gnss:20", true},
    {"gnss", true},
    {"gnss_step=30", true},
    {"gnss_delay=0.5", true},
    {"diff_pressure", true, For::kFixedWing},
    {"pitot_blocked", true, For::kFixedWing},
    {"range", true},
    {"battery", true},
    {"battery_low", true},
    {"rc_silence:2", true},
    {"rc_silence:10", true},
    {"rc_frame_loss:2", true},
    {"link_cut:3", true},
    {"link_cut:8", false},
    {"link_noise=0.01", true},
    {"companion_stall:1", true},
    {"crash", true},
    {"hang", true},
    {"baro_step=5", true},
    {"baro_step=-10", false},
    {"baro_step=50", false},
    {"mag_turned=30", true},
    {"mag_turned=90", false},
    {"mag_turned=180", false},
    {"accel_step_x=0.3", true},
    {"accel_step_x=1", false},
    {"accel_step_z=3", true},
    {"gyro_step_x=0.02", true},
    {"gyro_step_x=0.3", false},
    {"gyro_step_y=0.1", true},
    {"gyro_step_z=0.1", true},
    {"gyro_step_z=0.5", false},
    {"motor0_partial=0.8", true},
    {"motor0_partial=0.5", false},
    {"motor0_dead:1", true},
    {"servo0_stuck", true, For::kFixedWing},
    {"servo1_stuck", false, For::kFixedWing},
    {"servo2_stuck", false, For::kFixedWing},
};

/// Receives each flight of the campaign, and whether it belongs to the quarter.
using Visit = std::function<void(const Case&, bool in_quarter)>;

constexpr std::array kPilots{"hover", "idle"};
constexpr std::size_t kQuarter = 4;

/// The quarter has every fourth phase of each fault: with each fault another one, and with the idle
/// stick others than with the hovering one.
void visit_singles(const Visit& visit) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    const auto rows = fault_rows(subjects()[s].fixed_wing);
    for (std::size_t pilot = 0; pilot < kPilots.size(); ++pilot) {
      for (std::size_t row = 0; row < rows.size(); ++row) {
        for (std::size_t phase = 0; phase < subjects()[s].phases.size(); ++phase) {
          const Case c{s, kPilots[pilot], rows[row].text, "", subjects()[s].phases[phase], false};
          const bool mine = (row + phase + 2 * pilot) % kQuarter == 0;
          visit(c, mine);
        }
      }
    }
  }
}

/// Silence of the receiver with the failsafe command of ROSflight 2.x.
void visit_failsafe_commands(const Visit& visit) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    std::size_t row = 0;
    for (const char* fault : {"rc_silence:2", "rc_silence:10", "rc_frame_loss:2"}) {
      for (std::size_t phase = 0; phase < subjects()[s].phases.size(); ++phase) {
        visit({s, "hover", fault, "", subjects()[s].phases[phase], true},
              (row + phase) % kQuarter == 0);
      }
      ++row;
    }
  }
}

/// Each pair in both orders. The four blocks of a vehicle, two phases with two pilots, fly different pairs
/// in the quarter, each in one order.
void visit_pairs(const Visit& visit) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    std::vector<std::string> kinds;
    for (const FaultRow& row : fault_rows(subjects()[s].fixed_wing)) {
      if (row.first_of_kind) kinds.push_back(row.text);
    }
    for (std::size_t pilot = 0; pilot < kPilots.size(); ++pilot) {
      for (std::size_t phase = 0; phase < subjects()[s].pair_phases.size(); ++phase) {
        const std::size_t block = phase + 2 * pilot;
        std::size_t pair = 0;
        for (std::size_t a = 0; a < kinds.size(); ++a) {
          for (std::size_t b = a + 1; b < kinds.size(); ++b, ++pair) {
            Case c{s, kPilots[pilot], kinds[a], kinds[b], subjects()[s].pair_phases[phase], false};
            const bool mine = pair % kQuarter == block;
            const bool reversed = pair / kQuarter % 2 == 1;
            visit(c, mine && !reversed);
            std::swap(c.first, c.second);
            visit(c, mine && reversed);
          }
        }
      }
    }
  }
}

void visit_all(const Visit& visit) {
  visit_singles(visit);
  visit_failsafe_commands(visit);
  visit_pairs(visit);
}

}  // namespace

const std::vector<Subject>& subjects() {
  static const std::vector<Subject> list{
      {"multirotor",
       false,
       {"armed", "take-off", "hold", "leg", "turn", "landing", "touch"},
       {"leg", "landing"},
       4,
       0,
       6.0},
      {"anaconda",
       true,
       {"roll", "lift", "climb", "leg", "arc", "approach", "flare"},
       {"leg", "approach"},
       1,
       3,
       5.0}};
  return list;
}

std::vector<FaultRow> fault_rows(bool fixed_wing) {
  std::vector<FaultRow> out;
  for (const Listed& row : kListed) {
    const bool fits = row.vehicles == For::kBoth || (row.vehicles == For::kFixedWing) == fixed_wing;
    if (fits) out.push_back({row.text, row.first_of_kind});
  }
  return out;
}

std::string at_time(const std::string& fault, double t_s) {
  const auto colon = fault.find(':');
  const std::string what = fault.substr(0, colon);
  const std::string duration = colon == std::string::npos ? "" : fault.substr(colon);
  return fmt::format("{}@{:.4f}{}", what, t_s, duration);
}

std::vector<Case> all_cases() {
  std::vector<Case> out;
  visit_all([&out](const Case& c, bool) { out.push_back(c); });
  return out;
}

std::vector<Case> quarter() {
  std::vector<Case> out;
  visit_all([&out](const Case& c, bool in_quarter) {
    if (in_quarter) out.push_back(c);
  });
  return out;
}

}  // namespace rosflight::bench::faults
