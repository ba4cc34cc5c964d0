// SPDX-License-Identifier: BSD-3-Clause
#include "apps/replay/replay.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <ostream>

#include "apps/replay/replay_rig.hpp"

namespace rosflight::apps {
namespace {

/// What a faithful firmware keeps to, by kind of column.
double tolerance(const std::string& column) {
  if (column.rfind("out", 0) == 0 || column.rfind("ctl", 0) == 0 || column.rfind("mix", 0) == 0) {
    return 1e-4;
  }
  if (column[0] == 'q') return 1e-3;
  if (column == "bx" || column == "by" || column == "bz") return 5e-4;
  if (column == "wx" || column == "wy" || column == "wz") return 1e-3;
  if (column.rfind("cmd_u", 0) == 0) return 1e-6;
  return 0.0;  // discrete
}

struct Waiver {
  std::string column;
  std::int64_t first{};
  std::int64_t last{};
  std::int64_t weak_point{};
};

std::vector<Waiver> read_waivers(const std::string& path) {
  const CsvTable table(path);
  const auto need = [&table, &path](const char* column) {
    const auto k = table.find(column);
    if (!k) throw InputError(fmt::format("{}:1: no column {}", path, column));
    return *k;
  };
  const auto column = need("column"), first = need("first_row"), last = need("last_row"),
             point = need("weak_point");
  const auto& outputs = ReplayRig::output_columns();
  std::vector<Waiver> waivers;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    Waiver w{std::string{table.cell(row, column)}, table.integer(row, first),
             table.integer(row, last), table.integer(row, point)};
    if (std::find(outputs.begin(), outputs.end(), w.column) == outputs.end()) {
      throw table.error(row, column, fmt::format("found '{}', allowed an output column", w.column));
    }
    if (w.first < 1 || w.last < w.first) {
      throw table.error(row, last,
                        fmt::format("found {}..{}, allowed 1 <= first <= last", w.first, w.last));
    }
    constexpr std::int64_t kWeakPoints = 77;
    if (w.weak_point < 1 || w.weak_point > kWeakPoints) {
      throw table.error(row, point, fmt::format("found {}, allowed 1..77", w.weak_point));
    }
    waivers.push_back(std::move(w));
  }
  return waivers;
}

void apply_parameters(const std::string& path, ReplayRig& rig) {
  const CsvTable table(path);
  const auto name = table.find("param"), type = table.find("type"), value = table.find("value");
  if (!name || !type || !value) {
    throw InputError(
        fmt::format("{}:1: found other columns, allowed order,param,type,value", path));
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

/// Compares one column as it is produced.
class ColumnCheck {
 public:
  ColumnCheck(std::string column, std::size_t index, const std::vector<Waiver>& waivers)
      : column_{std::move(column)}, index_{index}, tolerance_{tolerance(column_)} {
    for (const Waiver& w : waivers) {
      if (w.column == column_) waivers_.push_back(w);
    }
  }

  void add(const CsvTable& table, std::size_t row, const std::string& found) {
    if (table.blank(row, index_)) return;
    ++rows_;
    const std::string_view expected = table.cell(row, index_);
    const bool text = column_ == "fsm" || column_ == "cmd_types";
    const double difference = text ? (expected == found ? 0.0 : 1.0)
                                   : std::abs(table.number(row, index_) - std::stod(found));
    if (difference <= tolerance_) {
      largest_ = std::max(largest_, difference);
      return;
    }
    const auto number = static_cast<std::int64_t>(row) + 1;
    for (const Waiver& w : waivers_) {
      if (number < w.first || number > w.last) continue;
      ++waived_;
      weak_point_ = w.weak_point;
      return;
    }
    largest_ = std::max(largest_, difference);
    ++failed_;
    if (first_failed_ == 0) first_failed_ = number;
    last_failed_ = number;
  }

  bool report(std::ostream& out) const {
    fmt::print(out, "{:<12} {:>7} {:>12.3g} {:>10.1g}  ", column_, rows_, largest_, tolerance_);
    if (failed_ > 0) {
      fmt::print(out, "FAILED from row {}, {} rows, last {}", first_failed_, failed_, last_failed_);
    } else {
      fmt::print(out, "ok");
    }
    if (waived_ > 0) fmt::print(out, ", {} rows waived (weak point {})", waived_, weak_point_);
    fmt::print(out, "\n");
    return failed_ == 0;
  }

 private:
  std::string column_;
  std::size_t index_;
  double tolerance_;
  std::vector<Waiver> waivers_;
  std::int64_t rows_{0}, failed_{0}, waived_{0}, first_failed_{0}, last_failed_{0}, weak_point_{0};
  double largest_{0.0};
};

void check_columns(const CsvTable& table) {
  const auto& outputs = ReplayRig::output_columns();
  for (const std::string_view column : table.columns()) {
    if (ReplayRig::is_input(column)) continue;
    if (std::find(outputs.begin(), outputs.end(), column) != outputs.end()) continue;
    throw InputError(fmt::format("{}:1: found column '{}', allowed the columns of docs/replay.md",
                                 table.path(), column));
  }
  if (!table.find("time_us"))
    throw InputError(fmt::format("{}:1: no column time_us", table.path()));
}

void check_time(const CsvTable& table, std::size_t row, std::int64_t& last_us) {
  const std::size_t column = *table.find("time_us");
  const std::int64_t now = table.integer(row, column);
  if (now < 0 || (row > 0 && now < last_us)) {
    throw table.error(row, column,
                      fmt::format("found {}, allowed {} or later", now, row > 0 ? last_us : 0));
  }
  last_us = now;
}

}  // namespace

int replay(const ReplayOptions& options, std::ostream& out) {
  if (options.output && !options.force && std::filesystem::exists(*options.output)) {
    throw InputError(fmt::format("{}: exists; use --force to replace it", *options.output));
  }
  const CsvTable table(options.input);
  check_columns(table);
  std::vector<Waiver> waivers;
  if (options.waivers) waivers = read_waivers(*options.waivers);
  const auto rig = std::make_unique<ReplayRig>();
  if (options.params) apply_parameters(*options.params, *rig);

  std::vector<ColumnCheck> checks;
  if (options.compare) {
    for (const std::string& column : ReplayRig::output_columns()) {
      if (const auto k = table.find(column)) checks.emplace_back(column, *k, waivers);
    }
    if (checks.empty()) {
      throw InputError(fmt::format("{}: --compare needs output columns, found none", table.path()));
    }
  }
  std::string result = "step,time_us";
  for (const std::string& column : ReplayRig::output_columns()) result += "," + column;
  result += "\n";

  std::int64_t last_us = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    check_time(table, row, last_us);
    rig->step(table, row);
    result += fmt::format("{},{}", row + 1, last_us);
    std::size_t check = 0;
    for (const std::string& column : ReplayRig::output_columns()) {
      const std::string value = rig->output(column);
      result += "," + value;
      if (options.compare && table.find(column)) checks[check++].add(table, row, value);
    }
    result += "\n";
  }
  if (options.output) {
    const std::string part = *options.output + ".part";
    std::ofstream file(part, std::ios::binary);
    file << result;
    file.close();
    if (!file) throw InputError(fmt::format("{}: cannot be written", part));
    std::filesystem::rename(part, *options.output);
  } else if (!options.compare) {
    out << result;
  }
  if (!options.compare) return 0;
  fmt::print(out, "{:<12} {:>7} {:>12} {:>10}\n", "column", "rows", "largest diff", "tolerance");
  bool good = true;
  for (const ColumnCheck& check : checks) good = check.report(out) && good;
  fmt::print(out, "{} rows, {} columns: {}\n", table.rows(), checks.size(),
             good ? "same" : "DIFFERENT");
  return good ? 0 : 1;
}

}  // namespace rosflight::apps
