// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <functional>
#include <string>

/// Work in child processes, which begin as copies of the calling one. Call it while the process has one
/// thread.
namespace rosflight::bench::faults {

/// Returns what `work` returns in a child. What it changes in memory stays there.
/// @throws std::runtime_error  it threw, with its message, or its process ended.
std::string in_child(const std::function<std::string()>& work);

/// Calls work(k) once for each k below `count`, in several children, and on_result(k, what it
/// returned) here, in any order.
/// @param children  0: one for each processor.
/// @param work      returns one line of at most 3000 characters.
/// @throws std::runtime_error  as in_child(), after all children have ended.
void in_children(std::size_t count, unsigned children,
                 const std::function<std::string(std::size_t)>& work,
                 const std::function<void(std::size_t, const std::string&)>& on_result);

}  // namespace rosflight::bench::faults
