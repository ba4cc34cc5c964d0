// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware/hal/time.hpp"

/// What a part driver asks of a chip: a port on a bus, a UART, a pin. A driver names no chip and no
/// board; it gets these and a clock (hal::Clock) in its constructor.
///
/// Contexts. The *bus context* is everything that moves a transfer on: interrupts of buses and edges,
/// and a periodic tick. A board runs all of it at one interrupt priority, so that no two functions of
/// a driver preempt one another there; a board without interrupts may call everything from one loop.
/// The *main loop* calls only what its comment assigns to it: poll(), state(), message(), and the
/// functions of hal roles.
namespace rosflight::boards::parts {

using hal::Time;

/// How a transfer ended.
enum class TransferResult : std::uint8_t {
  kDone,      ///< All bytes were sent and received.
  kNoAnswer,  ///< I2C: address or data not acknowledged. Never reported on SPI.
  kBusFault,  ///< Overrun, lost arbitration, DMA error, mode fault.
  kTimeout    ///< Not finished in time; the bus has been stopped and freed.
};

struct Transfer;

/// Is notified of the end of its transfers.
class TransferOwner {
 public:
  /// Bus context, after the chip select went high or the stop condition was sent. May start transfers,
  /// also `transfer` again. `in` of the transfer holds what was received only if kDone.
  /// @param end  when the transfer ended.
  virtual void transfer_done(Transfer& transfer, TransferResult result, Time end) = 0;

 protected:
  ~TransferOwner() = default;
};

/// Longest transfer, both directions together. A chip whose DMA cannot reach all memory, or whose
/// cache lies in between, copies through a buffer of this size of its own; drivers and their buffers may
/// lie anywhere.
inline constexpr std::size_t kMaxTransferBytes = 72;

/// One exchange with one part: first `out_count` bytes are sent, then `in_count` received, within one
/// selection (SPI: chip select low throughout; I2C: repeated start in between). What arrives while
/// sending is ignored, what is sent while receiving is 0; so the same transfer fits SPI with four wires,
/// with three wires, and I2C. Either count may be 0, not both.
///
/// Belongs to the driver. From start() to transfer_done() it and its buffers must stay and not change.
struct Transfer {
  const std::uint8_t* out{nullptr};
  std::size_t out_count{0};
  std::uint8_t* in{nullptr};
  std::size_t in_count{0};
  TransferOwner* owner{nullptr};
};

/// One part on its bus: a chip select with its mode and rate, or an I2C address.
class Port {
 public:
  /// Queues the transfer and returns at once; transfer_done() follows, never from within start().
  /// Transfers of one port keep their order and have the chip select high for 2 us or more in between.
  /// Bus context or main loop.
  /// @returns false, and does nothing, if the transfer is empty, too long, has no owner, or if the port
  /// has as many transfers queued as it can hold (two at least).
  virtual bool start(Transfer& transfer) = 0;

 protected:
  ~Port() = default;
};

/// What a part wants of its SPI; a constant of each driver, for the board to set up the port with.
struct SpiWish {
  std::uint8_t mode{3};     ///< 0 or 3.
  std::uint32_t max_hz{};   ///< Fastest clock.
  bool three_wires{false};  ///< Data in and out share a line.
};

/// Format of a UART; one start bit, eight data bits.
struct UartFormat {
  std::uint32_t baud{115200};
  bool even_parity{false};
  std::uint8_t stop_bits{1};
  bool inverted{false};  ///< Idle line is low.
};

/// Sends bytes, and can change its rate. The other direction is ByteReceiver.
class UartPort {
 public:
  /// Queues all bytes or none. Never waits. @returns false if they do not fit.
  virtual bool send(const std::uint8_t* data, std::size_t size) = 0;
  /// What was queued is sent in the old format or lost. @returns false if the rate cannot be had within
  /// 2 %; the old one then stays.
  virtual bool set_format(const UartFormat& format) = 0;
  /// Everything queued has left the wire.
  virtual bool idle() const = 0;

 protected:
  ~UartPort() = default;
};

/// Is given what a UART received.
class ByteReceiver {
 public:
  /// Bus context. Called at the latest when the line has been idle for one character.
  /// @param last  when the stop bit of the last byte ended; bytes are contiguous before it.
  virtual void receive(const std::uint8_t* data, std::size_t size, Time last) = 0;
  /// A byte was lost or damaged at this point of the stream: parity, framing, noise, overrun, break.
  virtual void line_error(Time when) = 0;

 protected:
  ~ByteReceiver() = default;
};

/// An output pin.
class OutputPin {
 public:
  virtual void set(bool high) = 0;

 protected:
  ~OutputPin() = default;
};

}  // namespace rosflight::boards::parts
