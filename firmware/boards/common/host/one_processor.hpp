// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sched.h>
#include <sys/types.h>

namespace rosflight::boards {

/// Keeps this thread and a child process that take turns on one processor of the host. Left alone, the kernel puts the
/// one that wakes on an idle processor, which costs six times as much as a switch on the same one (35 and 6 us,
/// measured in a virtual machine); none of the two ever runs beside the other, so nothing is lost.
///
/// Now and then both are set free for one turn and stay where the kernel puts them: several pairs spread over the
/// processors of the host. Made, used and destroyed in one thread, which may run where it might before afterwards.
class OneProcessor {
 public:
  OneProcessor();
  ~OneProcessor();
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

  /// Before a turn of the child.
  void next_turn(pid_t child);

 private:
  cpu_set_t allowed_{};  ///< This thread's, as they were found.
  unsigned turns_{0};
};

}  // namespace rosflight::boards
