// SPDX-License-Identifier: BSD-3-Clause
// Flies random flights and checks the promises of the firmware in each pass; prints JSON, and what
// did not hold to standard error. With --seed one flight, to run a failure again.
//
// usage: properties [--first SEED] [--flights N] [--passes N] [--seed SEED [--without BITS]]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>

#include "firmware/core/test/fly_random.hpp"

int main(int argc, char** argv) {
  using namespace rosflight::core;  // NOLINT(google-build-using-namespace): a program of one file
  std::uint64_t first = 1, flights = 250, seed = 0, without = 0, passes = 4000;
  bool known = argc % 2 == 1;
  for (int k = 1; k + 1 < argc; k += 2) {
    const auto value = static_cast<std::uint64_t>(std::strtoull(argv[k + 1], nullptr, 10));
    if (std::strcmp(argv[k], "--first") == 0) {
      first = value;
    } else if (std::strcmp(argv[k], "--flights") == 0) {
      flights = value;
    } else if (std::strcmp(argv[k], "--passes") == 0) {
      passes = value;
    } else if (std::strcmp(argv[k], "--seed") == 0) {
      seed = value;
    } else if (std::strcmp(argv[k], "--without") == 0) {
      without = value;
    } else {
      known = false;
    }
  }
  if (!known) {
    std::fprintf(stderr,
                 "usage: properties [--first SEED] [--flights N] [--passes N] "
                 "[--seed SEED [--without BITS]]\n");
    return 2;
  }
  Coverage coverage;
  int violations = 0;
  if (seed != 0) {
    for (const Violation& v : fly_random(seed, static_cast<int>(passes), without, coverage)) {
      std::fprintf(stderr, "%s: %s, pass %d\n", v.invariant.c_str(), v.detail.c_str(), v.pass);
      ++violations;
    }
  } else {
    for (const auto& [name, entry] : fly_many(first, flights, static_cast<int>(passes), coverage)) {
      std::fprintf(stderr, "%d flights, first %s\n", entry.first, reduced(entry.second).c_str());
      violations += entry.first;
    }
  }
  std::fprintf(stderr, "%s", coverage.report().c_str());
  std::cout << nlohmann::ordered_json{{"passes", coverage.passes},
                                      {"violations", violations},
                                      {"armed_passes", coverage.armed_passes}}
            << "\n";
  return 0;
}
