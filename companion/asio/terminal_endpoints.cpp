// SPDX-License-Identifier: BSD-3-Clause
// Serial ports and pseudo terminals.
#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/transport/pseudo_terminal.hpp"
#include "companion/asio/endpoint.hpp"

namespace rosflight::companion {

namespace {

using Result = Endpoint::Result;

Endpoint::Opened failure(Result result, const std::string& what, int error) {
  return {result, FileDescriptor{}, what + ": " + std::strerror(error)};
}

/// USB converters collect bytes for 16 ms unless configured not to. Not all drivers know this; that is no
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
    FileDescriptor fd(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!fd.valid()) {
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
    if (!base::make_raw(fd, baud_)) {
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
    base::PseudoTerminal terminal = base::PseudoTerminal::open();
    if (!terminal.master.valid()) {
      return failure(Result::kNotPossible, "cannot be made", errno);
    }
    // While we hold the other end too, a peer that leaves is silence and not an error.
    peer_ = FileDescriptor(::open(terminal.name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    if (!peer_.valid() || !base::make_raw(peer_, 921600)) {
      return failure(Result::kNotPossible, "cannot be set up", errno);
    }
    path_ = terminal.name;
    return {Result::kOpen, std::move(terminal.master), {}};
  }
  std::string name() const override { return path_.empty() ? "pty" : "pty " + path_; }

 private:
  FileDescriptor peer_;
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
