// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/signals.hpp"

#include <sys/signalfd.h>

#include <cerrno>
#include <system_error>

namespace rosflight::flight {

Signals::Signals() {
  sigset_t ends{};
  sigemptyset(&ends);
  sigaddset(&ends, SIGINT);
  sigaddset(&ends, SIGTERM);
  fd_ = base::FileDescriptor{::signalfd(-1, &ends, SFD_NONBLOCK | SFD_CLOEXEC)};
  if (!fd_.valid()) throw std::system_error{errno, std::generic_category(), "signalfd"};
  pthread_sigmask(SIG_BLOCK, &ends, &before_);
}

Signals::~Signals() {
  static_cast<void>(take());
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool Signals::take() {
  bool any = false;
  signalfd_siginfo info{};
  while (::read(fd_.get(), &info, sizeof info) == sizeof info) any = true;
  return any;
}

}  // namespace rosflight::flight
