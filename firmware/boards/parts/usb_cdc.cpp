// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/usb_cdc.hpp"

#include <algorithm>

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kDeviceType = 1, kConfigurationType = 2, kStringType = 3;
constexpr std::uint8_t kInterface = 4, kEndpoint = 5, kOfClass = 0x24;
constexpr std::uint8_t kIn = 0x80;
constexpr std::uint8_t kBulk = 2, kInterrupt = 3;

constexpr std::uint8_t kDevice[] = {18,
                                    kDeviceType,
                                    0x00,
                                    0x02,  // USB 2.0
                                    0x02,
                                    0,
                                    0,  // communication device
                                    UsbCdc::kPacketBytes,
                                    0x09,
                                    0x12,  // pid.codes
                                    0x01,
                                    0x00,  // its number for tests
                                    0x00,
                                    0x02,  // release
                                    1,
                                    2,
                                    3,  // strings: maker, product, serial number
                                    1};

constexpr std::uint8_t kConfiguration[] = {9,
                                           kConfigurationType,
                                           67,
                                           0,
                                           2,
                                           1,
                                           0,
                                           0x80,
                                           250,  // two interfaces, 500 mA from the bus
                                           9,
                                           kInterface,
                                           0,
                                           0,
                                           1,
                                           0x02,
                                           0x02,
                                           0x00,
                                           0,  // control: abstract model, no protocol
                                           5,
                                           kOfClass,
                                           0x00,
                                           0x10,
                                           0x01,  // CDC 1.1
                                           5,
                                           kOfClass,
                                           0x01,
                                           0x00,
                                           1,  // calls are not managed
                                           4,
                                           kOfClass,
                                           0x02,
                                           0x02,  // line coding and line state
                                           5,
                                           kOfClass,
                                           0x06,
                                           0,
                                           1,  // union of both interfaces
                                           7,
                                           kEndpoint,
                                           kIn | UsbCdc::kNotify,
                                           kInterrupt,
                                           UsbCdc::kNotifyBytes,
                                           0,
                                           255,
                                           9,
                                           kInterface,
                                           1,
                                           0,
                                           2,
                                           0x0A,
                                           0,
                                           0,
                                           0,
                                           7,
                                           kEndpoint,
                                           UsbCdc::kData,
                                           kBulk,
                                           UsbCdc::kPacketBytes,
                                           0,
                                           0,
                                           7,
                                           kEndpoint,
                                           kIn | UsbCdc::kData,
                                           kBulk,
                                           UsbCdc::kPacketBytes,
                                           0,
                                           0};
static_assert(sizeof kConfiguration == 67);

constexpr std::uint8_t kLanguages[] = {4, kStringType, 0x09, 0x04};
constexpr std::uint8_t kMaker[] = {20,  kStringType, 'R', 0, 'O', 0, 'S', 0, 'f', 0,
                                   'l', 0,           'i', 0, 'g', 0, 'h', 0, 't', 0};
constexpr std::uint8_t kProduct[] = {20,  kStringType, 'A', 0, 'u', 0, 't', 0, 'o', 0,
                                     'p', 0,           'i', 0, 'l', 0, 'o', 0, 't', 0};
constexpr std::uint8_t kSerialNumber[] = {4, kStringType, '1', 0};

enum Request : std::uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kSetFeature = 3,
  kSetAddress = 5,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kSetConfiguration = 9,
  kGetInterface = 10,
  kSetInterface = 11,
  kSetLineCoding = 0x20,
  kGetLineCoding = 0x21,
  kSetLineState = 0x22,
  kSendBreak = 0x23
};

using Answer = UsbCdc::Answer;
using Kind = Answer::Kind;

/// Never more than the host asked for.
Answer send(const std::uint8_t* data, std::size_t size, const UsbSetup& setup) {
  return {Kind::kSend, data, std::min<std::size_t>(size, setup.length)};
}

Answer descriptor(const UsbSetup& setup) {
  const auto give = [&setup](const auto& bytes) { return send(bytes, sizeof bytes, setup); };
  switch (setup.value) {
    case kDeviceType << 8:
      return give(kDevice);
    case kConfigurationType << 8:
      return give(kConfiguration);
    case kStringType << 8:
      return give(kLanguages);
    case kStringType << 8 | 1:
      return give(kMaker);
    case kStringType << 8 | 2:
      return give(kProduct);
    case kStringType << 8 | 3:
      return give(kSerialNumber);
    default:
      return {};
  }
}

}  // namespace

UsbSetup UsbSetup::from(const std::uint8_t* bytes) {
  return {bytes[0], bytes[1], static_cast<std::uint16_t>(le16(bytes + 2)),
          static_cast<std::uint16_t>(le16(bytes + 4)), static_cast<std::uint16_t>(le16(bytes + 6))};
}

void UsbCdc::reset() {
  address_ = configuration_ = 0;
  terminal_ready_ = false;
}

Answer UsbCdc::setup(const UsbSetup& setup) {
  constexpr std::uint8_t kRecipient = 0x7F;  // and type; the rest is the direction
  switch (setup.type & kRecipient) {
    case 0x00:
      return standard(setup);
    case 0x01:
      if (setup.request == kSetInterface && setup.value == 0) return {Kind::kDone};
      status_ = {};
      if (setup.request == kGetInterface) return send(status_.data(), 1, setup);
      return setup.request == kGetStatus ? send(status_.data(), 2, setup) : Answer{};
    case 0x02:
      return for_endpoint(setup);
    case 0x21:
      return for_port(setup);
    default:
      return {};
  }
}

Answer UsbCdc::standard(const UsbSetup& setup) {
  status_ = {};
  switch (setup.request) {
    case kGetStatus:
      return send(status_.data(), 2, setup);
    case kSetAddress:
      address_ = setup.value & 0x7Fu;
      return {Kind::kDone};
    case kGetDescriptor:
      return descriptor(setup);
    case kGetConfiguration:
      return send(&configuration_, 1, setup);
    case kSetConfiguration:
      if (setup.value > 1) return {};
      configuration_ = static_cast<std::uint8_t>(setup.value);
      terminal_ready_ = false;
      return {Kind::kDone};
    default:
      return {};
  }
}

/// Endpoints are never halted, so there is nothing to clear.
Answer UsbCdc::for_endpoint(const UsbSetup& setup) {
  status_ = {};
  if (setup.request == kGetStatus) return send(status_.data(), 2, setup);
  return setup.request == kClearFeature ? Answer{Kind::kDone} : Answer{};
}

Answer UsbCdc::for_port(const UsbSetup& setup) {
  switch (setup.request) {
    case kSetLineCoding:
      return setup.length == line_coding_.size() ? Answer{Kind::kReceive} : Answer{};
    case kGetLineCoding:
      return send(line_coding_.data(), line_coding_.size(), setup);
    case kSetLineState:
      terminal_ready_ = (setup.value & 1u) != 0;
      return {Kind::kDone};
    case kSendBreak:
      return {Kind::kDone};
    default:
      return {};
  }
}

/// A line coding: there is no line, so it is kept for the host to read back.
void UsbCdc::received(const std::uint8_t* data, std::size_t size) {
  if (size == line_coding_.size()) std::copy_n(data, size, line_coding_.begin());
}

}  // namespace rosflight::boards::parts
