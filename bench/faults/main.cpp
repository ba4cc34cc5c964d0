// SPDX-License-Identifier: BSD-3-Clause
// Flies the fault campaign and prints its figures as one JSON object; the matrix goes to files.
//
// usage: faults [--quarter] [--page FILE] [--compare PAGE] [--only WORD]... [COMMON]
//        faults --random N [--seed S] [--wind SPEED,FROM_DEG,GUST] [COMMON]
// COMMON: [--text FILE] [--csv FILE] [--processes N]
//   --quarter  a fixed quarter, for continuous integration: each pair once, in one order
//   --compare  the cells that were flown have to be those of this page
//   --only     flights whose vehicle, phase or fault has this name; all that are given must fit
//   --random   N flights with drawn vehicles, pilots, faults, moments, seeds and winds (random_cases.hpp)
//   --seed     of the series of random flights (1)
//   --wind     of all random flights instead of a drawn one
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "bench/faults/random_cases.hpp"
#include "bench/faults/report.hpp"

namespace {

using namespace rosflight::bench::faults;  // NOLINT(google-build-using-namespace): one file
using rosflight::bench::kStates;

struct Options {
  bool quarter{false};
  std::optional<std::string> text, csv, page, compare;
  unsigned processes{0};
  std::vector<std::string> only;
  std::optional<std::size_t> random;
  std::uint64_t seed{1};
  std::optional<std::string> wind;
};

std::uint64_t number(const std::string& option, const std::string& text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) {
    throw std::invalid_argument(option + ": found '" + text + "', allowed a whole number");
  }
  return value;
}

/// Options of the campaign have no meaning for random flights, and the other way round.
void check(const Options& o) {
  if (o.random && (o.quarter || o.page || o.compare || !o.only.empty())) {
    throw std::invalid_argument(
        "--random: found --quarter, --page, --compare or --only, allowed --seed, --wind, --text, "
        "--csv");
  }
  if (!o.random && (o.wind || o.seed != 1)) {
    throw std::invalid_argument("--seed, --wind: found no --random, allowed with --random N");
  }
  if (o.wind) rosflight::flight::parse_wind(*o.wind);
}

Options read(int argc, char** argv) {
  Options out;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t k = 0; k < words.size(); ++k) {
    const auto value = [&]() -> std::string {
      if (k + 1 == words.size()) throw std::invalid_argument(words[k] + ": found no value");
      return words[++k];
    };
    if (words[k] == "--quarter") {
      out.quarter = true;
    } else if (words[k] == "--text") {
      out.text = value();
    } else if (words[k] == "--csv") {
      out.csv = value();
    } else if (words[k] == "--page") {
      out.page = value();
    } else if (words[k] == "--compare") {
      out.compare = value();
    } else if (words[k] == "--processes") {
      out.processes = static_cast<unsigned>(number("--processes", value()));
    } else if (words[k] == "--random") {
      out.random = number("--random", value());
    } else if (words[k] == "--seed") {
      out.seed = number("--seed", value());
    } else if (words[k] == "--wind") {
      out.wind = value();
    } else if (words[k] == "--only") {
      out.only.push_back(value());
    } else {
      throw std::invalid_argument("unknown option " + words[k]);
    }
  }
  check(out);
  return out;
}

bool fits(const Case& c, const std::vector<std::string>& only) {
  for (const std::string& word : only) {
    const bool found = word == subjects()[c.subject].vehicle || word == c.phase ||
                       word == c.first || word == c.second || word == c.pilot ||
                       (word == "singles" && c.second.empty()) ||
                       (word == "pairs" && !c.second.empty());
    if (!found) return false;
  }
  return true;
}

std::vector<Case> chosen(const Options& options) {
  if (options.random) return random_cases(*options.random, options.seed, options.wind);
  std::vector<Case> out = options.quarter ? quarter() : all_cases();
  std::erase_if(out, [&options](const Case& c) { return !fits(c, options.only); });
  return out;
}

void write(const std::optional<std::string>& file, const std::string& text) {
  if (!file) return;
  std::ofstream stream(*file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + *file);
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

int run(const Options& options) {
  const std::vector<Case> cases = chosen(options);
  const auto progress = [&](std::size_t done) {
    constexpr std::size_t kEvery = 100;
    if (done % kEvery == 0) std::fprintf(stderr, "%zu of %zu flights\n", done, cases.size());
  };
  const Campaign campaign = fly(cases, options.processes, progress);
  const std::vector<Flown>& flown = campaign.flights;
  write(options.text, options.random ? as_random_text(flown) : as_text(flown));
  write(options.csv, as_csv(flown));
  write(options.page, as_page(flown));
  std::vector<std::string> differing;
  if (options.compare) {
    std::ifstream stream(*options.compare, std::ios::binary);
    differing = differences(flown, {std::istreambuf_iterator<char>(stream), {}});
  }
  for (const std::string& line : differing) std::fprintf(stderr, "%s\n", line.c_str());
  std::size_t singles = 0, pairs = 0;
  EstimateCount estimate;
  for (const Flown& f : flown) {
    estimate.add(f.estimate);
    if (f.as_asked()) continue;
    ++(f.flight.second.empty() ? singles : pairs);
    std::fprintf(stderr, "no rule explains: %s: %s\n", command(f).c_str(), verdict(f).c_str());
  }
  nlohmann::ordered_json out;
  out["flights"] = flown.size();
  out["single_unexplained"] = singles;
  out["pairs_unexplained"] = pairs;
  if (!options.random) out["differing"] = differing.size();
  for (std::size_t k = 0; k < kStates.size(); ++k) {
    out[std::string("outside_") + kStates[k]] = share(estimate.outside[k], estimate.samples);
  }
  out["outside_worst"] = estimate.worst_share();
  out["far"] = estimate.far;
  out["said_in_time_share"] = estimate.far > 0 ? share(estimate.in_time, estimate.far) : 1.0;
  out["nominal_said"] = campaign.nominal_said;
  std::cout << out.dump(1) << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(read(argc, argv));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "faults: %s\n", e.what());
    return 1;
  }
}
