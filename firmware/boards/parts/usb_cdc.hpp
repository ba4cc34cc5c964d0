// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::boards::parts {

/// The eight bytes that begin a control transfer. USB 2.0, table 9-2.
struct UsbSetup {
  static constexpr std::size_t kBytes = 8;
  std::uint8_t type{}, request{};
  std::uint16_t value{}, index{}, length{};
  static UsbSetup from(const std::uint8_t* bytes);
};

/// The control side of a USB device with one virtual serial port (CDC, abstract control model): its
/// descriptors, and what each request changes. It knows no controller: that moves the packets.
///
/// Endpoints: 0 control; kNotify in (interrupt, nothing is ever sent); kData in and out (bulk, 64 bytes).
/// Identity: 0x1209/0x0001, the number of pid.codes for tests; a product needs one of its own.
/// Sources: USB 2.0 chapter 9; CDC 1.2 section 5; PSTN 1.2 sections 5.3 and 6.3.
class UsbCdc {
 public:
  static constexpr std::size_t kPacketBytes = 64, kNotifyBytes = 8;
  static constexpr std::uint8_t kNotify = 1, kData = 2;

  struct Answer {
    enum class Kind : std::uint8_t {
      kStall,    ///< The request is not supported.
      kSend,     ///< `size` bytes at `data` to the host.
      kReceive,  ///< The host sends bytes: give them to received().
      kDone      ///< No data.
    };
    Kind kind{Kind::kStall};
    const std::uint8_t* data{};
    std::size_t size{};
  };

  /// The host reset the bus.
  void reset();
  Answer setup(const UsbSetup& setup);
  void received(const std::uint8_t* data, std::size_t size);

  /// To be in force before the status stage of the request that sets it.
  std::uint8_t address() const { return address_; }
  bool configured() const { return configuration_ != 0; }
  /// A program on the host has the port open: it raised "data terminal ready".
  bool open() const { return configured() && terminal_ready_; }

 private:
  Answer standard(const UsbSetup& setup);
  Answer for_endpoint(const UsbSetup& setup);
  Answer for_port(const UsbSetup& setup);

  std::uint8_t address_{0}, configuration_{0};
  bool terminal_ready_{false};
  std::array<std::uint8_t, 7> line_coding_{0x00, 0xC2, 0x01, 0x00,
                                           0,    0,    8};  ///< 115 200 baud, 8N1.
  std::array<std::uint8_t, 2> status_{};
};

}  // namespace rosflight::boards::parts
