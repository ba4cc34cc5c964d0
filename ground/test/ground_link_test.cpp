// SPDX-License-Identifier: BSD-3-Clause
#include "ground/ground_link.hpp"

#include <gtest/gtest.h>

#include "base/transport/socket.hpp"

namespace rosflight::ground {
namespace {

using Kind = base::LinkAddress::Kind;

TEST(GroundLinkText, APathIsASerialPort) {
  const auto plain = parse_ground_link("/dev/ttyACM0");
  EXPECT_EQ(plain.kind, Kind::kSerial);
  EXPECT_EQ(plain.path, "/dev/ttyACM0");
  EXPECT_EQ(plain.baud, 921600U);
  EXPECT_EQ(parse_ground_link("/dev/ttyACM0:57600").baud, 57600U);
  EXPECT_EQ(parse_ground_link("./fcu").path, "./fcu");
  EXPECT_EQ(parse_ground_link("serial:/dev/ttyACM0:57600").path, "/dev/ttyACM0");
}

TEST(GroundLinkText, WhatTheBoardPrintsIsTheFarEndOfIt) {
  const auto terminal = parse_ground_link("pty:/dev/pts/3");
  EXPECT_EQ(terminal.kind, Kind::kSerial);
  EXPECT_EQ(terminal.path, "/dev/pts/3");
  EXPECT_EQ(parse_ground_link("tcp:127.0.0.1:5760").kind, Kind::kTcpClient);
}

TEST(GroundLinkText, AFreeUdpPortOfThisMachineIsListenedOnATakenOneIsSentTo) {
  base::SocketAddress any = base::look_up("127.0.0.1", 0, SOCK_DGRAM);
  base::FileDescriptor socket = base::new_socket(any.family(), SOCK_DGRAM);
  ASSERT_TRUE(base::bind_socket(socket, any, SOCK_DGRAM));
  const std::string address = "udp:" + base::own_address(socket).text();
  EXPECT_EQ(parse_ground_link(address).kind, Kind::kUdp);
  socket = base::FileDescriptor{};
  EXPECT_EQ(parse_ground_link(address).kind, Kind::kUdpServer);
  EXPECT_EQ(parse_ground_link("udp:192.0.2.1:14525").kind, Kind::kUdp);  // of no machine (RFC 5737)
}

TEST(GroundLinkText, WhatIsNoLinkSaysWhatIsAllowed) {
  for (const char* text : {"", "usb:3", "serial:", "pty:", "udp:x", "/dev/ttyACM0:fast"}) {
    EXPECT_THROW(parse_ground_link(text), base::LinkError) << text;
  }
}

TEST(GroundLink, SilenceIsOneLineWithLinkAndTimeout) {
  GroundLink link({"tcp:127.0.0.1:9", std::chrono::milliseconds{50}, 1, {}});
  try {
    link.connect();
    FAIL();
  } catch (const NoAnswer& error) {
    EXPECT_EQ(std::string(error.what()).find("no answer from tcp:127.0.0.1:9 within 0.05 s: "), 0U)
        << error.what();
  }
}

TEST(GroundLink, APersonWhoStopsItIsNoticedWhileItWaits) {
  int asked = 0;
  GroundLink link(
      {"tcp:127.0.0.1:9", std::chrono::seconds{60}, 1, [&asked] { return ++asked > 2; }});
  EXPECT_THROW(link.connect(), Stopped);
  EXPECT_FALSE(
      link.finish_until([] { return false; }, std::chrono::milliseconds{20}));  // not stopped
}

}  // namespace
}  // namespace rosflight::ground
