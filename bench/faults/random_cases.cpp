// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/random_cases.hpp"

#include <fmt/format.h>

#include <random>

namespace rosflight::bench::faults {
namespace {

using Kind = DrawnKind;

Kind lasting(const char* name, double shortest_s, double longest_s, double for_good,
             Kind::For vehicles = Kind::For::kBoth) {
  return {name, 0.0, 0.0, false, shortest_s, longest_s, for_good, vehicles};
}
Kind moment(const char* name) {
  return {name};
}
Kind sized(const char* name, double smallest, double largest, bool both_signs = true) {
  return {name, smallest, largest, both_signs};
}

/// Numbers that are the same with every compiler: the distributions of the standard library are not.
class Dice {
 public:
  Dice(std::uint64_t series, std::uint64_t number) : engine_{engine(series, number)} {}
  double share() {
    constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
    return static_cast<double>(engine_() >> 11U) * kUnit;
  }
  double between(double low, double high) { return low + (high - low) * share(); }
  bool chance(double probability) { return share() < probability; }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(share() * static_cast<double>(count));
  }

 private:
  static std::mt19937_64 engine(std::uint64_t series, std::uint64_t number) {
    std::seed_seq words{series, series >> 32U, number, number >> 32U};
    return std::mt19937_64{words};
  }

  std::mt19937_64 engine_;
};

std::string fault_text(const Kind& kind, const Subject& subject, Dice& dice) {
  std::string out = kind.name;
  const std::size_t number = out.find('N');
  if (number != std::string::npos) {
    const unsigned count = out.front() == 's' ? subject.surfaces : subject.motors;
    out.replace(number, 1, std::to_string(dice.below(count)));
  }
  if (kind.largest != 0.0) {
    const double size = dice.between(kind.smallest, kind.largest);
    out += fmt::format("={:.3g}", kind.both_signs && dice.chance(0.5) ? -size : size);
  }
  if (kind.longest_s > 0.0 && !dice.chance(kind.for_good)) {
    out += fmt::format(":{:.2f}", dice.between(kind.shortest_s, kind.longest_s));
  }
  return out;
}

std::vector<const Kind*> kinds_of(const Subject& subject) {
  std::vector<const Kind*> out;
  for (const Kind& kind : drawn_kinds()) {
    if (kind.vehicles == Kind::For::kBoth || subject.fixed_wing) out.push_back(&kind);
  }
  return out;
}

Case drawn(Dice dice, const std::optional<std::string>& wind) {
  constexpr double kPairs = 0.5;
  constexpr double kApart = 0.25;
  constexpr std::size_t kSeeds = 1'000'000;
  Case out;
  out.phase = kRandom;
  out.subject = dice.below(subjects().size());
  const Subject& subject = subjects()[out.subject];
  out.pilot = dice.chance(0.5) ? "hover" : "idle";
  out.seed = 1 + dice.below(kSeeds - 1);
  const double speed_m_s = dice.between(0.0, subject.wind_m_s);
  const std::size_t from_deg = dice.below(360);
  const double gusts_m_s = dice.between(0.0, speed_m_s);
  out.wind = wind.value_or(fmt::format("{:.1f},{},{:.1f}", speed_m_s, from_deg, gusts_m_s));
  const auto kinds = kinds_of(subject);
  const std::size_t first = dice.below(kinds.size());
  out.first = fault_text(*kinds[first], subject, dice);
  out.moments[0] = dice.share();
  if (!dice.chance(kPairs)) return out;
  const std::size_t other = dice.below(kinds.size() - 1);  // of the kinds but the first
  out.second = fault_text(*kinds[other < first ? other : other + 1], subject, dice);
  if (dice.chance(kApart)) {
    out.moments[1] = dice.share();
  } else {
    out.second_after_s = dice.between(0.2, 5.0);
  }
  return out;
}

}  // namespace

const std::vector<DrawnKind>& drawn_kinds() {
  constexpr auto kFixedWing = Kind::For::kFixedWing;
  static const std::vector<DrawnKind> list{lasting("imu", 0.02, 0.5, 0.0),
                                           lasting("imu_nan", 0.02, 0.5, 0.0),
                                           lasting("imu_stuck", 0.02, 0.5, 0.0),
                                           lasting("mag", 1.0, 60.0, 0.5),
                                           lasting("baro", 1.0, 60.0, 0.5),
                                           lasting("gnss", 1.0, 60.0, 0.5),
                                           sized("gnss_step", 5.0, 30.0),
                                           sized("gnss_delay", 0.05, 0.5, false),
                                           lasting("diff_pressure", 1.0, 60.0, 0.5, kFixedWing),
                                           lasting("pitot_blocked", 1.0, 60.0, 0.5, kFixedWing),
                                           lasting("range", 1.0, 60.0, 0.5),
                                           lasting("battery", 1.0, 60.0, 0.5),
                                           moment("battery_low"),
                                           lasting("rc_silence", 0.5, 20.0, 0.25),
                                           lasting("rc_frame_loss", 0.5, 20.0, 0.25),
                                           lasting("link_cut", 0.5, 20.0, 0.0),
                                           sized("link_noise", 0.001, 0.01, false),
                                           lasting("companion_stall", 0.1, 1.0, 0.0),
                                           moment("crash"),
                                           moment("hang"),
                                           sized("baro_step", 2.0, 50.0),
                                           sized("mag_turned", 10.0, 180.0),
                                           sized("accel_step_x", 0.1, 1.0),
                                           sized("accel_step_y", 0.1, 1.0),
                                           sized("accel_step_z", 0.3, 3.0),
                                           sized("gyro_step_x", 0.01, 0.1),
                                           sized("gyro_step_y", 0.01, 0.1),
                                           sized("gyro_step_z", 0.01, 0.1),
                                           sized("motorN_partial", 0.5, 0.95, false),
                                           lasting("motorN_dead", 0.2, 2.0, 0.25),
                                           lasting("servoN_stuck", 1.0, 60.0, 0.5, kFixedWing)};
  return list;
}

std::string table_row(const DrawnKind& kind) {
  const std::string value = kind.largest == 0.0
                                ? "-"
                                : fmt::format("{:g} to {:g}{}", kind.smallest, kind.largest,
                                              kind.both_signs ? ", either sign" : "");
  const std::string good =
      kind.for_good > 0.0 ? fmt::format("; {:g} % for good", 100.0 * kind.for_good) : "";
  const std::string duration =
      kind.longest_s == 0.0 ? "-"
                            : fmt::format("{:g} to {:g}{}", kind.shortest_s, kind.longest_s, good);
  return fmt::format("| `{}`{} | {} | {} |", kind.name,
                     kind.vehicles == Kind::For::kFixedWing ? " (fixed wing)" : "", value,
                     duration);
}

std::vector<Case> random_cases(std::size_t count, std::uint64_t seed,
                               const std::optional<std::string>& wind) {
  std::vector<Case> out;
  out.reserve(count);
  for (std::size_t k = 0; k < count; ++k) out.push_back(drawn(Dice(seed, k), wind));
  return out;
}

}  // namespace rosflight::bench::faults
