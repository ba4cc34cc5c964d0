// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/usb_port.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr Instance kUsb = USB2_OTG_FS;
constexpr unsigned kFunction = 10;
constexpr std::uint8_t kNotify = parts::UsbCdc::kNotify, kData = parts::UsbCdc::kData;
constexpr std::uint32_t kEndpointSize = 0x20;

// FIFOs in words of the 1024 there are: received packets, then endpoints 0, 1, 2 to the host.
constexpr std::uint32_t kReceiveWords = 128, kControlWords = 64, kNotifyWords = 16,
                        kDataWords = 256;
static_assert(UsbPort::kMaxTransfer <= 4 * kDataWords);

/// Status of a received packet: RM0433 register GRXSTSP.
enum PacketStatus : std::uint32_t { kOutData = 2, kSetupData = 6 };
enum EndpointType : std::uint32_t { kBulk = 2, kInterrupt = 3 };

volatile std::uint32_t& core(std::uint32_t offset) {
  return reg(kUsb, offset);
}
volatile std::uint32_t& in(std::uint32_t endpoint, std::uint32_t offset) {
  return reg(kUsb, 0x900u + kEndpointSize * endpoint + offset);
}
volatile std::uint32_t& out(std::uint32_t endpoint, std::uint32_t offset) {
  return reg(kUsb, 0xB00u + kEndpointSize * endpoint + offset);
}
volatile std::uint32_t& fifo(std::uint32_t endpoint) {
  return reg(kUsb, 0x1000u * (endpoint + 1u));
}

void await(std::uint32_t offset, const Field& field, std::uint32_t value) {
  while (field.of(core(offset)) != value) {
  }
}

void flush_fifos() {
  constexpr std::uint32_t kAll = 0x10;
  core(otg::GRSTCTL) = otg::GRSTCTL_TXFNUM(kAll) | otg::GRSTCTL_TXFFLSH(1);
  await(otg::GRSTCTL, otg::GRSTCTL_TXFFLSH, 0);
  core(otg::GRSTCTL) = otg::GRSTCTL_RXFFLSH(1);
  await(otg::GRSTCTL, otg::GRSTCTL_RXFFLSH, 0);
}

/// Ends the transfer of an endpoint; the bits are the same for both directions.
void stop(volatile std::uint32_t& control) {
  const bool runs = otg_in::DIEPCTL_EPENA.of(control) != 0;
  control = otg_in::DIEPCTL_SNAK(1) | otg_in::DIEPCTL_EPDIS(runs);
}

/// One transfer to the host: sizes, enable, then the bytes into the FIFO.
void start_in(std::uint32_t endpoint, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kPacket = parts::UsbCdc::kPacketBytes;
  const std::size_t packets = std::max<std::size_t>((size + kPacket - 1) / kPacket, 1);
  in(endpoint, otg_in::DIEPTSIZ) = otg_in::DIEPTSIZ_PKTCNT(static_cast<std::uint32_t>(packets)) |
                                   otg_in::DIEPTSIZ_XFRSIZ(static_cast<std::uint32_t>(size));
  in(endpoint, otg_in::DIEPCTL) =
      in(endpoint, otg_in::DIEPCTL) | otg_in::DIEPCTL_CNAK(1) | otg_in::DIEPCTL_EPENA(1);
  std::uint32_t word = 0;
  std::size_t at = 0;
  for (; at + sizeof(word) <= size; at += sizeof(word)) {
    std::memcpy(&word, data + at, sizeof(word));
    fifo(endpoint) = word;
  }
  if (at == size) return;
  word = 0;
  std::memcpy(&word, data + at, size - at);
  fifo(endpoint) = word;
}

}  // namespace

// ---- start

