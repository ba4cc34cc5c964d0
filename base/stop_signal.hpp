// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <csignal>

namespace rosflight::base {

/// The signal that asked this program to stop while a SignalWatch lived; 0: none.
int stop_signal();

/// While it lives Ctrl-C and SIGTERM are noted instead of ending the program; the second one ends it.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

 private:
  struct sigaction int_before_ {};
  struct sigaction term_before_ {};
};

}  // namespace rosflight::base
