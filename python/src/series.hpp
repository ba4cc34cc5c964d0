// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <string>
#include <vector>

namespace rosflight::python {

/// A NumPy array that owns the numbers: handed over without a copy. `columns` of 0: one dimension.
inline nanobind::object array_of(std::vector<double>&& values, std::size_t columns = 0) {
  auto* const kept = new std::vector<double>(std::move(values));
  const nanobind::capsule owner(
      kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  const std::size_t shape[2] = {columns > 0 ? kept->size() / columns : kept->size(), columns};
  return nanobind::cast(
      nanobind::ndarray<nanobind::numpy, double>(kept->data(), columns > 0 ? 2 : 1, shape, owner));
}

/// Numbers over time, a named array each.
class Series {
 public:
  /// @param width  numbers of each row; 0: one, as an array of one dimension.
  /// @returns what add() calls it.
  std::size_t column(std::string name, std::size_t width = 0) {
    columns_.push_back({std::move(name), width, {}});
    return columns_.size() - 1;
  }
  template <class... Values>
  void add(std::size_t column, const Values&... values) {
    (columns_[column].values.push_back(static_cast<double>(values)), ...);
  }
  template <class Vector>
  void add_vector(std::size_t column, const Vector& v) {
    add(column, v.x(), v.y(), v.z());
  }

  /// Empties this. With the interpreter's lock.
  nanobind::dict take() {
    nanobind::dict out;
    for (Column& column : columns_) {
      out[column.name.c_str()] = array_of(std::move(column.values), column.width);
    }
    return out;
  }

 private:
  struct Column {
    std::string name;
    std::size_t width;
    std::vector<double> values;
  };
  std::vector<Column> columns_;
};

}  // namespace rosflight::python