void UsbPort::open(const Pin& minus, const Pin& plus) {
  modify(reg(PWR, pwr::CR3), pwr::CR3_USB33DEN, 1);
  while (pwr::CR3_USB33RDY.of(reg(PWR, pwr::CR3)) == 0) {
  }
  make_alternate(minus, kFunction);
  make_alternate(plus, kFunction);
  open_gate(kUsb);
  constexpr std::uint32_t kTurnaround = 6;
  core(otg::GAHBCFG) = 0;
  core(otg::GUSBCFG) = otg::GUSBCFG_PHYSEL(1);
  await(otg::GRSTCTL, otg::GRSTCTL_AHBIDL, 1);
  core(otg::GRSTCTL) = otg::GRSTCTL_CSRST(1);
  await(otg::GRSTCTL, otg::GRSTCTL_CSRST, 0);
  core(otg::GCCFG) = otg::GCCFG_PWRDWN(1);
  core(otg::GUSBCFG) =
      otg::GUSBCFG_PHYSEL(1) | otg::GUSBCFG_FDMOD(1) | otg::GUSBCFG_TRDT(kTurnaround);
  changed_us_ = microseconds();
  started_ = false;
}

void UsbPort::step() {
  constexpr std::uint32_t kModeChange_us = 25'000;
  if (started_ || microseconds() - changed_us_ <= kModeChange_us) return;
  started_ = true;
  start_device();
}

void UsbPort::start_device() {
  constexpr std::uint32_t kFullSpeed = 3;
  modify(core(otg::DCTL), otg::DCTL_SDIS, 1);
  core(otg::GOTGCTL) = otg::GOTGCTL_BVALOEN(1) | otg::GOTGCTL_BVALOVAL(1);
  core(otg::PCGCCTL) = 0;
  core(otg::DCFG) = otg::DCFG_DSPD(kFullSpeed);
  std::uint32_t at = kReceiveWords;
  core(otg::GRXFSIZ) = kReceiveWords;
  core(otg::DIEPTXF0) = otg::DIEPTXF0_TX0FSA(at) | otg::DIEPTXF0_TX0FD(kControlWords);
  at += kControlWords;
  core(otg::DIEPTXF1) = otg::DIEPTXF1_INEPTXSA(at) | otg::DIEPTXF1_INEPTXFD(kNotifyWords);
  at += kNotifyWords;
  core(otg::DIEPTXF2) = otg::DIEPTXF2_INEPTXSA(at) | otg::DIEPTXF2_INEPTXFD(kDataWords);
  core(otg::GINTMSK) = otg::GINTSTS_USBRST(1) | otg::GINTSTS_ENUMDNE(1) | otg::GINTSTS_RXFLVL(1) |
                       otg::GINTSTS_IEPINT(1) | otg::GINTSTS_OEPINT(1) | otg::GINTSTS_USBSUSP(1) |
                       otg::GINTSTS_WKUINT(1);
  enable_interrupt(irq::OTG_FS, Priority::kBus);
  core(otg::GAHBCFG) = otg::GAHBCFG_GINT(1);
  modify(core(otg::DCTL), otg::DCTL_SDIS, 0);
}

/// The host begins again: address 0, only endpoint 0.
void UsbPort::bus_reset() {
  cdc_.reset();
  answering_ = receiving_ = sending_ = empty_packet_due_ = accepting_ = false;
  for (const std::uint8_t endpoint : {kNotify, kData}) {
    stop(in(endpoint, otg_in::DIEPCTL));
    stop(out(endpoint, otg_out::DOEPCTL));
  }
  flush_fifos();
  core(otg::DAINTMSK) = otg::DAINTMSK_IEPM(1) | otg::DAINTMSK_OEPM(1);
  core(otg::DOEPMSK) = otg::DOEPMSK_XFRCM(1) | otg::DOEPMSK_STUPM(1);
  core(otg::DIEPMSK) = otg::DIEPMSK_XFRCM(1);
  modify(core(otg::DCFG), otg::DCFG_DAD, 0);
  accept_0();
}

