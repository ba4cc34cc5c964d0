// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

/// What the programs that fly missions have in common.
namespace rosflight::bench {

using Figures = std::map<std::string, double>;

/// The rest of main(): `figures_of(row)` for every row, or those named on the command line, as one
/// JSON object NAME -> {QUANTITY: number}.
template <class Rows, class FiguresOf>
int print_rows(const char* program, const Rows& rows, FiguresOf figures_of, int argc, char** argv) {
  const auto wanted = [argc, argv](const char* name) {
    for (int k = 1; k < argc; ++k) {
      if (std::strcmp(argv[k], name) == 0) return true;
    }
    return argc < 2;
  };
  try {
    nlohmann::ordered_json all = nlohmann::ordered_json::object();
    for (const auto& row : rows) {
      if (wanted(row.name)) all[row.name] = figures_of(row);
    }
    std::cout << all.dump(1) << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
    return 1;
  }
}

}  // namespace rosflight::bench
