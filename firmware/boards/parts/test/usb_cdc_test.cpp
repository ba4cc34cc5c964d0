// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/usb_cdc.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rosflight::boards::parts {
namespace {

using Kind = UsbCdc::Answer::Kind;
using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const UsbCdc::Answer& answer) {
  EXPECT_EQ(answer.kind, Kind::kSend);
  return answer.kind == Kind::kSend ? Bytes(answer.data, answer.data + answer.size) : Bytes{};
}

constexpr UsbSetup kOpenPort{0x21, 0x22, 1, 0, 0}, kConfigure{0x00, 9, 1, 0, 0};

TEST(UsbCdc, ASetupPacketIsLittleEndian) {
  const std::uint8_t packet[] = {0x80, 6, 0x03, 0x02, 0x05, 0x04, 0xFF, 0x01};
  const UsbSetup setup = UsbSetup::from(packet);
  EXPECT_EQ(setup.type, 0x80);
  EXPECT_EQ(setup.request, 6);
  EXPECT_EQ(setup.value, 0x0203);
  EXPECT_EQ(setup.index, 0x0405);
  EXPECT_EQ(setup.length, 0x01FF);
}

/// USB 2.0 table 9-8.
TEST(UsbCdc, DeviceDescriptorNamesClassAndIdentity) {
  UsbCdc cdc;
  const Bytes device = bytes_of(cdc.setup({0x80, 6, 0x0100, 0, 64}));
  ASSERT_EQ(device.size(), 18U);
  EXPECT_EQ(device[0], 18);
  EXPECT_EQ(device[1], 1);
  EXPECT_EQ(device[4], 0x02) << "communications class";
  EXPECT_EQ(device[7], 64) << "packets of endpoint 0";
  EXPECT_EQ(device[8] | device[9] << 8, 0x1209);
  EXPECT_EQ(device[17], 1) << "configurations";
  EXPECT_EQ(bytes_of(cdc.setup({0x80, 6, 0x0100, 0, 8})).size(), 8U) << "as many as asked for";
}

/// Walks the configuration as a host does: by the length of each descriptor.
TEST(UsbCdc, ConfigurationIsConsistent) {
  UsbCdc cdc;
  const Bytes all = bytes_of(cdc.setup({0x80, 6, 0x0200, 0, 255}));
  ASSERT_GE(all.size(), 9U);
  ASSERT_EQ(all[2] | all[3] << 8, static_cast<int>(all.size()));
  int interfaces = 0, endpoints_said = 0;
  Bytes endpoints;
  for (std::size_t at = 0; at < all.size(); at += all[at]) {
    ASSERT_GE(all[at], 2) << "at " << at;
    ASSERT_LE(at + all[at], all.size());
    if (all[at + 1] == 4) {
      EXPECT_EQ(all[at + 2], interfaces++);
      endpoints_said += all[at + 4];
    }
    if (all[at + 1] == 5) endpoints.push_back(all[at + 2]);
  }
  EXPECT_EQ(interfaces, all[4]);
  EXPECT_EQ(endpoints_said, static_cast<int>(endpoints.size()));
  EXPECT_EQ(endpoints, (Bytes{0x81, 0x02, 0x82}));
}

TEST(UsbCdc, StringsAreUtf16WithTheirLength) {
  UsbCdc cdc;
  for (const unsigned index : {0U, 1U, 2U, 3U}) {
    const auto value = static_cast<std::uint16_t>(0x0300U | index);
    const Bytes text = bytes_of(cdc.setup({0x80, 6, value, 0x0409, 255}));
    ASSERT_GE(text.size(), 4U);
    EXPECT_EQ(text[0], text.size());
    EXPECT_EQ(text[1], 3);
  }
  EXPECT_EQ(cdc.setup({0x80, 6, 0x0304, 0x0409, 255}).kind, Kind::kStall);
  EXPECT_EQ(cdc.setup({0x80, 6, 0x0600, 0, 10}).kind, Kind::kStall) << "no high speed";
}

TEST(UsbCdc, ThePortIsOpenOnceTheHostSaysSo) {
  UsbCdc cdc;
  EXPECT_EQ(cdc.setup({0x00, 5, 17, 0, 0}).kind, Kind::kDone);
  EXPECT_EQ(cdc.address(), 17);
  EXPECT_EQ(cdc.setup(kOpenPort).kind, Kind::kDone);
  EXPECT_FALSE(cdc.open()) << "not configured";
  EXPECT_EQ(cdc.setup(kConfigure).kind, Kind::kDone);
  EXPECT_TRUE(cdc.configured());
  EXPECT_FALSE(cdc.open());
  EXPECT_EQ(bytes_of(cdc.setup({0x80, 8, 0, 0, 1})), Bytes{1});
  cdc.setup(kOpenPort);
  EXPECT_TRUE(cdc.open());
  cdc.setup({0x21, 0x22, 0, 0, 0});
  EXPECT_FALSE(cdc.open()) << "closed again";
  cdc.setup(kOpenPort);
  cdc.reset();
  EXPECT_FALSE(cdc.open());
  EXPECT_FALSE(cdc.configured());
  EXPECT_EQ(cdc.address(), 0);
}

TEST(UsbCdc, LineCodingIsReadBack) {
  UsbCdc cdc;
  EXPECT_EQ(bytes_of(cdc.setup({0xA1, 0x21, 0, 0, 7})), (Bytes{0x00, 0xC2, 0x01, 0x00, 0, 0, 8}));
  EXPECT_EQ(cdc.setup({0x21, 0x20, 0, 0, 7}).kind, Kind::kReceive);
  const Bytes coding{0x00, 0x10, 0x0E, 0x00, 0, 0, 8};  // 921 600
  cdc.received(coding.data(), coding.size());
  EXPECT_EQ(bytes_of(cdc.setup({0xA1, 0x21, 0, 0, 7})), coding);
  cdc.received(coding.data(), 3);
  EXPECT_EQ(bytes_of(cdc.setup({0xA1, 0x21, 0, 0, 7})), coding) << "cut short: ignored";
  EXPECT_EQ(cdc.setup({0x21, 0x20, 0, 0, 6}).kind, Kind::kStall);
}

TEST(UsbCdc, WhatItDoesNotSupportIsStalled) {
  UsbCdc cdc;
  EXPECT_EQ(cdc.setup({0x00, 9, 2, 0, 0}).kind, Kind::kStall) << "a second configuration";
  EXPECT_EQ(cdc.setup({0x00, 7, 0x0100, 0, 18}).kind, Kind::kStall) << "set descriptor";
  EXPECT_EQ(cdc.setup({0x21, 0x02, 0, 0, 0}).kind, Kind::kStall) << "another class";
  EXPECT_EQ(cdc.setup({0x40, 1, 0, 0, 0}).kind, Kind::kStall) << "of a vendor";
  EXPECT_EQ(cdc.setup({0x02, 3, 0, 0x82, 0}).kind, Kind::kStall) << "endpoints do not halt";
}

TEST(UsbCdc, NoRequestSendsMoreThanTheHostAskedFor) {
  std::mt19937 random(1);
  UsbCdc cdc;
  for (int k = 0; k < 100'000; ++k) {
    const UsbSetup setup{static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                         static_cast<std::uint16_t>(random()), static_cast<std::uint16_t>(random()),
                         static_cast<std::uint16_t>(random() % 80)};
    const UsbCdc::Answer answer = cdc.setup(setup);
    ASSERT_TRUE(answer.kind != Kind::kSend || answer.size <= setup.length);
  }
}

}  // namespace
}  // namespace rosflight::boards::parts