void UsbPort::open_endpoints() {
  in(kNotify, otg_in::DIEPCTL) = otg_in::DIEPCTL_MPSIZ(parts::UsbCdc::kNotifyBytes) |
                                 otg_in::DIEPCTL_USBAEP(1) | otg_in::DIEPCTL_EPTYP(kInterrupt) |
                                 otg_in::DIEPCTL_TXFNUM(kNotify) |
                                 otg_in::DIEPCTL_SD0PID_SEVNFRM(1) | otg_in::DIEPCTL_SNAK(1);
  in(kData, otg_in::DIEPCTL) = otg_in::DIEPCTL_MPSIZ(kPacket) | otg_in::DIEPCTL_USBAEP(1) |
                               otg_in::DIEPCTL_EPTYP(kBulk) | otg_in::DIEPCTL_TXFNUM(kData) |
                               otg_in::DIEPCTL_SD0PID_SEVNFRM(1) | otg_in::DIEPCTL_SNAK(1);
  out(kData, otg_out::DOEPCTL) = otg_out::DOEPCTL_MPSIZ(kPacket) | otg_out::DOEPCTL_USBAEP(1) |
                                 otg_out::DOEPCTL_EPTYP(kBulk) |
                                 otg_out::DOEPCTL_SD0PID_SEVNFRM(1) | otg_out::DOEPCTL_SNAK(1);
  core(otg::DAINTMSK) = otg::DAINTMSK_IEPM(1u | 1u << kData) | otg::DAINTMSK_OEPM(1u | 1u << kData);
  accepting_ = sending_ = false;
  accept_data();
}

// ---- data

void UsbPort::send(const std::uint8_t* data, std::size_t size) {
  sending_ = true;
  empty_packet_due_ = size % kPacket == 0;
  start_in(kData, data, size);
}

std::size_t UsbPort::read(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, received_.size());
  received_.take(data, count);
  const std::uint32_t masked = mask_bus();
  if (cdc_.configured()) accept_data();
  unmask_bus(masked);
  return count;
}

/// The next packet, as soon as there is room for it; until then the host has to wait.
void UsbPort::accept_data() {
  if (accepting_ || received_.room() < kPacket) return;
  accepting_ = true;
  out(kData, otg_out::DOEPTSIZ) = otg_out::DOEPTSIZ_PKTCNT(1) | otg_out::DOEPTSIZ_XFRSIZ(kPacket);
  out(kData, otg_out::DOEPCTL) =
      out(kData, otg_out::DOEPCTL) | otg_out::DOEPCTL_CNAK(1) | otg_out::DOEPCTL_EPENA(1);
}

// ---- interrupt

void UsbPort::on_interrupt() {
  const std::uint32_t pending = core(otg::GINTSTS) & core(otg::GINTMSK);
  core(otg::GINTSTS) = pending & (otg::GINTSTS_USBRST(1) | otg::GINTSTS_ENUMDNE(1) |
                                  otg::GINTSTS_USBSUSP(1) | otg::GINTSTS_WKUINT(1));
  if (otg::GINTSTS_USBSUSP.of(pending) != 0) suspended_ = true;
  if (otg::GINTSTS_WKUINT.of(pending) != 0) suspended_ = false;
  if (otg::GINTSTS_USBRST.of(pending) != 0) bus_reset();
  if (otg::GINTSTS_ENUMDNE.of(pending) != 0) {
    suspended_ = false;
    modify(in(0, otg_in::DIEPCTL), otg_in::DIEPCTL_MPSIZ, 0);  // the code for 64 bytes
    core(otg::DCTL) = core(otg::DCTL) | otg::DCTL_CGINAK(1);
  }
  while (otg::GINTSTS_RXFLVL.of(core(otg::GINTSTS)) != 0) take_received();
  if (otg::GINTSTS_OEPINT.of(core(otg::GINTSTS)) != 0) on_out_endpoints();
  if (otg::GINTSTS_IEPINT.of(core(otg::GINTSTS)) != 0) on_in_endpoints();
  const std::uint32_t back = core(otg::GINTSTS);
  static_cast<void>(back);  // the writes have arrived: the interrupt does not come again
}

/// One entry of the receive FIFO.
void UsbPort::take_received() {
  const std::uint32_t entry = core(otg::GRXSTSP);
  const std::uint32_t status = otg::GRXSTSP_PKTSTS.of(entry);
  const std::size_t size = otg::GRXSTSP_BCNT.of(entry);
  if (status != kOutData && status != kSetupData) return;
  std::array<std::uint8_t, kPacket> packet{};
  for (std::size_t at = 0; at < size; at += 4) {
    const std::uint32_t word = fifo(0);
    for (std::size_t k = 0; k < 4 && at + k < packet.size(); ++k) {
      packet[at + k] = static_cast<std::uint8_t>(word >> (8u * k));
    }
  }
  const std::size_t count = std::min(size, packet.size());
  if (otg::GRXSTSP_EPNUM.of(entry) == kData) {
    received_.put(packet.data(), count);
  } else {
    control_ = packet;
    control_size_ = count;
  }
}

