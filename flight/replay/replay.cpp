// SPDX-License-Identifier: BSD-3-Clause
#include "flight/replay/replay.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>

#include "base/atomic_file.hpp"
#include "flight/replay/comparison.hpp"
#include "flight/replay/replay_rig.hpp"

namespace rosflight::flight {
namespace {

void apply_parameters(const CsvTable& table, ReplayRig& rig) {
  const auto name = table.find("param"), type = table.find("type"), value = table.find("value");
  if (!name || !type || !value) {
    throw InputError(
        fmt::format("{}:1: found other columns, allowed order,param,type,value", table.path()));
  }
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::string_view kind = table.cell(row, *type);
    if (kind != "int" && kind != "float") {
      throw table.error(row, *type, fmt::format("found '{}', allowed int, float", kind));
    }
    const double v =
        kind == "int" ? static_cast<double>(table.integer(row, *value)) : table.number(row, *value);
    try {
      rig.set_parameter(std::string{table.cell(row, *name)}, v);
    } catch (const InputError& e) {
      throw table.error(row, *name, e.what());
    }
  }
}

void check_columns(const CsvTable& table) {
  const auto& outputs = ReplayRig::output_columns();
  for (const std::string_view column : table.columns()) {
    if (ReplayRig::is_input(column)) continue;
    if (std::find(outputs.begin(), outputs.end(), column) != outputs.end()) continue;
    throw InputError(fmt::format("{}:1: found column '{}', allowed the columns of docs/replay.md",
                                 table.path(), column));
  }
}

/// Where the time is.
std::size_t time_column(const CsvTable& table) {
  const auto column = table.find("time_us");
  if (!column) throw InputError(fmt::format("{}:1: no column time_us", table.path()));
  return *column;
}

void check_time(const CsvTable& table, std::size_t column, std::size_t row, std::int64_t& last_us) {
  const std::int64_t now = table.integer(row, column);
  if (now < 0 || (row > 0 && now < last_us)) {
    throw table.error(row, column,
                      fmt::format("found {}, allowed {} or later", now, row > 0 ? last_us : 0));
  }
  last_us = now;
}

}  // namespace

ReplayResult replay(const ReplayInput& input, bool compare) {
  const CsvTable& table = input.table;
  check_columns(table);
  const std::size_t time = time_column(table);
  std::vector<Waiver> waivers;
  if (input.waivers) waivers = read_waivers(*input.waivers);
  const auto rig = std::make_unique<ReplayRig>();
  if (input.params) apply_parameters(*input.params, *rig);

  std::vector<ColumnCheck> checks;
  if (compare) {
    for (const std::string& column : ReplayRig::output_columns()) {
      if (const auto k = table.find(column)) checks.emplace_back(column, *k, waivers);
    }
    if (checks.empty()) {
      throw InputError(fmt::format("{}: --compare needs output columns, found none", table.path()));
    }
  }
  ReplayResult result;
  result.csv = "step,time_us";
  for (const std::string& column : ReplayRig::output_columns()) result.csv += "," + column;
  result.csv += "\n";

  std::int64_t last_us = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    check_time(table, time, row, last_us);
    rig->step(table, row);
    result.csv += fmt::format("{},{}", row + 1, last_us);
    std::size_t check = 0;
    for (const std::string& column : ReplayRig::output_columns()) {
      const std::string value = rig->output(column);
      result.csv += "," + value;
      if (compare && table.find(column)) checks[check++].add(table, row, value);
    }
    result.csv += "\n";
  }
  if (!compare) return result;
  std::ostringstream report;
  fmt::print(report, "{:<12} {:>7} {:>12} {:>10}\n", "column", "rows", "largest diff", "tolerance");
  for (const ColumnCheck& check : checks) result.same = check.report(report) && result.same;
  fmt::print(report, "{} rows, {} columns: {}\n", table.rows(), checks.size(),
             result.same ? "same" : "DIFFERENT");
  result.comparison = report.str();
  return result;
}

int replay(const ReplayOptions& options, std::ostream& out) {
  if (options.output && !options.force && std::filesystem::exists(*options.output)) {
    throw InputError(fmt::format("{}: exists; use --force to replace it", *options.output));
  }
  const auto optional = [](const std::optional<std::string>& path) {
    return path ? std::make_unique<CsvTable>(*path) : nullptr;
  };
  const ReplayInput input{CsvTable(options.input), optional(options.params),
                          optional(options.waivers)};
  const ReplayResult result = replay(input, options.compare);
  if (options.output) {
    base::write_file(*options.output, result.csv);
  } else if (!options.compare) {
    out << result.csv;
  }
  out << result.comparison;
  return result.same ? 0 : 1;
}

}  // namespace rosflight::flight
