// SPDX-License-Identifier: BSD-3-Clause
// Hostile bytes for the receiver. The first byte says how the stream is cut into calls and whether
// the frames in it get right checksums; what comes out must not depend on the cut, and must be the
// same after another round.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "link/mavlink/checksum.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight::link;
using Bytes = std::vector<std::uint8_t>;

void require(bool held) {
  if (!held) std::abort();
}

struct Known {
  std::uint8_t id;
  std::uint8_t crc_extra;
};
constexpr std::array<Known, 25> kKnown{{{0, 50},    {20, 214},  {21, 159},  {22, 220},  {23, 168},
                                        {31, 246},  {65, 118},  {111, 34},  {180, 90},  {181, 67},
                                        {182, 218}, {183, 206}, {184, 169}, {187, 60},  {188, 249},
                                        {189, 113}, {190, 181}, {191, 12},  {192, 134}, {193, 1},
                                        {195, 65},  {196, 10},  {197, 221}, {199, 48},  {253, 83}}};

/// Reads `data` as pieces of message number, length, payload and makes a stream of good frames of
/// them, with the start byte of a false one in between where the message number is past the end of
/// the table.
Bytes good_frames(const std::uint8_t* data, std::size_t size) {
  Bytes stream;
  std::uint8_t sequence = 0;
  for (std::size_t at = 0; at + 2 <= size;) {
    const std::size_t number = data[at] % (kKnown.size() + 2);
    const std::size_t length = std::min<std::size_t>(data[at + 1], size - at - 2);
    const std::uint8_t* const payload = data + at + 2;
    at += 2 + length;
    const std::size_t start = stream.size();
    if (number >= kKnown.size()) {
      stream.push_back(0xFE);
      stream.insert(stream.end(), payload, payload + length);
      continue;
    }
    const Known known = kKnown[number];
    stream.insert(stream.end(),
                  {0xFE, static_cast<std::uint8_t>(length), sequence++, 1, 250, known.id});
    stream.insert(stream.end(), payload, payload + length);
    const std::uint16_t crc =
        mavlink::checksum_by_bytes(stream.data() + start + 1, length + 5, known.crc_extra);
    stream.push_back(static_cast<std::uint8_t>(crc & 0xFF));
    stream.push_back(static_cast<std::uint8_t>(crc >> 8));
  }
  return stream;
}

struct Outcome {
  Bytes frames;  ///< Every message received, encoded again.
  Codec::Counters counters;
};

/// Each call gets a heap block of exactly its size, so that reading past its end is seen.
Outcome receive(const Bytes& stream, std::size_t chunk) {
  MavlinkCodec receiver({1, MavlinkCodec::kCompanionComponent});
  MavlinkCodec sender({1, MavlinkCodec::kFcuComponent});
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
      require(++complete <= stream.size() / 8);
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool repaired = data[0] >= 128;
  const std::size_t chunk = data[0] % 128u + 1u;
  const Bytes stream = repaired ? good_frames(data + 1, size - 1) : Bytes(data + 1, data + size);
  const Outcome whole = receive(stream, stream.size());
  const Outcome cut = receive(stream, chunk);
  require(cut.frames == whole.frames);
  require(cut.counters.frames_dropped == whole.counters.frames_dropped);
  require(cut.counters.sequence_gaps == whole.counters.sequence_gaps);
  const Outcome again = receive(whole.frames, chunk);
  require(again.frames == whole.frames);
  require(again.counters.frames_dropped == 0);
  return 0;
}
