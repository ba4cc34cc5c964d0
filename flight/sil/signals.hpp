// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <csignal>

#include "base/file_descriptor.hpp"

namespace rosflight::flight {

/// SIGINT and SIGTERM as something to wait for, instead of handlers with globals. Signals that came
/// in are used up; before it goes the old mask is back in force.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  int fd() const { return fd_.get(); }
  /// @returns whether one came since the last call.
  bool take();

 private:
  sigset_t before_{};
  base::FileDescriptor fd_;
};

}  // namespace rosflight::flight
