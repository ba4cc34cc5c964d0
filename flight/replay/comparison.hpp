// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "flight/replay/csv.hpp"

namespace rosflight::flight {

/// Rows in which a column may differ, because of a weak point of ROSflight 2.x that is mended here.
struct Waiver {
  std::string column;
  std::int64_t first{};  ///< Rows count from 1.
  std::int64_t last{};
  std::int64_t weak_point{};  ///< Its number in docs/compatibility.md.
};

/// @throws InputError for a missing column or a cell that makes no sense.
std::vector<Waiver> read_waivers(const CsvTable& table);

/// Compares one column as it is produced with what the table expects.
class ColumnCheck {
 public:
  /// @param index  where the table has the expected values; blank cells are not compared.
  ColumnCheck(std::string column, std::size_t index, const std::vector<Waiver>& waivers);

  void add(const CsvTable& table, std::size_t row, const std::string& found);
  /// One line for a reader. @returns true if all rows agree or are waived.
  bool report(std::ostream& out) const;

 private:
  std::string column_;
  std::size_t index_;
  double tolerance_;
  std::vector<Waiver> waivers_;
  std::int64_t rows_{0}, failed_{0}, waived_{0}, first_failed_{0}, last_failed_{0}, weak_point_{0};
  double largest_{0.0};
};

}  // namespace rosflight::flight
