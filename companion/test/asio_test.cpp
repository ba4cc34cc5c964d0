// SPDX-License-Identifier: BSD-3-Clause
// Real links on this machine, with the fake FCU at the other end. Every wait is for a condition and
// bounded.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "companion/asio/runner.hpp"
#include "companion/test/fake_fcu.hpp"

namespace rosflight::companion::test {
namespace {

using namespace std::chrono_literals;

constexpr auto kMaxDelay = 20s;

/// A port that was free a moment ago.
std::uint16_t free_port(int type) {
  const int fd = ::socket(AF_INET, type, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), size), 0);
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(fd);
  return ntohs(address.sin_port);
}

/// The FCU's end: a link of its own with the fake behind it.
class FcuEnd {
 public:
  explicit FcuEnd(const LinkSpec& spec) : transport(io, make_endpoint(spec)) {
    transport.set_handlers({nullptr, nullptr});
    transport.start();
  }
  void poll() {
    io.restart();
    io.poll();
    fcu.step(Runner::steady_now());
  }

  boost::asio::io_context io;
  LinkTransport transport;
  FakeFcu fcu{transport, numbered_table(50)};
};

/// The companion's end under test.
class CompanionEnd {
 public:
  explicit CompanionEnd(const LinkSpec& spec) : runner(codec, spec, {}) {
    runner.on_link_state([this](bool, const std::string& line) { lines.push_back(line); });
  }

  link::MavlinkCodec codec{{1, link::MavlinkCodec::kCompanionComponent}};
  Runner runner;
  std::vector<std::string> lines;
};

template <class Condition>
bool wait_for(CompanionEnd& companion, FcuEnd* fcu, Condition&& condition) {
  const auto end = std::chrono::steady_clock::now() + kMaxDelay;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    companion.runner.poll();
    if (fcu != nullptr) {
      fcu->poll();
    }
    std::this_thread::sleep_for(500us);
  }
  return true;
}

bool all_well(const CompanionEnd& companion) {
  const Session& session = const_cast<CompanionEnd&>(companion).runner.session();
  return session.connected() && session.parameters().complete() &&
         session.time_sync().synchronised();
}

/// Connects, sets a parameter, loses the peer, finds it again.
void exercise(CompanionEnd& companion, const std::function<std::unique_ptr<FcuEnd>()>& make_fcu) {
  auto fcu = make_fcu();
  ASSERT_TRUE(wait_for(companion, fcu.get(), [&] { return all_well(companion); }));
  const auto job = companion.runner.session().parameters().set("P001", 4.5);
  ASSERT_TRUE(wait_for(companion, fcu.get(), [&] { return !job.pending(); }));
  EXPECT_TRUE(job.done()) << job.text();
  EXPECT_EQ(companion.runner.session().statistics().frames.frames_dropped, 0U);

  fcu.reset();  // the plug is pulled
  ASSERT_TRUE(
      wait_for(companion, nullptr, [&] { return !companion.runner.session().connected(); }));
  fcu = make_fcu();
  ASSERT_TRUE(wait_for(companion, fcu.get(), [&] { return all_well(companion); }));
  const auto again = companion.runner.session().parameters().set("P001", 5.5);
  ASSERT_TRUE(wait_for(companion, fcu.get(), [&] { return !again.pending(); }));
  EXPECT_TRUE(again.done()) << again.text();
  EXPECT_EQ(companion.runner.session().statistics().connections, 2U);
}

