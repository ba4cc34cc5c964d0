// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>

/// What the command lines share. Included by them alone: CLI11 takes seconds to compile.
namespace rosflight::apps {

inline constexpr int kBadInput = 2;

/// For CLI11: empty if `text` is a whole number without a sign, else what is wrong.
inline std::string whole_number(const std::string& text) {
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::string() : "found '" + text + "', allowed a whole number from 0";
}

/// Reads the command line and calls `run`. Errors become one line on standard error.
/// @returns the exit code: that of `run`, 0 after --help, kBadInput for bad input.
template <class Run>
int parse_and_run(CLI::App& app, int argc, char** argv, const Run& run) {
  app.name("./rosflight");
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << "rosflight: " << e.what() << " (--help lists what is allowed)\n";
  } catch (const std::exception& e) {
    std::cerr << "rosflight: " << e.what() << "\n";
  }
  return kBadInput;
}

}  // namespace rosflight::apps
