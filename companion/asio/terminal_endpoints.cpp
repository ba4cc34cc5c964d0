// SPDX-License-Identifier: BSD-3-Clause
// Serial ports and pseudo terminals.
#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "companion/asio/endpoint.hpp"

namespace rosflight::companion {

namespace {

using Result = Endpoint::Result;

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

Endpoint::Opened failure(Result result, const std::string& what, int error) {
  return {result, Descriptor{}, what + ": " + std::strerror(error)};
}

/// Bytes as they are, 8N1, no flow control; a read gives what there is.
bool make_raw(int fd, std::uint32_t baud) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) {
    return false;
  }
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB | PARENB | HUPCL);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  for (const auto& [rate, code] : kSpeeds) {
    if (rate == baud) {
      ::cfsetspeed(&settings, code);
    }
  }
  return ::tcsetattr(fd, TCSANOW, &settings) == 0;
}

/// USB converters collect bytes for 16 ms unless told not to. Not all drivers know this; that is no
/// fault.
void ask_for_low_latency(int fd) {
  serial_struct settings{};
  if (::ioctl(fd, TIOCGSERIAL, &settings) == 0) {
    settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
    ::ioctl(fd, TIOCSSERIAL, &settings);
  }
}

class SerialEndpoint final : public Endpoint {
 public:
  explicit SerialEndpoint(const LinkSpec& spec) : path_(spec.path), baud_(spec.baud) {}

  Opened open() override {
    Descriptor fd(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!fd) {
      const int error = errno;
      const bool absent = error == ENOENT || error == ENXIO || error == ENODEV || error == EIO;
      return failure(absent ? Result::kNotNow : Result::kNotPossible, "cannot be opened", error);
    }
    if (::isatty(fd.get()) == 0) {
      return {Result::kNotPossible, {}, "is not a serial port"};
    }
    if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) {
      return {Result::kNotPossible, {}, "is in use by another program"};
    }
    if (!make_raw(fd.get(), baud_)) {
      return failure(Result::kNotPossible, "cannot be set to " + std::to_string(baud_) + " baud",
                     errno);
    }
    ask_for_low_latency(fd.get());
    ::tcflush(fd.get(), TCIFLUSH);
    return {Result::kOpen, std::move(fd), {}};
  }
  std::string name() const override { return path_; }

 private:
  std::string path_;
  std::uint32_t baud_;
};

class PtyEndpoint final : public Endpoint {
 public:
  Opened open() override {
    Descriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!master || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0) {
      return failure(Result::kNotPossible, "cannot be made", errno);
    }
    std::array<char, 128> path{};
    if (::ptsname_r(master.get(), path.data(), path.size()) != 0) {
      return failure(Result::kNotPossible, "has no name", errno);
    }
    // While we hold the other end too, a peer that leaves is silence and not an error.
    peer_ = Descriptor(::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    if (!peer_ || !make_raw(peer_.get(), 921600)) {
      return failure(Result::kNotPossible, "cannot be set up", errno);
    }
    path_ = path.data();
    return {Result::kOpen, std::move(master), {}};
  }
  std::string name() const override { return path_.empty() ? "pty" : "pty " + path_; }

 private:
  Descriptor peer_;
  std::string path_;
};

}  // namespace

std::unique_ptr<Endpoint> make_serial_endpoint(const LinkSpec& spec) {
  return std::make_unique<SerialEndpoint>(spec);
}

std::unique_ptr<Endpoint> make_pty_endpoint() {
  return std::make_unique<PtyEndpoint>();
}

}  // namespace rosflight::companion
