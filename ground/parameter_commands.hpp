// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "companion/parameter.hpp"
#include "ground/ground_link.hpp"

/// Parameters over a link, for command lines. Each function expects a connected link, prints to `out`
/// and returns the exit code: 0, or 1 if the vehicle refused or values differ.
/// @throws config::Error  bad input, one line; nothing is sent then. @throws NoAnswer @throws Stopped
namespace rosflight::ground {

inline constexpr int kGood = 0;
inline constexpr int kNotGood = 1;

/// A value to set.
struct Assignment {
  std::string name;
  double value{};
};

/// Reads NAME VALUE NAME VALUE ... and checks names, types and ranges against this project's firmware as
/// far as it knows them.
std::vector<Assignment> parse_assignments(const std::vector<std::string>& words);
/// Reads a parameter file; ranges are checked like those of parse_assignments().
companion::ParameterSet read_checked_file(const std::filesystem::path& file);

/// A table of all parameters, or of those that differ from their defaults.
int list_parameters(GroundLink& link, bool only_changed, bool json, std::ostream& out);
/// The values of some parameters, read from the vehicle.
int get_parameters(GroundLink& link, const std::vector<std::string>& names, bool json,
                   std::ostream& out);
/// Sets values and reads them back. @param write  store them in the vehicle's non-volatile memory too.
int set_parameters(GroundLink& link, const std::vector<Assignment>& assignments, bool write,
                   std::ostream& out);
/// Sets all values of a file and reads them back.
int load_parameters(GroundLink& link, const companion::ParameterSet& set, bool write,
                    std::ostream& out);
/// Writes all parameters, or those that differ from their defaults, to a file: whole or not at all.
int save_parameters(GroundLink& link, const std::filesystem::path& file, bool only_changed,
                    std::ostream& out);
/// Compares the values of a file with those of the vehicle. @param all  also what the file does not have.
int diff_parameters(GroundLink& link, const companion::ParameterSet& set, bool all, bool json,
                    std::ostream& out);

}  // namespace rosflight::ground
