// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/strict_yaml.hpp"

namespace rosflight::flight {

/// A fault in a file a person gave us: one line, ready to print.
using InputError = config::Error;

/// A table read from CSV: a header line and rows of as many cells. Quoting is not needed by our
/// formats and not supported. Holds the whole file.
class CsvTable {
 public:
  /// @throws InputError with file and line: unreadable, empty, a NUL byte, a column named twice or
  /// not at all, a row with another number of cells.
  explicit CsvTable(const std::string& path);
  /// The same for a text at hand; `name` is what errors call it.
  CsvTable(std::string name, std::string text);
  CsvTable(const CsvTable&) = delete;  // cells point into the text
  CsvTable& operator=(const CsvTable&) = delete;

  const std::string& path() const { return path_; }
  const std::vector<std::string_view>& columns() const { return columns_; }
  std::optional<std::size_t> find(std::string_view column) const;
  std::size_t rows() const { return cells_.size() / columns_.size(); }
  std::string_view cell(std::size_t row, std::size_t column) const {
    return cells_[row * columns_.size() + column];
  }
  bool blank(std::size_t row, std::size_t column) const { return cell(row, column).empty(); }

  /// @throws InputError naming file, line and column if the cell is not a finite number (an integer
  /// of 64 bits).
  double number(std::size_t row, std::size_t column) const;
  float number_f(std::size_t row, std::size_t column) const;
  std::int64_t integer(std::size_t row, std::size_t column) const;

  /// "file:line: column NAME: TEXT".
  InputError error(std::size_t row, std::size_t column, const std::string& text) const;
  static std::size_t line_of(std::size_t row) { return row + 2; }

 private:
  void split(std::string_view line, std::vector<std::string_view>& cells) const;

  std::string path_;
  std::string text_;
  std::vector<std::string_view> columns_;
  std::vector<std::string_view> cells_;
};

}  // namespace rosflight::flight
