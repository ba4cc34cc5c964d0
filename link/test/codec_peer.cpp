// SPDX-License-Identifier: BSD-3-Clause
// The far end for test_pymavlink_peer.py and test_lean_document.py. Each line of standard input is
// a frame in hexadecimal; for each, one line with what the codec read (link/test/fields.hpp), " | "
// and the same message encoded again.
//
// usage: link_codec_peer (mavlink | lean)
#include <iostream>
#include <string>

#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "link/test/fields.hpp"
#include "link/test/frames.hpp"

namespace {

using namespace rosflight::link;

void answer(Codec& receiver, Codec& sender) {
  std::string line;
  while (std::getline(std::cin, line)) {
    for (const Message& message : test::decoded(receiver, test::from_hex(line))) {
      std::cout << test::describe(message) << " | " << test::to_hex(test::encoded(sender, message))
                << '\n';
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string protocol = argc == 2 ? argv[1] : "";
  if (protocol == "mavlink") {
    MavlinkCodec receiver({1, MavlinkCodec::kFcuComponent});
    MavlinkCodec sender({1, MavlinkCodec::kFcuComponent});
    answer(receiver, sender);
  } else if (protocol == "lean") {
    LeanCodec receiver;
    LeanCodec sender;
    answer(receiver, sender);
  } else {
    std::cerr << "usage: link_codec_peer (mavlink | lean)\n";
    return 2;
  }
  return 0;
}
