// SPDX-License-Identifier: BSD-3-Clause
#include "base/transport/socket.hpp"

#include <gtest/gtest.h>

#include <cerrno>

namespace rosflight::base {
namespace {

TEST(Socket, AddressesAreWrittenAsPeopleWriteThem) {
  EXPECT_EQ(look_up("localhost", 14520, SOCK_DGRAM).text(), "127.0.0.1:14520");
  EXPECT_EQ(look_up("::1", 1, SOCK_DGRAM).text(), "[::1]:1");
  EXPECT_EQ(any_address(AF_INET, 7).text(), "0.0.0.0:7");
  EXPECT_EQ(any_address(AF_INET6, 7).text(), "[::]:7");
}

TEST(Socket, UnknownHostIsAnErrorWithTheReasonOfTheSystem) {
  try {
    look_up("no host has this name", 1, SOCK_STREAM);
    FAIL();
  } catch (const LinkError& error) {
    EXPECT_STRNE(error.what(), "");
  }
}

TEST(Socket, FarEndOnLoopbackIsReceivedOnLoopbackOnly) {
  EXPECT_EQ(own_side(look_up("127.0.0.1", 1, SOCK_DGRAM), 9).text(), "127.0.0.1:9");
  EXPECT_EQ(own_side(look_up("10.1.2.3", 1, SOCK_DGRAM), 9).text(), "0.0.0.0:9");
  EXPECT_EQ(own_side(look_up("::1", 1, SOCK_DGRAM), 9).text(), "[::1]:9");
  EXPECT_EQ(own_side(look_up("fe80::1", 1, SOCK_DGRAM), 9).text(), "[::]:9");
}

TEST(Socket, TakenPortIsReportedByErrno) {
  const FileDescriptor first = new_socket(AF_INET, SOCK_STREAM);
  ASSERT_TRUE(bind_socket(first, look_up("127.0.0.1", 0, SOCK_STREAM), SOCK_STREAM));
  const FileDescriptor second = new_socket(AF_INET, SOCK_STREAM);
  EXPECT_FALSE(bind_socket(second, own_address(first), SOCK_STREAM));
  EXPECT_EQ(errno, EADDRINUSE);
  const FileDescriptor nobody = accept_client(first);
  EXPECT_FALSE(nobody.valid());
  EXPECT_TRUE(would_block(errno));
}

}  // namespace
}  // namespace rosflight::base
