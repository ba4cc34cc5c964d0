// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flight/replay/csv.hpp"

/// Recorded inputs through the real firmware, one main-loop pass per row (docs/replay.md).
namespace rosflight::flight {

struct ReplayOptions {
  std::string input;
  std::optional<std::string> params;
  std::optional<std::string> output;
  bool force{false};
  bool compare{false};
  std::optional<std::string> waivers;
};

/// The tables of one replay.
struct ReplayInput {
  CsvTable table;
  std::unique_ptr<CsvTable> params;   ///< order,param,type,value; or none.
  std::unique_ptr<CsvTable> waivers;  ///< column,first_row,last_row,weak_point; or none.
};

struct ReplayResult {
  std::string csv;         ///< What came out, all output columns.
  std::string comparison;  ///< For a reader; empty if not asked for.
  bool same{true};
};

/// Every row through a firmware of its own. @throws InputError naming file, line and column.
ReplayResult replay(const ReplayInput& input, bool compare);

/// Runs the whole command. Results go to `out`.
/// @returns 0, or 1 if a comparison failed. @throws InputError for bad input; nothing is written
/// then.
int replay(const ReplayOptions& options, std::ostream& out);

}  // namespace rosflight::flight
