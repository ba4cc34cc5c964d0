// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/fly_random.hpp"

#include <sstream>

#include "firmware/core/test/flight_invariants.hpp"

namespace rosflight::core {

std::vector<Violation> fly_random(std::uint64_t seed, int passes, RandomFlight::Without without,
                                  Coverage& coverage) {
  RandomFlight flight(seed, without);
  constexpr link::MavlinkCodec::Identity kCompanion{1, link::MavlinkCodec::kCompanionComponent};
  constexpr link::MavlinkCodec::Identity kGroundTool{255, 190};
  // Behind garbage, where a frame begins depends on every byte of it, the sender's id too.
  const bool garbage = flight.has(Ingredient::kGarbage);
  WatchedFirmware watched(flight, kCompanion);
  WatchedFirmware twin(flight, garbage ? kCompanion : kGroundTool);
  FlightInvariants invariants(flight);
  for (int k = 0; k < passes; ++k) {
    const PassInputs& in = flight.next();
    watched.pass(in, true);
    twin.pass(in, false);
    if (!invariants.check(in, watched, twin)) break;
  }
  coverage.add(invariants.coverage());
  return invariants.violations();
}

std::string reduced(const Violation& violation) {
  RandomFlight::Without without;
  Violation last = violation;
  constexpr int kLonger = 2;  // without an ingredient the failure may come later
  for (std::size_t k = 0; k < kIngredientCount; ++k) {
    auto tried = without;
    tried.set(k);
    Coverage ignored;
    for (const auto& found :
         fly_random(violation.seed, kLonger * (violation.pass + 1), tried, ignored)) {
      if (found.invariant != violation.invariant) continue;
      without = tried;
      last = found;
    }
  }
  const RandomFlight flight(violation.seed, without);
  std::ostringstream text;
  text << violation.invariant << ": " << violation.detail << "\n  seed " << violation.seed
       << ", pass " << violation.pass << "\n  reduced: " << last.detail << " in pass " << last.pass
       << " of: " << flight.description() << "\n  again: properties --seed " << violation.seed
       << " --passes " << last.pass + 2 << " --without " << without.to_ulong();
  return text.str();
}

Violations fly_many(std::uint64_t first, std::uint64_t flights, int passes, Coverage& coverage) {
  Violations all;
  for (std::uint64_t seed = first; seed < first + flights; ++seed) {
    for (const Violation& found : fly_random(seed, passes, {}, coverage)) {
      ++all.try_emplace(found.invariant, 0, found).first->second.first;
    }
  }
  return all;
}

}  // namespace rosflight::core
