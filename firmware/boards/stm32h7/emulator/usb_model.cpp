// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/usb_model.hpp"

#include <algorithm>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kFifos = 0x1000U, kWords = 1024;
constexpr std::uint32_t kOutData = 2, kOutDone = 3, kSetupDone = 4, kSetupData = 6;
constexpr std::uint64_t kUsb_Hz = 48'000'000;
constexpr std::size_t kWordBytes = 4;

}  // namespace

void UsbModel::reset() {
  Peripheral::reset();
  word(otg::DCTL) = otg::DCTL_SDIS.mask();
  word(otg::GRSTCTL) = otg::GRSTCTL_AHBIDL.mask();
  attached_ = false;
  received_.clear();
  reading_.clear();
  for (auto& fifo : to_host_) fifo.clear();
}

// ---- registers

std::uint32_t UsbModel::bus_read(std::uint32_t offset, unsigned size) {
  return offset >= kFifos ? pop_word() : Peripheral::bus_read(offset, size);
}

void UsbModel::bus_write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  if (offset < kFifos) return Peripheral::bus_write(offset, value, size);
  push_word(offset / kFifos - 1, value);
}

std::uint32_t UsbModel::read(std::uint32_t offset, unsigned /*size*/) {
  switch (offset) {
    case otg::GINTSTS:
      return interrupts();
    case otg::GRXSTSP:
      return pop_status();
    case otg::DAINT:
      return endpoint_interrupts();
    default:
      break;
  }
  for (std::size_t k = 0; k < kEndpoints; ++k) {
    if (offset != in_at(k, otg_in::DTXFSTS)) continue;
    return depth(k) - static_cast<std::uint32_t>(to_host_[k].size() / kWordBytes);
  }
  return word(offset);
}

void UsbModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  const bool endpoint = offset >= in_at(0, 0) && offset < out_at(kEndpoints, 0);
  const bool events = offset == otg::GINTSTS || (endpoint && (offset & 0x1FU) == otg_in::DIEPINT);
  if (events) {
    word(offset) &= ~value;  // written 1 clears
  } else if (offset == otg::GRSTCTL) {
    if (otg::GRSTCTL_RXFFLSH.of(value) != 0) received_.clear();
    if (otg::GRSTCTL_TXFFLSH.of(value) != 0) {
      for (auto& fifo : to_host_) fifo.clear();
    }
    if (otg::GRSTCTL_CSRST.of(value) != 0 && otg::GUSBCFG_PHYSEL.of(word(otg::GUSBCFG)) == 0)
      complain("GRSTCTL: core reset before the transceiver is chosen");
  } else if (offset == otg::DCTL) {
    write_device_control(value);
  } else if (endpoint && (offset & 0x1FU) == 0) {
    write_control(offset, value);
  } else {
    word(offset) = value;
  }
  drive_line();
}

void UsbModel::write_device_control(std::uint32_t value) {
  word(otg::DCTL) = value & otg::DCTL_SDIS.mask();
  const bool attach = otg::DCTL_SDIS.of(value) == 0;
  if (attach && !attached_) check_start();
  attached_ = attach;
}

void UsbModel::check_start() {
  const std::uint32_t mode = word(otg::GUSBCFG);
  constexpr std::uint32_t kFullSpeed = 3, kTurnaround = 6;
  if (clocks_.usb_Hz() != kUsb_Hz) complain("attached without a clock of 48 MHz");
  if (!power_.usb_supplied()) complain("attached without the supply of its transceiver");
  const bool set_up = otg::GUSBCFG_FDMOD.of(mode) != 0 && otg::GUSBCFG_PHYSEL.of(mode) != 0 &&
                      otg::GUSBCFG_TRDT.of(mode) >= kTurnaround &&
                      otg::DCFG_DSPD.of(word(otg::DCFG)) == kFullSpeed &&
                      otg::GCCFG_PWRDWN.of(word(otg::GCCFG)) != 0;
  if (!set_up) complain("attached, but not set up as a full-speed device");
  std::uint32_t end = word(otg::GRXFSIZ);
  for (std::size_t k = 0; k < kEndpoints; ++k) {
    const std::uint32_t place =
        word(k == 0 ? otg::DIEPTXF0 : otg::DIEPTXF1 + 4 * static_cast<std::uint32_t>(k - 1));
    if (otg::DIEPTXF0_TX0FSA.of(place) < end) complain("its FIFOs overlap");
    end = otg::DIEPTXF0_TX0FSA.of(place) + depth(k);
  }
  if (end > kWords) complain("its FIFOs are larger than the memory");
  if (on_attach) on_attach();
}

