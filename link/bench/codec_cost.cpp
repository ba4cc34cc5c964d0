// SPDX-License-Identifier: BSD-3-Clause
// Encodes or decodes one message COUNT times, for counting instructions: the difference of two runs
// under `valgrind --tool=callgrind`, divided by the difference of their COUNTs, is the cost of one.
//
// usage: link_codec_cost (mavlink | lean) (encode | decode | decode_chunks) MESSAGE COUNT
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight::link;

const std::map<std::string, Message>& messages() {
  static const std::map<std::string, Message> kMessages{
      {"SMALL_IMU", Imu{1, {1.0f, 2.0f, 3.0f}, {4.0f, 5.0f, 6.0f}, 7.0f}},
      {"ATTITUDE_QUATERNION", Attitude{}},
      {"ROSFLIGHT_OUTPUT_RAW", OutputRaw{}},
      {"RC_CHANNELS", RcChannels{}},
      {"PARAM_VALUE", ParamValue{}},
      {"TIMESYNC", TimeSync{}},
      {"OFFBOARD_CONTROL", OffboardControl{}},
      {"HEARTBEAT", Heartbeat{}},
      {"STATUSTEXT", StatusText{}},
  };
  return kMessages;
}

int encode(Codec& codec, const Message& message, long count) {
  Frame frame;
  int sum = 0;
  for (long i = 0; i < count; ++i) {
    codec.encode(message, frame);
    sum += frame.bytes[frame.size - 1];
  }
  return sum;
}

/// Frames arrive in a stream, `chunk` bytes at a time (0: all at once).
int decode(Codec& sender, Codec& receiver, const Message& message, long count, std::size_t chunk) {
  constexpr long kFrames = 256;
  std::vector<std::uint8_t> stream;
  Frame frame;
  for (long i = 0; i < kFrames; ++i) {
    sender.encode(message, frame);
    stream.insert(stream.end(), frame.bytes.begin(),
                  frame.bytes.begin() + static_cast<std::ptrdiff_t>(frame.size));
  }
  if (chunk == 0) chunk = stream.size();
  int sum = 0;
  for (long i = 0; i < count / kFrames; ++i) {
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t end = std::min(stream.size(), at + chunk);
      while (at < end) {
        const Codec::Decoded step = receiver.decode(stream.data() + at, end - at);
        at += step.consumed;
        sum += step.complete ? 1 : 0;
      }
    }
  }
  return sum;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string protocol = argc == 5 ? argv[1] : "";
  if ((protocol != "mavlink" && protocol != "lean") || messages().count(argv[3]) == 0) {
    std::cerr
        << "usage: link_codec_cost (mavlink | lean) (encode | decode | decode_chunks) MESSAGE "
           "COUNT\n";
    return 2;
  }
  MavlinkCodec mavlink({1, MavlinkCodec::kFcuComponent});
  MavlinkCodec mavlink_companion({1, MavlinkCodec::kCompanionComponent});
  LeanCodec lean;
  LeanCodec lean_companion;
  const bool is_lean = protocol == "lean";
  Codec& sender = is_lean ? static_cast<Codec&>(lean) : mavlink;
  Codec& receiver = is_lean ? static_cast<Codec&>(lean_companion) : mavlink_companion;
  const std::string what = argv[2];
  const Message& message = messages().at(argv[3]);
  const long count = std::strtol(argv[4], nullptr, 10);
  std::cout << (what == "encode"
                    ? encode(sender, message, count)
                    : decode(sender, receiver, message, count, what == "decode" ? 0 : 17))
            << '\n';
  return 0;
}
