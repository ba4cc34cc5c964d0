// SPDX-License-Identifier: BSD-3-Clause
#include "base/stop_signal.hpp"

#include <atomic>

namespace rosflight::base {
namespace {

std::atomic<int> received{0};

}  // namespace

int stop_signal() {
  return received;
}

SignalWatch::SignalWatch() {
  received = 0;
  struct sigaction action {};
  action.sa_handler = [](int number) { received = number; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, &int_before_);
  sigaction(SIGTERM, &action, &term_before_);
}

SignalWatch::~SignalWatch() {
  sigaction(SIGINT, &int_before_, nullptr);
  sigaction(SIGTERM, &term_before_, nullptr);
}

}  // namespace rosflight::base
