// SPDX-License-Identifier: BSD-3-Clause
// The USB device and the host at its far end, without a firmware: the device is set up by hand here.
#include <gtest/gtest.h>

#include "firmware/boards/stm32h7/emulator/test/models_rig.hpp"
#include "firmware/boards/stm32h7/emulator/usb_host.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

constexpr Ticks kMillisecond = 1000 * kTicksPerMicrosecond;
constexpr std::uint32_t kOut0 = 0xB00, kIn2 = 0x940, kFifo = 0x1000;

class Usb : public Models {
 protected:
  Usb() {
    start_clocks();
    usb.reset();
    write(clocks, rcc::PLL3DIVR, 479U | 59U << 9U | 19U << 16U | 14U << 24U);
    write(clocks, rcc::CR, clocks_on | rcc::CR_PLL3ON(1));
    write(clocks, rcc::D2CCIP2R, rcc::D2CCIP2R_USBSEL(2));
    write(power, pwr::CR3, pwr::CR3_LDOEN(1) | pwr::CR3_USB33DEN(1));
    write(usb, otg::GUSBCFG, otg::GUSBCFG_PHYSEL(1) | otg::GUSBCFG_FDMOD(1) | otg::GUSBCFG_TRDT(6));
    write(usb, otg::GCCFG, otg::GCCFG_PWRDWN(1));
    write(usb, otg::DCFG, otg::DCFG_DSPD(3));
    write(usb, otg::GRXFSIZ, 128);
    write(usb, otg::DIEPTXF0, 128U | 64U << 16U);
    write(usb, otg::DIEPTXF1, 192U | 16U << 16U);
    write(usb, otg::DIEPTXF2, 208U | 256U << 16U);
    write(usb, otg::DIEPMSK, 1);
    write(usb, otg::DOEPMSK, otg::DOEPMSK_XFRCM(1) | otg::DOEPMSK_STUPM(1));
    write(usb, otg::DAINTMSK, 0xFFFF'FFFFU);
    write(usb, otg::GAHBCFG, otg::GAHBCFG_GINT(1));
    write(usb, otg::GINTMSK, otg::GINTSTS_RXFLVL(1) | otg::GINTSTS_IEPINT(1));
  }
  void attach() { write(usb, otg::DCTL, 0); }
  void enable_in(std::uint32_t at, std::uint32_t size) {
    write(usb, at + otg_in::DIEPTSIZ, otg_in::DIEPTSIZ_PKTCNT(1) | otg_in::DIEPTSIZ_XFRSIZ(size));
    write(usb, at, otg_in::DIEPCTL_EPENA(1) | otg_in::DIEPCTL_CNAK(1));
  }
  UsbModel usb{core, clocks, power};
};

TEST_F(Usb, APacketGoesEachWay) {
  attach();
  enable_in(kIn2, 5);
  write(usb, kFifo * 3, 0x44332211U);
  UsbModel::Packet packet;
  EXPECT_EQ(usb.receive(2, packet), UsbModel::Result::kNak) << "the FIFO holds four bytes of five";
  write(usb, kFifo * 3, 0x55U);
  EXPECT_EQ(usb.receive(2, packet), UsbModel::Result::kDone);
  EXPECT_EQ(packet, (UsbModel::Packet{0x11, 0x22, 0x33, 0x44, 0x55}));
  EXPECT_EQ(usb.receive(2, packet), UsbModel::Result::kNak) << "one transfer was enabled";
  EXPECT_TRUE(core.lines.count(irq::OTG_FS));

  EXPECT_EQ(usb.send(0, {1, 2, 3}), UsbModel::Result::kNak) << "not enabled";
  write(usb, kOut0 + otg_out::DOEPTSIZ, otg_out::DOEPTSIZ_PKTCNT(1) | 64U);
  write(usb, kOut0, otg_out::DOEPCTL_EPENA(1) | otg_out::DOEPCTL_CNAK(1));
  EXPECT_EQ(usb.send(0, {1, 2, 3}), UsbModel::Result::kDone);
  EXPECT_EQ(usb.send(0, {4}), UsbModel::Result::kNak) << "one packet was allowed";
  const std::uint32_t status = read(usb, otg::GRXSTSP);
  EXPECT_EQ(otg::GRXSTSP_BCNT.of(status), 3U);
  EXPECT_EQ(read(usb, kFifo), 0x030201U);
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(Usb, WhatSiliconWouldNotDoIsComplainedOf) {
  read(usb, otg::GRXSTSP);
  expect_complaint("read while empty");
  write(usb, kFifo * 3, 0);
  expect_complaint("before its endpoint is enabled");
  enable_in(kIn2, 64);
  enable_in(kIn2, 64);
  expect_complaint("endpoint 2 is enabled while a transfer runs");
  write(usb, otg::DIEPTXF1, 190U | 16U << 16U);
  attach();
  expect_complaint("overlap");
  usb.reset();
  attach();
  EXPECT_NE(core.complaints.front().find("not set up as a full-speed device"), std::string::npos);
  core.complaints.clear();
  write(clocks, rcc::D2CCIP2R, 0);
  write(power, pwr::CR3, pwr::CR3_LDOEN(1));
  usb.reset();
  attach();
  ASSERT_GE(core.complaints.size(), 2U);
  EXPECT_NE(core.complaints[0].find("without a clock of 48 MHz"), std::string::npos);
  EXPECT_NE(core.complaints[1].find("without the supply"), std::string::npos);
}

TEST_F(Usb, AHostWithoutAnAnswerComplains) {
  UsbHost host{core, usb};
  attach();
  write(usb, kOut0 + otg_out::DOEPTSIZ, otg_out::DOEPTSIZ_STUPCNT(3));
  host.plug(true);
  core.run_for(105 * kMillisecond);
  EXPECT_NE(otg::GINTSTS_USBRST.of(read(usb, otg::GINTSTS)), 0U) << "100 ms after it is seen";
  core.run_for(1000 * kMillisecond);
  expect_complaint("no answer to request 0");
  EXPECT_FALSE(host.running());
}

TEST_F(Usb, APulledCableIsASuspendedBus) {
  UsbHost host{core, usb};
  attach();
  host.plug(true);
  core.run_for(10 * kMillisecond);
  host.plug(false);
  core.run_for(2 * kMillisecond);
  EXPECT_EQ(otg::GINTSTS_USBSUSP.of(read(usb, otg::GINTSTS)), 0U);
  core.run_for(2 * kMillisecond);
  EXPECT_NE(otg::GINTSTS_USBSUSP.of(read(usb, otg::GINTSTS)), 0U) << "3 ms of silence";
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
