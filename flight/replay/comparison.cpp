// SPDX-License-Identifier: BSD-3-Clause
#include "flight/replay/comparison.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "flight/replay/replay_rig.hpp"

namespace rosflight::flight {
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

}  // namespace

std::vector<Waiver> read_waivers(const CsvTable& table) {
  const auto need = [&table](const char* column) {
    const auto k = table.find(column);
    if (!k) throw InputError(fmt::format("{}:1: no column {}", table.path(), column));
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
    if (w.weak_point < 0 || w.weak_point > kWeakPoints) {
      throw table.error(row, point, fmt::format("found {}, allowed 0..77", w.weak_point));
    }
    waivers.push_back(std::move(w));
  }
  return waivers;
}

ColumnCheck::ColumnCheck(std::string column, std::size_t index, const std::vector<Waiver>& waivers)
    : column_{std::move(column)}, index_{index}, tolerance_{tolerance(column_)} {
  for (const Waiver& w : waivers) {
    if (w.column == column_) waivers_.push_back(w);
  }
}

void ColumnCheck::add(const CsvTable& table, std::size_t row, const std::string& found) {
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

bool ColumnCheck::report(std::ostream& out) const {
  fmt::print(out, "{:<12} {:>7} {:>12.3g} {:>10.1g}  ", column_, rows_, largest_, tolerance_);
  if (failed_ > 0) {
    fmt::print(out, "FAILED from row {}, {} rows, last {}", first_failed_, failed_, last_failed_);
  } else {
    fmt::print(out, "ok");
  }
  if (waived_ > 0) {
    const std::string why =
        weak_point_ > 0 ? fmt::format("weak point {}", weak_point_) : "other difference";
    fmt::print(out, ", {} rows waived ({})", waived_, why);
  }
  fmt::print(out, "\n");
  return failed_ == 0;
}

}  // namespace rosflight::flight
