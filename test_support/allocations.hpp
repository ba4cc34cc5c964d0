// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>

namespace rosflight::test_support {

/// Calls of operator new since the program started, on all threads. A program that uses this
/// function gets its operator new and delete from allocations.cpp, on malloc and free.
std::size_t allocations();

}  // namespace rosflight::test_support
