// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

namespace rosflight::companion {

/// How urgent a frame is; the values of the firmware's serial role.
inline constexpr std::uint8_t kUrgent = 0;      ///< Offboard commands.
inline constexpr std::uint8_t kTimely = 1;      ///< Time synchronisation.
inline constexpr std::uint8_t kOrdinary = 255;  ///< All else.

/// One end of a byte link. No call blocks or throws; a transport that fails reconnects by itself and
/// reports its state by connected(). Implementations: in_process.hpp, asio/ (serial, pty, UDP, TCP), or
/// the caller's own.
class Transport {
 public:
  virtual ~Transport() = default;

  /// The link is open and bytes can be sent; whether a peer receives them is not known.
  virtual bool connected() = 0;

  /// Copies up to `capacity` received bytes. @returns the number copied, 0 if none was received.
  virtual std::size_t read(std::uint8_t* data, std::size_t capacity) = 0;

  /// Queues a whole frame or drops it whole. @returns false if it was dropped (closed or full).
  virtual bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) = 0;
};

}  // namespace rosflight::companion
