// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/link_address.hpp"

#include <gtest/gtest.h>

#include "firmware/boards/linux/board_error.hpp"

namespace rosflight::boards {
namespace {

using Kind = LinkAddress::Kind;

TEST(LinkAddress, PtyWithAndWithoutALink) {
  EXPECT_EQ(LinkAddress::parse("pty").kind, Kind::kPty);
  EXPECT_EQ(LinkAddress::parse("pty").path, "");
  EXPECT_EQ(LinkAddress::parse("pty:/tmp/a:b").path, "/tmp/a:b");
}

TEST(LinkAddress, UdpOfTheGroundPortListensOnTheBoardPort) {
  const LinkAddress usual = LinkAddress::parse("udp:localhost:14520");
  EXPECT_EQ(usual.kind, Kind::kUdp);
  EXPECT_EQ(usual.host, "localhost");
  EXPECT_EQ(usual.port, 14520);
  EXPECT_EQ(usual.listen, 14525);
  EXPECT_EQ(LinkAddress::parse("udp:localhost:14521").listen, 0);
}

TEST(LinkAddress, AddressesOfVersion6StandInBrackets) {
  const LinkAddress address = LinkAddress::parse("udp:[::1]:65535");
  EXPECT_EQ(address.host, "::1");
  EXPECT_EQ(address.port, 65535);
}

TEST(LinkAddress, TcpListensOnLoopbackUnlessToldOtherwise) {
  EXPECT_EQ(LinkAddress::parse("tcp:5760").host, "127.0.0.1");
  EXPECT_EQ(LinkAddress::parse("tcp:5760").port, 5760);
  EXPECT_EQ(LinkAddress::parse("tcp:0.0.0.0:5760").host, "0.0.0.0");
}

class BadLinkAddress : public ::testing::TestWithParam<const char*> {};

TEST_P(BadLinkAddress, IsOneLineWithTheTextAndWhatIsAllowed) {
  try {
    LinkAddress::parse(GetParam());
    ADD_FAILURE() << "taken";
  } catch (const BoardError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind("link '" + std::string{GetParam()} + "': found ", 0), 0u) << text;
    EXPECT_NE(text.find("allowed pty, pty:PATH, udp:HOST:PORT, tcp:PORT"), std::string::npos);
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Texts, BadLinkAddress,
                         ::testing::Values("", "pt", "pty:", "udp", "udp:", "udp:host",
                                           "udp::14520", "udp:host:", "udp:host:0",
                                           "udp:host:65536", "udp:host:-1", "udp:host:14520x",
                                           "udp:::1:14520", "udp:[]:14520", "tcp",
                                           "tcp:", "tcp:port", "tcp:65536", "tcp::5760",
                                           "serial:/dev/ttyUSB0"));

}  // namespace
}  // namespace rosflight::boards
