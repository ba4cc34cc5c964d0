// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/faults/cases.hpp"

/// Random flights: vehicle, pilot, seed, wind, one or two faults, their values and moments are drawn.
namespace rosflight::bench::faults {

/// A kind of fault and the ranges that its value and its duration are drawn from. docs/faults.md has
/// this list as a table, which is compared with it.
struct DrawnKind {
  enum class For : unsigned char { kBoth, kFixedWing };

  std::string name;   ///< As `--fault` spells it; N is a motor or a surface.
  double smallest{};  ///< Smallest value, in the unit of the kind.
  double largest{};   ///< Largest value; 0: the kind has none.
  bool both_signs{};
  double shortest_s{};
  double longest_s{};  ///< 0: no duration; it lasts to the end, or is a moment.
  double for_good{};   ///< Share of those with a duration that last to the end all the same.
  For vehicles{For::kBoth};
};
/// Every kind that `--fault` knows.
const std::vector<DrawnKind>& drawn_kinds();
/// Its row in docs/faults.md.
std::string table_row(const DrawnKind& kind);

/// The first `count` flights of a series. A flight depends on `seed` and its number in the series alone.
///
/// Half of the flights have two faults. The first begins at a moment uniform from arming to the
/// touchdown of a flight without faults; so does the second in a quarter of the pairs, and in the
/// others 0.2 s to 5 s after the first.
/// @param wind  of all flights, as `--wind` takes it; none: each has its own.
std::vector<Case> random_cases(std::size_t count, std::uint64_t seed,
                               const std::optional<std::string>& wind);

}  // namespace rosflight::bench::faults
