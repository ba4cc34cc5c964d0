// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <termios.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/transport/pseudo_terminal.hpp"
#include "firmware/boards/linux/linux_error.hpp"
#include "firmware/boards/linux/wire.hpp"

namespace rosflight::boards {
namespace {

LinuxError failure(const std::string& what) {
  return LinuxError{what + ": " + std::strerror(errno)};
}

/// The master side of a pseudo terminal. The kernel reports "hung up" while nobody has the other
/// side open; bytes written then would wait for the next one who opens it, so none are.
class PtyWire final : public Wire {
 public:
  explicit PtyWire(const std::string& link) {
    base::PseudoTerminal terminal = base::PseudoTerminal::open();
    if (!terminal.master.valid()) throw failure("link pty: no pseudo terminal");
    master_ = std::move(terminal.master);
    name_ = std::move(terminal.name);
    if (!clean()) throw failure("link pty: " + name_);
    if (!link.empty()) make_link(link);
  }
  ~PtyWire() override {
    std::error_code code;
    if (!link_.empty() && std::filesystem::read_symlink(link_, code) == name_) {
      std::filesystem::remove(link_, code);
    }
  }
  PtyWire(const PtyWire&) = delete;
  PtyWire& operator=(const PtyWire&) = delete;

  bool refresh() override {
    pollfd set{master_.get(), POLLIN, 0};
    const bool hung_up = ::poll(&set, 1, 0) > 0 && (set.revents & POLLHUP) != 0;
    if (connected_ && hung_up) {
      ++peer_;
      static_cast<void>(clean());
    }
    connected_ = !hung_up;
    return connected_;
  }
  std::uint32_t peer() const override { return peer_; }

  std::size_t receive(std::uint8_t* data, std::size_t capacity) override {
    const ssize_t n = ::read(master_.get(), data, capacity);
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  std::size_t send(const std::uint8_t* data, std::size_t size) override {
    const ssize_t n = ::write(master_.get(), data, size);
    if (n >= 0) return static_cast<std::size_t>(n);
    return errno == EAGAIN || errno == EINTR ? 0 : size;
  }
  void add_to(std::vector<pollfd>& set, bool sending) const override {
    // Hung up is a state that poll() reports without end: a new peer is found by refresh().
    if (!connected_) return;
    set.push_back({master_.get(), static_cast<short>(sending ? POLLIN | POLLOUT : POLLIN), 0});
  }
  std::string where() const override {
    return "link=pty:" + name_ + (link_.empty() ? "" : " symlink=" + link_);
  }

 private:
  /// Plain bytes both ways, without echo, and nothing left over from who was here before.
  bool clean() {
    const base::FileDescriptor slave{::open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)};
    return slave.valid() && base::make_raw(slave) && ::tcflush(slave.get(), TCIFLUSH) == 0;
  }
  void make_link(const std::string& link) {
    std::error_code code;
    // A link whose terminal is gone was left by a process that could not clean up.
    if (std::filesystem::is_symlink(link, code) && !std::filesystem::exists(link, code)) {
      std::filesystem::remove(link, code);
    }
    if (::symlink(name_.c_str(), link.c_str()) != 0) throw failure("link pty:" + link);
    link_ = link;
  }

  base::FileDescriptor master_;
  std::string name_;
  std::string link_;
  std::uint32_t peer_{0};
  bool connected_{false};
};

}  // namespace

std::unique_ptr<Wire> open_pty(const LinkAddress& address) {
  return std::make_unique<PtyWire>(address.path);
}

}  // namespace rosflight::boards
