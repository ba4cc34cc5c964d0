// SPDX-License-Identifier: BSD-3-Clause
// The far end for test_pymavlink_peer.py. Each line of standard input is a frame in hexadecimal;
// for each, one line with what the codec read (link/test/fields.hpp), " | " and the same message
// encoded again.
#include <iostream>
#include <string>

#include "link/mavlink/mavlink_codec.hpp"
#include "link/test/fields.hpp"
#include "link/test/frames.hpp"

int main() {
  using namespace rosflight::link;
  MavlinkCodec receiver({1, MavlinkCodec::kFcuComponent});
  MavlinkCodec sender({1, MavlinkCodec::kFcuComponent});
  std::string line;
  while (std::getline(std::cin, line)) {
    for (const Message& message : test::decoded(receiver, test::from_hex(line))) {
      std::cout << test::describe(message) << " | " << test::to_hex(test::encoded(sender, message))
                << '\n';
    }
  }
  return 0;
}
