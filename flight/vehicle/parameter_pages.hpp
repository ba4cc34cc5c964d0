// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

namespace rosflight::flight {

/// A file made from the tables of parameters (config/table.hpp).
struct ParameterPage {
  std::string path;  ///< From the root of the source tree.
  std::string text;
};

/// The reference pages of the sections of a vehicle file, and files with all defaults and their
/// meaning as comments.
std::vector<ParameterPage> parameter_pages();

}  // namespace rosflight::flight
