// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/cases.hpp"

#include <fmt/format.h>

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

void add_singles(std::vector<Case>& out) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    for (const char* pilot : {"hover", "idle"}) {
      for (const FaultRow& row : fault_rows(subjects()[s].fixed_wing)) {
        for (const char* phase : subjects()[s].phases) {
          out.push_back({s, pilot, row.text, "", phase, false});
        }
      }
    }
  }
}

/// Silence of the receiver with the failsafe command of ROSflight 2.x.
void add_failsafe_commands(std::vector<Case>& out) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    for (const char* fault : {"rc_silence:2", "rc_silence:10", "rc_frame_loss:2"}) {
      for (const char* phase : subjects()[s].phases) {
        out.push_back({s, "hover", fault, "", phase, true});
      }
    }
  }
}

void add_pairs(std::vector<Case>& out) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    std::vector<std::string> kinds;
    for (const FaultRow& row : fault_rows(subjects()[s].fixed_wing)) {
      if (row.first_of_kind) kinds.push_back(row.text);
    }
    for (const char* pilot : {"hover", "idle"}) {
      for (const char* phase : subjects()[s].pair_phases) {
        for (std::size_t a = 0; a < kinds.size(); ++a) {
          for (std::size_t b = a + 1; b < kinds.size(); ++b) {
            out.push_back({s, pilot, kinds[a], kinds[b], phase, false});
          }
        }
      }
    }
  }
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
  add_singles(out);
  add_failsafe_commands(out);
  add_pairs(out);
  return out;
}

}  // namespace rosflight::bench::faults
