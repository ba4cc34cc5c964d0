// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <stdexcept>

namespace rosflight::boards {

/// The board cannot be put together as asked: one line with what was found and what is allowed.
/// Thrown while constructing only; a running board never throws.
class LinuxError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rosflight::boards