void UsbPort::on_out_endpoints() {
  const std::uint32_t which = otg::DAINT_OEPINT.of(core(otg::DAINT));
  if ((which & 1u) != 0) {
    const std::uint32_t events = out(0, otg_out::DOEPINT);
    out(0, otg_out::DOEPINT) = events;
    if (otg_out::DOEPINT_STUP.of(events) != 0) {
      on_setup();
    } else if (otg_out::DOEPINT_XFRC.of(events) != 0) {
      if (receiving_) {
        cdc_.received(control_.data(), control_size_);
        send_packet_0(nullptr, 0);
      }
      receiving_ = false;
      accept_0();
    }
  }
  if ((which >> kData & 1u) != 0) {
    out(kData, otg_out::DOEPINT) = out(kData, otg_out::DOEPINT);
    accepting_ = false;
    accept_data();
  }
}

void UsbPort::on_in_endpoints() {
  const std::uint32_t which = otg::DAINT_IEPINT.of(core(otg::DAINT));
  if ((which & 1u) != 0) {
    in(0, otg_in::DIEPINT) = in(0, otg_in::DIEPINT);
    if (answering_) continue_answer();
  }
  if ((which >> kData & 1u) != 0) {
    in(kData, otg_in::DIEPINT) = in(kData, otg_in::DIEPINT);
    if (empty_packet_due_) {
      empty_packet_due_ = false;
      start_in(kData, nullptr, 0);
    } else {
      sending_ = false;
    }
  }
}

// ---- endpoint 0

void UsbPort::on_setup() {
  using Kind = parts::UsbCdc::Answer::Kind;
  const parts::UsbSetup setup = parts::UsbSetup::from(control_.data());
  const bool was_configured = cdc_.configured();
  const parts::UsbCdc::Answer answer = cdc_.setup(setup);
  answering_ = answer.kind == Kind::kSend;
  receiving_ = answer.kind == Kind::kReceive;
  accept_0();
  if (answer.kind == Kind::kStall) return stall_0();
  modify(core(otg::DCFG), otg::DCFG_DAD, cdc_.address());  // before the status stage
  if (cdc_.configured() && !was_configured) open_endpoints();
  if (answering_) {
    answer_ = answer.data;
    answer_size_ = answer.size;
    continue_answer();
  } else if (!receiving_) {
    send_packet_0(nullptr, 0);
  }
}

/// The next packet of the answer. The last is shorter than 64 bytes, or the last that the host asked for:
/// no descriptor consists of whole packets.
void UsbPort::continue_answer() {
  if (answer_size_ == 0) {
    answering_ = false;
    return;
  }
  const std::size_t count = std::min(answer_size_, kPacket);
  send_packet_0(answer_, count);
  answer_ += count;
  answer_size_ -= count;
}

void UsbPort::send_packet_0(const std::uint8_t* data, std::size_t size) {
  start_in(0, data, size);
}

/// Set-up packets are always taken; this also takes data and the host's status packet.
void UsbPort::accept_0() {
  constexpr std::uint32_t kSetupPackets = 3;
  out(0, otg_out::DOEPTSIZ) = otg_out::DOEPTSIZ_STUPCNT(kSetupPackets) |
                              otg_out::DOEPTSIZ_PKTCNT(1) | otg_out::DOEPTSIZ_XFRSIZ(kPacket);
  out(0, otg_out::DOEPCTL) =
      out(0, otg_out::DOEPCTL) | otg_out::DOEPCTL_CNAK(1) | otg_out::DOEPCTL_EPENA(1);
}

/// The next set-up packet ends it.
void UsbPort::stall_0() {
  in(0, otg_in::DIEPCTL) = in(0, otg_in::DIEPCTL) | otg_in::DIEPCTL_STALL(1);
  out(0, otg_out::DOEPCTL) = out(0, otg_out::DOEPCTL) | otg_out::DOEPCTL_STALL(1);
}

}  // namespace rosflight::boards::stm32h7
