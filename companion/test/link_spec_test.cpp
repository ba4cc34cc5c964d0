// SPDX-License-Identifier: BSD-3-Clause
#include "companion/link_spec.hpp"

#include <gtest/gtest.h>

namespace rosflight::companion {
namespace {

using Kind = LinkSpec::Kind;

TEST(LinkSpec, ReadsEachKind) {
  const LinkSpec serial = parse_link("serial:/dev/ttyACM0:57600");
  EXPECT_EQ(serial.kind, Kind::kSerial);
  EXPECT_EQ(serial.path, "/dev/ttyACM0");
  EXPECT_EQ(serial.baud, 57600U);
  EXPECT_EQ(parse_link("serial:/dev/ttyACM0").baud, 921600U);
  EXPECT_EQ(parse_link("pty").kind, Kind::kPty);
  const LinkSpec udp = parse_link("udp:localhost:14525");
  EXPECT_EQ(udp.kind, Kind::kUdp);
  EXPECT_EQ(udp.host, "localhost");
  EXPECT_EQ(udp.port, 14525);
  EXPECT_EQ(udp.local_port, 14520);
  EXPECT_EQ(parse_link("udp:10.0.0.2:1:2").local_port, 2);
  EXPECT_EQ(parse_link("tcp:[::1]:5760").host, "::1");
  EXPECT_EQ(parse_link("tcp:example.org:5760").kind, Kind::kTcpClient);
  EXPECT_EQ(parse_link("udp:14520").kind, Kind::kUdpServer);
  EXPECT_EQ(parse_link("tcp:5760").kind, Kind::kTcpServer);
}

TEST(LinkSpec, WritesWhatItReads) {
  for (const char* text :
       {"serial:/dev/ttyUSB1:115200", "pty", "udp:14520", "udp:localhost:14525:14520",
        "tcp:[::1]:5760", "tcp:host:1", "tcp:65535"}) {
    EXPECT_EQ(parse_link(text).text(), text);
  }
}

TEST(LinkSpec, SaysInOneLineWhatIsWrong) {
  const auto message = [](const char* text) -> std::string {
    try {
      parse_link(text);
      return "accepted";
    } catch (const LinkError& error) {
      return error.what();
    }
  };
  const std::string kinds =
      "allowed serial:PATH[:BAUD], pty, udp:HOST:PORT[:LOCAL_PORT], udp:PORT, tcp:HOST:PORT or "
      "tcp:PORT";
  EXPECT_EQ(message("usb:1"), "link \"usb:1\": found \"usb\", " + kinds);
  EXPECT_EQ(message(""), "link \"\": found \"\", " + kinds);
  EXPECT_EQ(message("pty:x"), "link \"pty:x\": found \"pty\", " + kinds);
  EXPECT_EQ(message("tcp:0"), "link \"tcp:0\": found port \"0\", allowed a port from 1 to 65535");
  EXPECT_EQ(message("tcp:host:65536"),
            "link \"tcp:host:65536\": found port \"65536\", allowed a port from 1 to 65535");
  EXPECT_EQ(message("tcp:host:"),
            "link \"tcp:host:\": found no port, allowed a port from 1 to 65535");
  EXPECT_EQ(message("udp::14525"),
            "link \"udp::14525\": found no host and port, allowed HOST:PORT");
  EXPECT_EQ(message("tcp:[::1"), "link \"tcp:[::1\": found no host and port, allowed HOST:PORT");
  EXPECT_NE(message("udp:h:1:x").find("port \"x\""), std::string::npos);
  EXPECT_NE(message("serial:").find("no device"), std::string::npos);
  EXPECT_NE(message("serial:/dev/x:123").find("baud rate \"123\", allowed 9600 19200"),
            std::string::npos);
  EXPECT_NE(message("serial:/dev/x:fast").find("baud rate \"fast\""), std::string::npos);
}

}  // namespace
}  // namespace rosflight::companion