std::uint32_t UsbModel::depth(std::size_t endpoint) const {
  const std::uint32_t offset =
      endpoint == 0 ? otg::DIEPTXF0 : otg::DIEPTXF1 + 4 * static_cast<std::uint32_t>(endpoint - 1);
  return otg::DIEPTXF0_TX0FD.of(word(offset));
}

/// The bits mean the same for both directions.
void UsbModel::write_control(std::uint32_t offset, std::uint32_t value) {
  std::uint32_t& control = word(offset);
  const bool is_out = offset >= out_at(0, 0);
  const std::size_t endpoint = (offset & 0xFFU) / 0x20U;
  const std::uint32_t enable = otg_in::DIEPCTL_EPENA.mask(), nak = otg_in::DIEPCTL_NAKSTS.mask();
  const bool enables = (value & enable) != 0;
  if (enables && (control & enable) != 0 && (!is_out || endpoint != 0)) {
    complain("endpoint " + std::to_string(endpoint) + " is enabled while a transfer runs");
  }
  const std::uint32_t kept = (control & (enable | nak)) | (enables ? enable : 0U);
  control = kept | (value & (otg_in::DIEPCTL_MPSIZ.mask() | otg_in::DIEPCTL_USBAEP.mask() |
                             otg_in::DIEPCTL_EPTYP.mask() | otg_in::DIEPCTL_STALL.mask() |
                             otg_in::DIEPCTL_TXFNUM.mask()));
  if (is_out) control &= ~otg_in::DIEPCTL_TXFNUM.mask();
  if (otg_in::DIEPCTL_EPDIS.of(value) != 0) control &= ~enable;
  if (otg_in::DIEPCTL_CNAK.of(value) != 0) control &= ~nak;
  if (otg_in::DIEPCTL_SNAK.of(value) != 0) control |= nak;
}

// ---- FIFOs

std::uint32_t UsbModel::pop_status() {
  if (received_.empty()) {
    complain("GRXSTSP: read while empty");
    return 0;
  }
  if (!reading_.empty()) complain("GRXSTSP: read before the bytes of the packet before");
  const Received entry = received_.front();
  received_.pop_front();
  reading_.assign(entry.bytes.begin(), entry.bytes.end());
  if (entry.status == kOutDone || entry.status == kSetupDone) {
    std::uint32_t& control = word(out_at(entry.endpoint, otg_out::DOEPCTL));
    control &= ~otg_out::DOEPCTL_EPENA.mask();
    control |= otg_out::DOEPCTL_NAKSTS.mask();
    const Field& event = entry.status == kOutDone ? otg_out::DOEPINT_XFRC : otg_out::DOEPINT_STUP;
    word(out_at(entry.endpoint, otg_out::DOEPINT)) |= event.mask();
  }
  drive_line();
  return otg::GRXSTSP_EPNUM(entry.endpoint) |
         otg::GRXSTSP_BCNT(static_cast<std::uint32_t>(entry.bytes.size())) |
         otg::GRXSTSP_PKTSTS(entry.status);
}

std::uint32_t UsbModel::pop_word() {
  if (reading_.empty()) complain("FIFO: read while empty");
  std::uint32_t value = 0;
  for (unsigned k = 0; k < kWordBytes && !reading_.empty(); ++k) {
    value |= std::uint32_t{reading_.front()} << (8 * k);
    reading_.pop_front();
  }
  return value;
}

void UsbModel::push_word(std::size_t endpoint, std::uint32_t value) {
  if (endpoint >= kEndpoints) return complain("FIFO: of an endpoint that is not there");
  auto& fifo = to_host_[endpoint];
  if (fifo.size() / kWordBytes >= depth(endpoint))
    return complain("FIFO: written beyond its depth");
  if (otg_in::DIEPCTL_EPENA.of(word(in_at(endpoint, otg_in::DIEPCTL))) == 0)
    complain("FIFO: written before its endpoint is enabled");
  for (unsigned k = 0; k < kWordBytes; ++k)
    fifo.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

// ---- interrupts

std::uint32_t UsbModel::endpoint_interrupts() const {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < kEndpoints; ++k) {
    const bool in = (word(in_at(k, otg_in::DIEPINT)) & word(otg::DIEPMSK)) != 0;
    const bool out = (word(out_at(k, otg_out::DOEPINT)) & word(otg::DOEPMSK)) != 0;
    value |= std::uint32_t{in} << k | std::uint32_t{out} << (16 + k);
  }
  return value;
}

std::uint32_t UsbModel::interrupts() const {
  const std::uint32_t endpoints = endpoint_interrupts() & word(otg::DAINTMSK);
  return word(otg::GINTSTS) | otg::GINTSTS_RXFLVL(!received_.empty()) |
         otg::GINTSTS_IEPINT(otg::DAINT_IEPINT.of(endpoints) != 0) |
         otg::GINTSTS_OEPINT(otg::DAINT_OEPINT.of(endpoints) != 0);
}

