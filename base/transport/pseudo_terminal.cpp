// SPDX-License-Identifier: BSD-3-Clause
#include "base/transport/pseudo_terminal.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <utility>

namespace rosflight::base {
namespace {

constexpr std::array<std::pair<std::uint32_t, speed_t>, 14> kSpeeds{{{9600, B9600},
                                                                     {19200, B19200},
                                                                     {38400, B38400},
                                                                     {57600, B57600},
                                                                     {115200, B115200},
                                                                     {230400, B230400},
                                                                     {460800, B460800},
                                                                     {500000, B500000},
                                                                     {576000, B576000},
                                                                     {921600, B921600},
                                                                     {1000000, B1000000},
                                                                     {1500000, B1500000},
                                                                     {2000000, B2000000},
                                                                     {3000000, B3000000}}};

}  // namespace

PseudoTerminal PseudoTerminal::open() {
  PseudoTerminal terminal;
  FileDescriptor master{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  constexpr std::size_t kNameSize = 128;
  std::array<char, kNameSize> name{};
  if (!master.valid() || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0) {
    return terminal;
  }
  if (const int error = ::ptsname_r(master.get(), name.data(), name.size()); error != 0) {
    errno = error;
    return terminal;
  }
  terminal.master = std::move(master);
  terminal.name = name.data();
  return terminal;
}

bool make_raw(const FileDescriptor& terminal, std::uint32_t baud) {
  termios settings{};
  if (::tcgetattr(terminal.get(), &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB | PARENB | HUPCL);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  for (const auto& [rate, code] : kSpeeds) {
    if (rate == baud) ::cfsetspeed(&settings, code);
  }
  return ::tcsetattr(terminal.get(), TCSANOW, &settings) == 0;
}

}  // namespace rosflight::base
