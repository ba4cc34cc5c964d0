// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/common/host/one_processor.hpp"

namespace rosflight::boards {
namespace {

constexpr pid_t kThisThread = 0;
constexpr unsigned kTurnsTogether = 2000;

}  // namespace

// What fails here costs time and nothing else: the kernel then goes on as it likes.

OneProcessor::OneProcessor() {
  if (::sched_getaffinity(kThisThread, sizeof allowed_, &allowed_) != 0) CPU_ZERO(&allowed_);
}

OneProcessor::~OneProcessor() {
  ::sched_setaffinity(kThisThread, sizeof allowed_, &allowed_);
}

void OneProcessor::next_turn(pid_t child) {
  const unsigned turn = turns_++ % kTurnsTogether;
  if (turn == 0) ::sched_setaffinity(kThisThread, sizeof allowed_, &allowed_);
  if (turn != 1) return;
  const int here = ::sched_getcpu();
  if (here < 0 || here >= CPU_SETSIZE) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<unsigned>(here), &one);
  ::sched_setaffinity(kThisThread, sizeof one, &one);
  ::sched_setaffinity(child, sizeof one, &one);
}

}  // namespace rosflight::boards