void UsbModel::raise(const Field& event) {
  word(otg::GINTSTS) |= event.mask();
  drive_line();
}

void UsbModel::drive_line() {
  const bool enabled = otg::GAHBCFG_GINT.of(word(otg::GAHBCFG)) != 0;
  core().set_line(irq::OTG_FS, enabled && (interrupts() & word(otg::GINTMSK)) != 0);
}

// ---- the host's side

void UsbModel::reset_bus() {
  raise(otg::GINTSTS_USBRST);
}
void UsbModel::enumerated() {
  raise(otg::GINTSTS_ENUMDNE);
}
void UsbModel::suspend() {
  raise(otg::GINTSTS_USBSUSP);
}

void UsbModel::send_setup(const std::array<std::uint8_t, 8>& setup) {
  for (std::uint32_t* control :
       {&word(in_at(0, otg_in::DIEPCTL)), &word(out_at(0, otg_out::DOEPCTL))}) {
    *control &= ~otg_in::DIEPCTL_STALL.mask();
  }
  if (otg_out::DOEPTSIZ_STUPCNT.of(word(out_at(0, otg_out::DOEPTSIZ))) == 0)
    complain("endpoint 0 takes no set-up packets");
  received_.push_back({0, kSetupData, Packet(setup.begin(), setup.end())});
  received_.push_back({0, kSetupDone, {}});
  drive_line();
}

UsbModel::Result UsbModel::send(std::size_t endpoint, const Packet& packet) {
  const std::uint32_t control = word(out_at(endpoint, otg_out::DOEPCTL));
  if (otg_out::DOEPCTL_STALL.of(control) != 0) return Result::kStall;
  std::uint32_t& sizes = word(out_at(endpoint, otg_out::DOEPTSIZ));
  const std::uint32_t packets = otg_out::DOEPTSIZ_PKTCNT.of(sizes);
  const bool takes = otg_out::DOEPCTL_EPENA.of(control) != 0 &&
                     otg_out::DOEPCTL_NAKSTS.of(control) == 0 && packets > 0;
  if (!takes) return Result::kNak;
  sizes = (sizes & ~otg_out::DOEPTSIZ_PKTCNT.mask()) | otg_out::DOEPTSIZ_PKTCNT(packets - 1);
  const auto number = static_cast<std::uint32_t>(endpoint);
  received_.push_back({number, kOutData, packet});
  received_.push_back({number, kOutDone, {}});
  word(out_at(endpoint, otg_out::DOEPCTL)) |= otg_out::DOEPCTL_NAKSTS.mask();
  drive_line();
  return Result::kDone;
}

UsbModel::Result UsbModel::receive(std::size_t endpoint, Packet& packet) {
  constexpr std::size_t kMaxPacket = 64;
  std::uint32_t& control = word(in_at(endpoint, otg_in::DIEPCTL));
  if (otg_in::DIEPCTL_STALL.of(control) != 0) return Result::kStall;
  std::uint32_t& sizes = word(in_at(endpoint, otg_in::DIEPTSIZ));
  const std::size_t count = std::min<std::size_t>(otg_in::DIEPTSIZ_XFRSIZ.of(sizes), kMaxPacket);
  const std::size_t stored = (count + kWordBytes - 1) / kWordBytes * kWordBytes;
  auto& fifo = to_host_[endpoint];
  const bool gives = otg_in::DIEPCTL_EPENA.of(control) != 0 &&
                     otg_in::DIEPCTL_NAKSTS.of(control) == 0 && fifo.size() >= stored;
  if (!gives) return Result::kNak;
  packet.assign(fifo.begin(), fifo.begin() + static_cast<std::ptrdiff_t>(count));
  fifo.erase(fifo.begin(), fifo.begin() + static_cast<std::ptrdiff_t>(stored));
  const std::uint32_t packets = otg_in::DIEPTSIZ_PKTCNT.of(sizes);
  if (packets == 0) complain("a transfer of no packets");
  const std::uint32_t left = packets > 0 ? packets - 1 : 0;
  sizes =
      otg_in::DIEPTSIZ_PKTCNT(left) | otg_in::DIEPTSIZ_XFRSIZ(otg_in::DIEPTSIZ_XFRSIZ.of(sizes) -
                                                              static_cast<std::uint32_t>(count));
  if (left == 0) {
    control &= ~otg_in::DIEPCTL_EPENA.mask();
    word(in_at(endpoint, otg_in::DIEPINT)) |= otg_in::DIEPINT_XFRC.mask();
  }
  drive_line();
  return Result::kDone;
}

}  // namespace rosflight::boards::stm32h7::emulator
