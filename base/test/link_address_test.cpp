// SPDX-License-Identifier: BSD-3-Clause
#include "base/transport/link_address.hpp"

#include <gtest/gtest.h>

namespace rosflight::base {
namespace {

using Kind = LinkAddress::Kind;

TEST(LinkAddress, ReadsEachKind) {
  const LinkAddress serial = parse_link("serial:/dev/ttyACM0:57600");
  EXPECT_EQ(serial.kind, Kind::kSerial);
  EXPECT_EQ(serial.path, "/dev/ttyACM0");
  EXPECT_EQ(serial.baud, 57600U);
  EXPECT_EQ(parse_link("serial:/dev/ttyACM0").baud, 921600U);
  EXPECT_EQ(parse_link("pty").kind, Kind::kPty);
  const LinkAddress udp = parse_link("udp:localhost:14525");
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

TEST(LinkAddress, WritesWhatItReads) {
  for (const char* text :
       {"serial:/dev/ttyUSB1:115200", "pty", "udp:14520", "udp:localhost:14525:14520",
        "tcp:[::1]:5760", "tcp:host:1", "tcp:65535"}) {
    EXPECT_EQ(parse_link(text).text(), text);
  }
}

TEST(LinkAddressOfBoard, ReadsEachKind) {
  EXPECT_EQ(parse_board_link("pty").kind, Kind::kPty);
  EXPECT_EQ(parse_board_link("pty").path, "");
  EXPECT_EQ(parse_board_link("pty:/tmp/a:b").path, "/tmp/a:b");
  const LinkAddress usual = parse_board_link("udp:localhost:14520");
  EXPECT_EQ(usual.kind, Kind::kUdp);
  EXPECT_EQ(usual.host, "localhost");
  EXPECT_EQ(usual.port, 14520);
  EXPECT_EQ(usual.local_port, 14525) << "the ground's usual port is sent to from the board's";
  EXPECT_EQ(parse_board_link("udp:localhost:14521").local_port, 0);
  EXPECT_EQ(parse_board_link("udp:[::1]:65535").host, "::1");
  EXPECT_EQ(parse_board_link("tcp:5760").kind, Kind::kTcpServer);
  EXPECT_EQ(parse_board_link("tcp:5760").host, "127.0.0.1") << "only this machine unless told";
  EXPECT_EQ(parse_board_link("tcp:0").port, 0);
  EXPECT_EQ(parse_board_link("tcp:0.0.0.0:5760").host, "0.0.0.0");
}

TEST(LinkAddressOfBoard, SaysInOneLineWhatIsWrong) {
  const auto found = [](const char* text) -> std::string {
    try {
      parse_board_link(text);
      return "accepted";
    } catch (const LinkError& error) {
      const std::string line = error.what();
      const std::size_t start = line.find("': found ") + 9;
      return line.substr(start, line.find(", allowed") - start);
    }
  };
  EXPECT_EQ(found("serial:/dev/x"), "'serial'");
  EXPECT_EQ(found("pty:"), "no path");
  EXPECT_EQ(found("udp:host"), "no port");
  EXPECT_EQ(found("udp::14520"), "no host");
  EXPECT_EQ(found("udp:host:0"), "port '0'");
  EXPECT_EQ(found("tcp:65536"), "port '65536'");
  EXPECT_EQ(found("tcp:::1:5760"), "an address with ':' outside brackets");
}

class BadLinkAddressOfBoard : public ::testing::TestWithParam<const char*> {};

TEST_P(BadLinkAddressOfBoard, IsOneLineWithTheTextWhatWasFoundAndWhatIsAllowed) {
  try {
    parse_board_link(GetParam());
    ADD_FAILURE() << "taken";
  } catch (const LinkError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind("link '" + std::string{GetParam()} + "': found ", 0), 0U) << text;
    EXPECT_NE(text.find(", allowed pty, pty:PATH, udp:HOST:PORT, tcp:PORT, tcp:HOST:PORT"),
              std::string::npos)
        << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(Texts, BadLinkAddressOfBoard,
                         ::testing::Values("", "pt", "pty:", "udp", "udp:", "udp:host",
                                           "udp::14520", "udp:host:", "udp:host:0",
                                           "udp:host:65536", "udp:host:-1", "udp:host:14520x",
                                           "udp:::1:14520", "udp:[]:14520", "tcp",
                                           "tcp:", "tcp:port", "tcp:65536", "tcp::5760",
                                           "serial:/dev/ttyUSB0"));

TEST(LinkAddress, SaysInOneLineWhatIsWrong) {
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
}  // namespace rosflight::base
