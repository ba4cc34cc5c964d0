// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/linux_serial.hpp"

#include <numeric>

#include "firmware/boards/linux/linux_error.hpp"
#include "firmware/boards/linux/test/far_end.hpp"

namespace rosflight::boards {
namespace {

using Kind = LinkAddress::Kind;

Bytes counting(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

Bytes read_all(LinuxSerial& serial) {
  Bytes all;
  Bytes buffer(128);
  while (const std::size_t n = serial.read(buffer.data(), buffer.size())) {
    all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

bool write(LinuxSerial& serial, const Bytes& frame) {
  return serial.write(frame.data(), frame.size(), hal::Serial::kOrdinary);
}

std::string error_of(const LinkAddress& address) {
  try {
    const LinuxSerial serial(address);
  } catch (const LinuxError& error) {
    return error.what();
  }
  return "no error";
}

/// Passes until someone is there, or until nobody is.
void wait_for_peer(LinuxSerial& serial, bool there) {
  for (int ms = 0; ms < kTimeout_ms; ++ms) {
    serial.receive();
    ASSERT_TRUE(write(serial, {0}));
    serial.transmit();
    const std::uint64_t before = serial.counters().bytes_sent;
    ASSERT_TRUE(write(serial, {0}));
    serial.transmit();
    if ((serial.counters().bytes_sent > before) == there) return;
    ::usleep(1000);
  }
  FAIL() << "peer " << (there ? "never came" : "never left");
}

class EveryWire : public ::testing::TestWithParam<Kind> {
 protected:
  Pair pair_ = Pair::of(GetParam());
  LinuxSerial& serial_ = *pair_.near;
};

TEST_P(EveryWire, CarriesEveryByteValueBothWaysUnchanged) {
  const Bytes bytes = counting(512);
  pair_.deliver(bytes);
  const Bytes received = read_all(serial_);
  EXPECT_EQ(received, bytes);
  ASSERT_TRUE(write(serial_, received));
  EXPECT_EQ(pair_.sent(bytes.size()), bytes);
}

TEST_P(EveryWire, APassReadsABoundedPieceOfAFloodAndKnowsThatThereIsMore) {
  const Bytes flood = counting(3 * LinuxSerial::kReceiveChunk);
  Bytes all;
  std::size_t sent = 0;
  while (all.size() < flood.size()) {
    while (sent < flood.size()) {
      const std::size_t piece = std::min<std::size_t>(6000, flood.size() - sent);
      const ssize_t n = ::write(pair_.far.get(), flood.data() + sent, piece);
      if (n <= 0) break;
      sent += static_cast<std::size_t>(n);
    }
    if (!serial_.more()) {
      ASSERT_TRUE(pair_.wait_near());
    }
    serial_.receive();
    const Bytes piece = read_all(serial_);
    ASSERT_LE(piece.size(), LinuxSerial::kReceiveChunk);
    all.insert(all.end(), piece.begin(), piece.end());
  }
  EXPECT_EQ(all, flood);
  EXPECT_FALSE(serial_.more());
}

TEST_P(EveryWire, NeverBlocksAndDropsWholeFramesWhenTheFarEndDoesNotRead) {
  const Bytes frame(200, 0x5A);
  std::size_t taken = 0;
  constexpr std::size_t kFrames = 100'000;  // 20 MB: more than any buffer on the way
  for (std::size_t k = 0; k < kFrames; ++k) {
    if (write(serial_, frame)) ++taken;
    serial_.transmit();
  }
  // A network loses what nobody reads; a wire backs up until the queue drops.
  if (GetParam() != Kind::kUdp) {
    EXPECT_LT(taken, kFrames);
    EXPECT_EQ(serial_.counters().frames_dropped, kFrames - taken);
    std::vector<pollfd> set;
    serial_.add_to(set);
    EXPECT_NE(set.back().events & POLLOUT, 0);
  }
  Bytes got = pair_.sent(frame.size());
  ASSERT_FALSE(got.empty());
  // A stream may be read in the middle of a frame; the rest must follow.
  if (const std::size_t begun = got.size() % frame.size(); begun != 0) {
    const Bytes rest = pair_.sent(frame.size() - begun);
    got.insert(got.end(), rest.begin(), rest.end());
  }
  EXPECT_EQ(got.size() % frame.size(), 0u);
  EXPECT_TRUE(std::all_of(got.begin(), got.end(), [](std::uint8_t b) { return b == 0x5A; }));
}

TEST_P(EveryWire, ACutLinkSwallowsBothDirectionsUntilItIsWhole) {
  serial_.set_cut(true);
  pair_.deliver({1, 2, 3});
  EXPECT_EQ(read_all(serial_), Bytes{});
  ASSERT_TRUE(write(serial_, {4, 5}));
  EXPECT_EQ(pair_.sent(0), Bytes{});
  serial_.set_cut(false);
  pair_.deliver({6});
  EXPECT_EQ(read_all(serial_), Bytes{6});
  ASSERT_TRUE(write(serial_, {7}));
  EXPECT_EQ(pair_.sent(1), Bytes{7});
}

TEST_P(EveryWire, AResetForgetsWhatWaits) {
  pair_.deliver({1, 2, 3});
  ASSERT_TRUE(write(serial_, {4, 5}));
  serial_.clear();
  EXPECT_EQ(read_all(serial_), Bytes{});
  EXPECT_EQ(pair_.sent(0), Bytes{});
  EXPECT_EQ(serial_.writable(), LinuxSerial::kTransmitCapacity);
}

INSTANTIATE_TEST_SUITE_P(Wires, EveryWire,
                         ::testing::Values(Kind::kPty, Kind::kUdp, Kind::kTcpServer));

class WireWithClients : public EveryWire {};

TEST_P(WireWithClients, BytesSentJustBeforeLeavingAreRead) {
  ASSERT_EQ(::write(pair_.far.get(), "abc", 3), 3);
  pair_.far.close();
  Bytes all;
  while (all.size() < 3) {
    ASSERT_TRUE(pair_.wait_near());
    serial_.receive();
    const Bytes piece = read_all(serial_);
    all.insert(all.end(), piece.begin(), piece.end());
  }
  EXPECT_EQ(all, (Bytes{'a', 'b', 'c'}));
}

INSTANTIATE_TEST_SUITE_P(Wires, WireWithClients, ::testing::Values(Kind::kPty, Kind::kTcpServer));

TEST(LinuxSerial, TakesAnyRateOfItsOneDevice) {
  const Pair pair = Pair::of(Kind::kTcpServer);
  EXPECT_TRUE(pair.near->open(921600, 0));
  EXPECT_TRUE(pair.near->open(9600, 0));
  EXPECT_FALSE(pair.near->open(921600, 1));
  EXPECT_FALSE(pair.near->open(0, 0));
}

TEST(PtyWire, TheNextOneFindsARawTerminalWithoutLeftOvers) {
  Pair pair = Pair::of(Kind::kPty);
  const std::string name = word(pair.near->where(), "link").substr(4);
  // Someone turns it into a terminal for people, does not read, and leaves.
  termios settings{};
  ASSERT_EQ(::tcgetattr(pair.far.get(), &settings), 0);
  settings.c_lflag |= ECHO | ICANON;
  settings.c_oflag |= OPOST | ONLCR;
  ASSERT_EQ(::tcsetattr(pair.far.get(), TCSANOW, &settings), 0);
  ASSERT_TRUE(write(*pair.near, counting(100)));
  pair.near->transmit();
  pair.far.close();
  wait_for_peer(*pair.near, false);

  pair.far = open_slave(name);
  ASSERT_TRUE(pair.far.valid());
  ASSERT_EQ(::tcgetattr(pair.far.get(), &settings), 0);
  EXPECT_EQ(settings.c_lflag & (ECHO | ICANON), 0u);
  EXPECT_EQ(settings.c_oflag & OPOST, 0u);
  pair.near->receive();
  ASSERT_TRUE(write(*pair.near, {1, 10, 13, 4}));
  EXPECT_EQ(pair.sent(4), (Bytes{1, 10, 13, 4}));
}

TEST(PtyWire, NobodyThereIsNothingToWaitFor) {
  Pair pair = Pair::of(Kind::kPty);
  pair.far.close();
  wait_for_peer(*pair.near, false);
  std::vector<pollfd> set;
  pair.near->add_to(set);
  EXPECT_TRUE(set.empty());
}

TEST(PtyWire, MakesALinkAndTakesItAway) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "fcu";
  {
    const LinuxSerial serial(base::parse_board_link("pty:" + path.string()));
    EXPECT_EQ(word(serial.where(), "symlink"), path.string());
    EXPECT_EQ("pty:" + std::filesystem::read_symlink(path).string(), word(serial.where(), "link"));
    // The name is taken now.
    EXPECT_EQ(error_of(base::parse_board_link("pty:" + path.string())),
              "link pty:" + path.string() + ": File exists");
  }
  EXPECT_FALSE(std::filesystem::is_symlink(path));
}

TEST(PtyWire, ReplacesALinkThatLeadsNowhere) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "fcu";
  std::filesystem::create_symlink(folder / "gone", path);
  const LinuxSerial serial(base::parse_board_link("pty:" + path.string()));
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(TcpWire, TakesTheNextClientWhenOneLeaves) {
  Pair pair = Pair::of(Kind::kTcpServer);
  const std::uint16_t port = port_in(word(pair.near->where(), "link"));
  ASSERT_TRUE(write(*pair.near, {1, 2, 3}));  // for the first, who leaves
  pair.far.close();
  wait_for_peer(*pair.near, false);
  pair.far = connect_tcp(port);
  ASSERT_TRUE(pair.far.valid());
  ASSERT_TRUE(pair.wait_near());
  pair.near->receive();
  ASSERT_TRUE(write(*pair.near, {9}));
  EXPECT_EQ(pair.sent(1), Bytes{9});
  pair.deliver({8});
  EXPECT_EQ(read_all(*pair.near), Bytes{8});
}

TEST(TcpWire, AnswersTheFirstBytesOfAClientThatCameInTheSameMomentAsTheOldOneLeft) {
  Pair pair = Pair::of(Kind::kTcpServer);
  ASSERT_TRUE(write(*pair.near, {1}));  // for the one who leaves
  pair.far.close();
  pair.far = connect_tcp(port_in(word(pair.near->where(), "link")));
  ASSERT_EQ(::write(pair.far.get(), "a", 1), 1);
  const std::uint64_t before = pair.near->counters().bytes_received;
  while (pair.near->counters().bytes_received == before) {
    ASSERT_TRUE(pair.wait_near());
    pair.near->receive();
  }
  ASSERT_TRUE(write(*pair.near, {9}));
  EXPECT_EQ(pair.sent(1), Bytes{9});
}

TEST(TcpWire, ASecondClientWaitsUntilTheFirstHasLeft) {
  Pair pair = Pair::of(Kind::kTcpServer);
  base::FileDescriptor second = connect_tcp(port_in(word(pair.near->where(), "link")));
  ASSERT_TRUE(second.valid());
  EXPECT_FALSE(pair.wait_near(kSilence_ms));
  pair.near->receive();
  ASSERT_TRUE(write(*pair.near, {9}));
  EXPECT_EQ(pair.sent(1), Bytes{9});
  pair.far.close();
  pair.far = std::move(second);
  while (pair.near->counters().bytes_received == 0) {
    static_cast<void>(::write(pair.far.get(), "a", 1));
    ASSERT_TRUE(pair.wait_near());
    pair.near->receive();
  }
  ASSERT_TRUE(write(*pair.near, {8}));
  EXPECT_EQ(pair.sent(1), Bytes{8});
}

TEST(TcpWire, ATakenPortIsOneLine) {
  const Pair pair = Pair::of(Kind::kTcpServer);
  const std::string port = std::to_string(port_in(word(pair.near->where(), "link")));
  EXPECT_EQ(error_of(base::parse_board_link("tcp:" + port)),
            "link tcp 127.0.0.1:" + port + ": found 'Address already in use', allowed a free port");
}

TEST(UdpWire, ATakenPortIsOneLine) {
  std::uint16_t port = 0;
  const base::FileDescriptor taken = bound_udp(port);
  LinkAddress address = base::parse_board_link("udp:127.0.0.1:9");
  address.local_port = port;
  EXPECT_EQ(error_of(address), "link udp 127.0.0.1:" + std::to_string(port) +
                                   ": found 'Address already in use', allowed a free port");
}

TEST(UdpWire, AnUnknownHostIsOneLine) {
  EXPECT_EQ(error_of(base::parse_board_link("udp:no host has this name:14520"))
                .rfind("link: found host 'no host has this name' (", 0),
            0u);
}

TEST(UdpWire, HearsEveryoneAndTellsWhereItListens) {
  const Pair pair = Pair::of(Kind::kUdp);
  std::uint16_t port = 0;
  const base::FileDescriptor stranger = bound_udp(port);
  sockaddr_in address = loopback(port_in(word(pair.near->where(), "listen")));
  ASSERT_EQ(
      ::sendto(stranger.get(), "xyz", 3, 0, reinterpret_cast<sockaddr*>(&address), sizeof address),
      3);
  ASSERT_TRUE(pair.wait_near());
  pair.near->receive();
  EXPECT_EQ(read_all(*pair.near), (Bytes{'x', 'y', 'z'}));
}

TEST(UdpWire, SendsWholeFramesInDatagramsBelow1400Bytes) {
  Pair pair = Pair::of(Kind::kUdp);
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(write(*pair.near, Bytes(263, 1)));
  pair.near->transmit();
  std::size_t total = 0;
  while (total < 2630) {
    pollfd set{pair.far.get(), POLLIN, 0};
    ASSERT_EQ(::poll(&set, 1, kTimeout_ms), 1);
    Bytes buffer(65536);
    const ssize_t n = ::read(pair.far.get(), buffer.data(), buffer.size());
    ASSERT_GT(n, 0);
    EXPECT_LE(n, 1400);
    EXPECT_EQ(n % 263, 0);
    total += static_cast<std::size_t>(n);
  }
}

TEST(UdpWire, SurvivesAFarEndThatIsNotThere) {
  Pair pair = Pair::of(Kind::kUdp);
  pair.far.close();
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(write(*pair.near, Bytes(100, 1)));
    pair.near->transmit();
    pair.near->receive();
  }
  EXPECT_EQ(pair.near->writable(), LinuxSerial::kTransmitCapacity);
}

}  // namespace
}  // namespace rosflight::boards