class AsioLink : public testing::Test {
 protected:
  AsioLink()
      : folder(std::filesystem::path(testing::TempDir()) /
               ("companion_asio_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder);
  }
  ~AsioLink() override { std::filesystem::remove_all(folder); }

  /// A pseudo terminal behind a name that stays, as udev gives serial devices.
  std::unique_ptr<FcuEnd> pty_named(const std::filesystem::path& link) const {
    auto fcu = std::make_unique<FcuEnd>(parse_link("pty"));
    const std::string name = fcu->transport.name();
    std::filesystem::remove(link);
    std::filesystem::create_symlink(name.substr(name.find('/')), link);
    return fcu;
  }

  std::filesystem::path folder;
};

TEST_F(AsioLink, SerialPortIsWaitedForAndFoundAgain) {
  const auto device = folder / "ttyFCU";
  CompanionEnd companion(parse_link("serial:" + device.string()));
  // Not there yet: no error, but reported.
  ASSERT_TRUE(wait_for(companion, nullptr, [&] { return !companion.lines.empty(); }));
  EXPECT_EQ(companion.lines[0],
            device.string() + ": cannot be opened: No such file or directory; waiting");
  exercise(companion, [&] { return pty_named(device); });
  EXPECT_EQ(companion.lines[1], device.string() + ": open");
}

TEST_F(AsioLink, UdpFindsThePeerAgain) {
  const std::uint16_t fcu_port = free_port(SOCK_DGRAM);
  const std::uint16_t our_port = free_port(SOCK_DGRAM);
  const std::string there =
      "udp:localhost:" + std::to_string(fcu_port) + ":" + std::to_string(our_port);
  const std::string back =
      "udp:localhost:" + std::to_string(our_port) + ":" + std::to_string(fcu_port);
  CompanionEnd companion(parse_link(there));
  exercise(companion, [&] { return std::make_unique<FcuEnd>(parse_link(back)); });
}

// The next peer has another port, as an FCU that was started again may have.
TEST_F(AsioLink, UdpServerTakesTheNextPeer) {
  const std::string our_port = std::to_string(free_port(SOCK_DGRAM));
  CompanionEnd companion(parse_link("udp:" + our_port));
  companion.runner.start();
  exercise(companion, [&] {
    const std::string fcu_port = std::to_string(free_port(SOCK_DGRAM));
    return std::make_unique<FcuEnd>(parse_link("udp:localhost:" + our_port + ":" + fcu_port));
  });
}

TEST_F(AsioLink, TcpClientConnectsAgain) {
  const std::string port = std::to_string(free_port(SOCK_STREAM));
  CompanionEnd companion(parse_link("tcp:localhost:" + port));
  exercise(companion, [&] { return std::make_unique<FcuEnd>(parse_link("tcp:" + port)); });
}

TEST_F(AsioLink, TcpServerTakesTheNextClient) {
  const std::string port = std::to_string(free_port(SOCK_STREAM));
  CompanionEnd companion(parse_link("tcp:" + port));
  companion.runner.start();
  exercise(companion,
           [&] { return std::make_unique<FcuEnd>(parse_link("tcp:localhost:" + port)); });
}

TEST_F(AsioLink, ForeignDatagramsAreNotHeard) {
  const std::uint16_t our_port = free_port(SOCK_DGRAM);
  const std::uint16_t fcu_port = free_port(SOCK_DGRAM);
  const std::uint16_t stranger_port = free_port(SOCK_DGRAM);
  CompanionEnd companion(
      parse_link("udp:localhost:" + std::to_string(fcu_port) + ":" + std::to_string(our_port)));
  companion.runner.start();
  FcuEnd stranger(parse_link("udp:localhost:" + std::to_string(our_port) + ":" +
                             std::to_string(stranger_port)));
  FcuEnd fcu(
      parse_link("udp:localhost:" + std::to_string(our_port) + ":" + std::to_string(fcu_port)));
  fcu.fcu.imu = false;
  ASSERT_TRUE(wait_for(companion, &fcu, [&] {
    stranger.poll();
    return all_well(companion);
  }));
  EXPECT_EQ(companion.runner.session().streams().imu.count, 0U);
}

TEST_F(AsioLink, WhatCannotBeMendedIsOneLine) {
  const auto message = [](const std::string& link) -> std::string {
    try {
      CompanionEnd companion(parse_link(link));
      companion.runner.start();
      return "opened";
    } catch (const LinkError& error) {
      return error.what();
    }
  };
  // Serial port in use.
  const auto device = folder / "ttyFCU";
  const auto fcu = pty_named(device);
  CompanionEnd first(parse_link("serial:" + device.string()));
  first.runner.start();
  EXPECT_EQ(message("serial:" + device.string()),
            device.string() + ": is in use by another program");
  // Not a serial port.
  EXPECT_EQ(message("serial:/dev/null"), "/dev/null: is not a serial port");
  EXPECT_EQ(message("serial:" + folder.string()),
            folder.string() + ": cannot be opened: Is a directory");
  // UDP and TCP ports taken.
  const std::uint16_t udp_port = free_port(SOCK_DGRAM);
  const std::string udp = "udp:localhost:9:" + std::to_string(udp_port);
  CompanionEnd udp_owner(parse_link(udp));
  udp_owner.runner.start();
  EXPECT_EQ(message(udp), "udp localhost:9: local port " + std::to_string(udp_port) +
                              " is in use by another program");
  const std::string tcp_port = std::to_string(free_port(SOCK_STREAM));
  CompanionEnd tcp_owner(parse_link("tcp:" + tcp_port));
  tcp_owner.runner.start();
  EXPECT_EQ(message("tcp:" + tcp_port),
            "tcp port " + tcp_port + ": port " + tcp_port + " is in use by another program");
  // A host that cannot be.
  EXPECT_NE(message("tcp:no.such.host.invalid:1").find("host no.such.host.invalid: "),
            std::string::npos);
}

// A peer that does not read must not stop us, nor fill our memory.
TEST_F(AsioLink, AFullLinkDropsWholeFramesAndGoesOn) {
  const auto device = folder / "ttyFCU";
  auto fcu = pty_named(device);
  CompanionEnd companion(parse_link("serial:" + device.string()));
  companion.runner.start();
  ASSERT_TRUE(companion.runner.transport().connected());
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    companion.runner.poll();
    refused +=
        companion.runner.session().offboard().send(angles(0, 0, 0, 0.5f)) == SendStatus::kLinkBusy;
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(companion.runner.session().offboard().counters().sent, 80U);  // 4 kB there, 4 kB here
  // The peer wakes up: all frames that were taken arrive whole.
  ASSERT_TRUE(wait_for(companion, fcu.get(), [&] { return all_well(companion); }));
  EXPECT_EQ(fcu->fcu.count_received<link::OffboardControl>(),
            companion.runner.session().offboard().counters().sent);
}

TEST_F(AsioLink, OtherThreadsPostTasks) {
  const auto device = folder / "ttyFCU";
  auto fcu = pty_named(device);
  CompanionEnd companion(parse_link("serial:" + device.string()));
  std::thread thread([&] { companion.runner.run(); });
  std::atomic<bool> connected{false};
  std::atomic<int> asked{0};
  const auto end = std::chrono::steady_clock::now() + kMaxDelay;
  while (!connected && std::chrono::steady_clock::now() < end) {
    fcu->poll();
    if (asked == 0) {
      ++asked;
      companion.runner.post([&](Session& session) {
        connected = session.connected();
        --asked;
      });
    }
    std::this_thread::sleep_for(500us);
  }
  companion.runner.stop();
  thread.join();
  EXPECT_TRUE(connected);
}

}  // namespace
}  // namespace rosflight::companion::test
