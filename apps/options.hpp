// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

/// What the command lines share. Included by them alone: CLI11 takes seconds to compile.
namespace rosflight::apps {

inline constexpr int kBadInput = 2;

/// For CLI11: empty if `text` is a whole number without a sign, else what is wrong.
inline std::string whole_number(const std::string& text) {
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::string() : "found '" + text + "', allowed a whole number from 0";
}

/// For CLI11: one of these names; else what was found and what is allowed.
inline CLI::Validator one_of(const std::vector<std::string>& names) {
  const auto joined = [&names](const char* separator) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : separator) + name;
    return text;
  };
  const std::string allowed = joined(", ");
  const auto check = [names, allowed](const std::string& text) {
    const bool found = std::find(names.begin(), names.end(), text) != names.end();
    return found ? std::string() : "found " + text + ", allowed " + allowed;
  };
  return {check, "{" + joined(",") + "}"};
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
    const std::string what = e.what();
    const bool complete = what.find(", allowed ") != std::string::npos;
    std::cerr << "rosflight: " << what << (complete ? "" : " (--help lists what is allowed)")
              << "\n";
  } catch (const std::exception& e) {
    std::cerr << "rosflight: " << e.what() << "\n";
  }
  return kBadInput;
}

}  // namespace rosflight::apps
