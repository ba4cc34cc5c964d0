// SPDX-License-Identifier: BSD-3-Clause
// Time from a lone request on the link to the firmware's answer, while the firmware flies at its
// rate.
//
//     sil_link_latency PROGRAM pty|udp|tcp timesync|param SECONDS [SIL_OPTION...]
//
// Starts `PROGRAM sil` on a free link, sends one request at a time at moments that are random with
// respect to the firmware's ticks, and prints one JSON object.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "link/mavlink/mavlink_codec.hpp"
#include "sim/random.hpp"

namespace {

using rosflight::link::MavlinkCodec;
using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error{what + ": " + std::strerror(errno)};
}

/// The program under test; ends with this object.
class Sil {
 public:
  Sil(const std::string& program, const std::vector<std::string>& options) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<std::string> words{program, "sil"};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int code =
        ::posix_spawnp(&pid_, program.c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (code != 0) throw std::runtime_error{program + ": " + std::strerror(code)};
    char c = 0;
    while (::read(ends[0], &c, 1) == 1 && c != '\n') ready_ += c;
    ::close(ends[0]);
    if (ready_.rfind("sil ready ", 0) != 0) throw std::runtime_error{"not ready: " + ready_};
  }
  ~Sil() {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  Sil(const Sil&) = delete;
  Sil& operator=(const Sil&) = delete;

  std::string word(const std::string& key) const {
    const std::size_t at = ready_.find(" " + key + "=");
    if (at == std::string::npos) throw std::runtime_error{"no " + key + " in: " + ready_};
    const std::size_t first = at + key.size() + 2;
    return ready_.substr(first, ready_.find(' ', first) - first);
  }

 private:
  pid_t pid_{};
  std::string ready_;
};

sockaddr_in loopback(const std::string& port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
  return address;
}

int open_socket(int type) {
  const int fd = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
  if (fd < 0) fail("socket");
  return fd;
}

/// A UDP socket must be there before the program is told its port.
int bound_udp(std::string& port) {
  const int fd = open_socket(SOCK_DGRAM);
  sockaddr_in address = loopback("0");
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (::bind(fd, generic, size) != 0 || ::getsockname(fd, generic, &size) != 0) fail("bind");
  port = std::to_string(ntohs(address.sin_port));
  return fd;
}

void connect_to(int fd, const std::string& host_and_port) {
  sockaddr_in address = loopback(host_and_port.substr(host_and_port.rfind(':') + 1));
  if (::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) fail("connect");
}

int open_pty(const std::string& name) {
  const int fd = ::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (fd < 0 || ::tcgetattr(fd, &settings) != 0) fail(name);
  ::cfmakeraw(&settings);
  ::tcsetattr(fd, TCSANOW, &settings);
  return fd;
}

class Client {
 public:
  Client(int fd, bool param) : fd_{fd}, param_{param} {}

  /// @returns the time to the answer, nothing if there was none within a second.
  std::optional<double> ask(std::int64_t stamp) {
    rosflight::link::Message request = rosflight::link::TimeSync{0, stamp};
    if (param_) {
      rosflight::link::ParamRequestRead read;
      read.target_system = 1;
      read.index = 3;
      request = read;
    }
    rosflight::link::Frame frame;
    codec_.encode(request, frame);
    drain();
    const auto sent = Clock::now();
    if (::write(fd_, frame.bytes.data(), frame.size) < 0) fail("write");
    while (Clock::now() - sent < std::chrono::seconds(1)) {
      pollfd set{fd_, POLLIN, 0};
      if (::poll(&set, 1, 100) <= 0) continue;
      if (receive(stamp))
        return std::chrono::duration<double, std::micro>(Clock::now() - sent).count();
    }
    return std::nullopt;
  }

 private:
  void drain() {
    pollfd set{fd_, POLLIN, 0};
    while (::poll(&set, 1, 0) > 0) static_cast<void>(receive(0));
  }
  bool receive(std::int64_t stamp) {
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
    if (n <= 0) fail("read");
    bool answered = false;
    for (std::size_t used = 0; used < static_cast<std::size_t>(n);) {
      const auto result = codec_.decode(bytes.data() + used, static_cast<std::size_t>(n) - used);
      used += result.consumed;
      if (!result.complete) continue;
      const auto& message = codec_.message();
      const auto* sync = std::get_if<rosflight::link::TimeSync>(&message);
      answered = answered || (sync != nullptr && sync->ts1_ns == stamp && sync->tc1_ns != 0) ||
                 (param_ && std::holds_alternative<rosflight::link::ParamValue>(message));
    }
    return answered;
  }

  int fd_;
  bool param_;
  MavlinkCodec codec_{{1, MavlinkCodec::kCompanionComponent}};
};

void report(std::vector<double>& us, std::size_t lost) {
  std::sort(us.begin(), us.end());
  double sum = 0.0;
  for (const double x : us) sum += x;
  const auto at = [&us](double share) {
    return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
  };
  std::cout << nlohmann::ordered_json{{"requests", us.size() + lost},
                                      {"lost", lost},
                                      {"mean_us", sum / static_cast<double>(us.size())},
                                      {"median_us", at(0.5)},
                                      {"p999_us", at(0.999)},
                                      {"max_us", us.back()}}
            << "\n";
}

int measure(const std::vector<std::string>& args) {
  const std::string& kind = args[1];
  std::string port = "0";
  int fd = kind == "udp" ? bound_udp(port) : -1;
  std::vector<std::string> options{"--link", kind == "udp"   ? "udp:127.0.0.1:" + port
                                             : kind == "tcp" ? "tcp:0"
                                                             : "pty"};
  options.insert(options.end(), args.begin() + 4, args.end());
  const Sil sil{args[0], options};
  if (kind == "udp") {
    connect_to(fd, sil.word("listen"));
  } else if (kind == "tcp") {
    fd = open_socket(SOCK_STREAM);
    connect_to(fd, sil.word("link"));
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  } else {
    fd = open_pty(sil.word("link").substr(std::strlen("pty:")));
  }
  Client client{fd, args[2] == "param"};
  auto random = rosflight::sim::RandomSource{1}.stream("request");
  std::vector<double> us;
  std::size_t lost = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(std::stod(args[3]));
  for (std::int64_t stamp = 1; Clock::now() < end; ++stamp) {
    const auto pause = std::chrono::duration<double, std::milli>(random.uniform(0.5, 3.5));
    std::this_thread::sleep_for(pause);
    if (const auto time = client.ask(stamp)) {
      us.push_back(*time);
    } else {
      ++lost;
    }
  }
  if (us.empty()) throw std::runtime_error{"no request was answered"};
  report(us, lost);
  ::close(fd);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.size() < 4) {
    std::cerr << "usage: sil_link_latency PROGRAM pty|udp|tcp timesync|param SECONDS [OPTION...]\n";
    return 2;
  }
  try {
    return measure(args);
  } catch (const std::exception& error) {
    std::cerr << "sil_link_latency: " << error.what() << "\n";
    return 2;
  }
}
