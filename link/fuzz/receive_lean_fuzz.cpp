// SPDX-License-Identifier: BSD-3-Clause
// The lean receiver, see receive_fuzz.hpp.
#include "link/fuzz/receive_fuzz.hpp"

#include "link/lean/wire_table.hpp"

namespace {

using namespace rosflight::link;
using fuzz::Bytes;

/// A frame around `content` (id, sequence, payload) with a right checksum, stuffed.
void frame_up(Bytes content, Bytes& stream) {
  unsigned crc = lean::checksum(content.data(), content.size());
  if (content[0] != lean::kGreetingId) crc ^= lean::seed_of(lean::kSchema);
  content.insert(content.begin(), 0);
  content.push_back(static_cast<std::uint8_t>(crc & 0xFFu));
  content.push_back(static_cast<std::uint8_t>(crc >> 8 & 0xFFu));
  lean::stuff(content.data(), content.size());
  stream.push_back(lean::kStart);
  stream.insert(stream.end(), content.begin(), content.end());
}

struct Lean {
  static constexpr std::size_t kMinFrame = lean::kOverheadBytes + 1;
  static LeanCodec fcu() { return LeanCodec(); }
  static LeanCodec companion() { return LeanCodec(); }
  /// Payloads that are too short are filled with zeros; past the table, the raw bytes behind an FF
  /// come in between. A greeting gets the right schema where its first byte is even.
  static Bytes good_frames(const std::uint8_t* data, std::size_t size) {
    Bytes stream;
    std::uint8_t sequence = 0;
    for (std::size_t at = 0; at + 2 <= size;) {
      const std::size_t id = data[at] % (lean::kRows.size() + 2);
      const std::size_t length = std::min<std::size_t>(data[at + 1], size - at - 2);
      Bytes payload(data + at + 2, data + at + 2 + length);
      at += 2 + length;
      if (!lean::is_known(id)) {
        stream.push_back(lean::kStart);
        stream.insert(stream.end(), payload.begin(), payload.end());
        continue;
      }
      payload.resize(lean::kRows[id].length);
      if (id == lean::kGreetingId && payload[0] % 2 == 0) {
        lean::pack(lean::Greeting{VehicleType{payload[0]}, lean::kSchema}, payload.data());
      }
      Bytes content{static_cast<std::uint8_t>(id), sequence++};
      content.insert(content.end(), payload.begin(), payload.end());
      frame_up(content, stream);
    }
    return stream;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run<Lean>(data, size);
}
