// SPDX-License-Identifier: BSD-3-Clause
#include "flight/replay/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

namespace rosflight::flight {

namespace {

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be read", path));
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

CsvTable::CsvTable(const std::string& path) : CsvTable(path, read_text(path)) {}

CsvTable::CsvTable(std::string name, std::string text)
    : path_{std::move(name)}, text_{std::move(text)} {
  const std::string& path = path_;
  if (text_.find('\0') != std::string::npos) {
    throw InputError(fmt::format("{}: not a text file", path));
  }
  std::string_view rest = text_;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view cells = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!cells.empty() && cells.back() == '\r') cells.remove_suffix(1);
    if (line == 1) {
      split(cells, columns_);
      continue;
    }
    const std::size_t before = cells_.size();
    split(cells, cells_);
    if (cells_.size() - before != columns_.size()) {
      throw InputError(fmt::format("{}:{}: found {} cells, allowed {} as in the header", path, line,
                                   cells_.size() - before, columns_.size()));
    }
  }
  if (columns_.empty() || columns_.front().empty()) {
    throw InputError(fmt::format("{}:1: no header line with column names", path));
  }
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    if (columns_[k].empty() || find(columns_[k]) != k) {
      throw InputError(
          fmt::format("{}:1: column {}: '{}' twice or empty", path, k + 1, columns_[k]));
    }
  }
}

void CsvTable::split(std::string_view line, std::vector<std::string_view>& cells) const {
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  const auto it = std::find(columns_.begin(), columns_.end(), column);
  if (it == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(it - columns_.begin());
}

InputError CsvTable::error(std::size_t row, std::size_t column, const std::string& text) const {
  return InputError(
      fmt::format("{}:{}: column {}: {}", path_, line_of(row), columns_[column], text));
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string_view text = cell(row, column);
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    throw error(row, column, fmt::format("found '{}', allowed a finite number", text));
  }
  return value;
}

float CsvTable::number_f(std::size_t row, std::size_t column) const {
  const std::string_view text = cell(row, column);
  float value = 0.0f;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    throw error(row, column, fmt::format("found '{}', allowed a finite 32-bit number", text));
  }
  return value;
}

std::int64_t CsvTable::integer(std::size_t row, std::size_t column) const {
  const std::string_view text = cell(row, column);
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size()) {
    throw error(row, column, fmt::format("found '{}', allowed a whole number", text));
  }
  return value;
}

}  // namespace rosflight::flight
