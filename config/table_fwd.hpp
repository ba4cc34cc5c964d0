// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::config {

/// One row per parameter of the struct S: config/table.hpp.
template <class S>
class Table;

}  // namespace rosflight::config
