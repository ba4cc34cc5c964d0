// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "link/messages.hpp"

namespace rosflight::link {

inline constexpr std::size_t kMaxFrameBytes = 263;

/// One encoded frame, ready for a serial port.
struct Frame {
  std::size_t size{0};
  std::array<std::uint8_t, kMaxFrameBytes> bytes;  // NOLINT: only bytes below `size` mean anything
};

/// Turns messages into frames and bytes into messages. A codec is one end of one link: it holds its
/// own identity, sequence number and parser state and nothing else, so any number live in one
/// process.
///
/// Received bytes may be anything: noise, truncated and foreign frames are rejected and counted,
/// never reported as a message. No heap, no exceptions; both ends use the same implementation.
class Codec {
 public:
  struct Counters {
    std::uint32_t frames_sent{};
    std::uint32_t frames_received{};  ///< Complete, checksum right, known id.
    std::uint32_t frames_dropped{};   ///< Bad checksum, unknown id or a start byte without a frame.
    std::uint32_t sequence_gaps{};    ///< Frames of the peer that were not received, by sequence
                                      ///< number; one that arrives late is subtracted again.
  };

  /// The schemas of two ends that were built from different messages.
  struct SchemaMismatch {
    std::uint32_t ours{};
    std::uint32_t theirs{};
  };

  struct Decoded {
    std::size_t consumed{};  ///< Number of bytes consumed; <= size.
    bool complete{};         ///< message() is new.
  };

  /// Encodes `message` into `frame`. @returns false (and size 0) for std::monostate only.
  virtual bool encode(const Message& message, Frame& frame) = 0;

  /// Consumes bytes up to the end of the first complete message, or all of them. Call it again with
  /// the rest.
  virtual Decoded decode(const std::uint8_t* data, std::size_t size) = 0;

  /// The last decoded message; valid until the next decode().
  virtual const Message& message() const = 0;

  /// Sets the system id of this end's frames; a companion's target system is a field of its messages.
  virtual void set_system_id(std::uint8_t id) = 0;

  virtual const Counters& counters() const = 0;

  /// Not nullptr while the peer has announced layouts that differ from ours; none of its frames is then
  /// reported as a message. Always nullptr for a codec whose layouts cannot differ.
  virtual const SchemaMismatch* mismatch() const { return nullptr; }

 protected:
  ~Codec() = default;
};

}  // namespace rosflight::link
