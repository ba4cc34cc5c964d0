// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "link/codec.hpp"

/// Feeds arbitrary bytes to a receiver. The first byte chooses how the stream is divided into calls
/// and whether its frames get valid checksums. The messages received must not depend on the
/// division, and must be the same after they have been encoded and received once more.
///
///     struct Traits {
///       static constexpr std::size_t kMinFrame;
///       static SomeCodec fcu();         // both ends of a link, newly constructed
///       static OtherCodec companion();
///       // `data` holds triples of message number, length and payload; returns them as frames.
///       static Bytes good_frames(const std::uint8_t* data, std::size_t size);
///     };
namespace rosflight::link::fuzz {

using Bytes = std::vector<std::uint8_t>;

inline void require(bool held) {
  if (!held) std::abort();
}

struct Outcome {
  Bytes frames;  ///< Every message received, encoded again.
  Codec::Counters counters;
};

/// Each call gets a heap block of exactly its size, so that reading past its end is seen.
template <class Traits>
Outcome receive(const Bytes& stream, std::size_t chunk) {
  auto receiver = Traits::companion();
  auto sender = Traits::fcu();
  Outcome outcome;
  std::uint32_t complete = 0;
  for (std::size_t at = 0; at < stream.size(); at += chunk) {
    const std::size_t size = std::min(chunk, stream.size() - at);
    const Bytes call(stream.begin() + static_cast<std::ptrdiff_t>(at),
                     stream.begin() + static_cast<std::ptrdiff_t>(at + size));
    for (std::size_t used = 0; used < size;) {
      const Codec::Decoded step = receiver.decode(call.data() + used, size - used);
      require(step.consumed <= size - used);
      require(step.complete || step.consumed == size - used);
      used += step.consumed;
      if (!step.complete) continue;
      require(++complete <= stream.size() / Traits::kMinFrame);
      Frame frame;
      require(sender.encode(receiver.message(), frame));
      require(frame.size <= kMaxFrameBytes);
      outcome.frames.insert(outcome.frames.end(), frame.bytes.begin(),
                            frame.bytes.begin() + static_cast<std::ptrdiff_t>(frame.size));
    }
  }
  outcome.counters = receiver.counters();
  require(outcome.counters.frames_received == complete);
  return outcome;
}

template <class Traits>
int run(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool repaired = data[0] >= 128;
  const std::size_t chunk = data[0] % 128u + 1u;
  const Bytes stream =
      repaired ? Traits::good_frames(data + 1, size - 1) : Bytes(data + 1, data + size);
  const Outcome whole = receive<Traits>(stream, stream.size());
  const Outcome cut = receive<Traits>(stream, chunk);
  require(cut.frames == whole.frames);
  require(cut.counters.frames_dropped == whole.counters.frames_dropped);
  require(cut.counters.sequence_gaps == whole.counters.sequence_gaps);
  const Outcome again = receive<Traits>(whole.frames, chunk);
  require(again.frames == whole.frames);
  require(again.counters.frames_dropped == 0);
  return 0;
}

}  // namespace rosflight::link::fuzz
