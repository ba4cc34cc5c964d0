// SPDX-License-Identifier: BSD-3-Clause
// MAVLink's receiver, see receive_fuzz.hpp.
#include "link/fuzz/receive_fuzz.hpp"

#include <array>

#include "link/mavlink/checksum.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight::link;
using fuzz::Bytes;

struct Known {
  std::uint8_t id;
  std::uint8_t crc_extra;
};
constexpr std::array<Known, 31> kKnown{
    {{0, 50},    {20, 214},  {21, 159},  {22, 220},  {23, 168},  {31, 246}, {65, 118},  {111, 34},
     {180, 90},  {181, 67},  {182, 218}, {183, 206}, {184, 169}, {187, 60}, {188, 249}, {189, 113},
     {190, 181}, {191, 12},  {192, 134}, {193, 1},   {195, 65},  {196, 10}, {197, 221}, {199, 48},
     {253, 83},  {236, 164}, {237, 114}, {238, 133}, {239, 2},   {228, 52}, {229, 44}}};

/// Reads `data` as pieces of message number, length, payload and makes a stream of good frames of
/// them, with the start byte of a false one in between where the message number is past the end of
/// the table.
Bytes make_good_frames(const std::uint8_t* data, std::size_t size) {
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

struct Mavlink {
  static constexpr std::size_t kMinFrame = 8;
  static MavlinkCodec fcu() { return MavlinkCodec({1, MavlinkCodec::kFcuComponent}); }
  static MavlinkCodec companion() { return MavlinkCodec({1, MavlinkCodec::kCompanionComponent}); }
  static Bytes good_frames(const std::uint8_t* data, std::size_t size) {
    return make_good_frames(data, size);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run<Mavlink>(data, size);
}
