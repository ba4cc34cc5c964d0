// SPDX-License-Identifier: BSD-3-Clause
// The far end for test_representations.py. Each line of standard input is a MAVLink frame in
// hexadecimal; for each, one line of fields between tabs: for each ROS message made of it the type
// and the CDR in hexadecimal; for what ROS sends to the FCU, then "frame" and the frame made of it
// again. At the end for each type its name, the lines of its schema, and the schema.
#include <algorithm>
#include <iostream>
#include <map>
#include <string>

#include "link/mavlink/mavlink_codec.hpp"
#include "link/test/frames.hpp"
#include "messages/link.hpp"

namespace {

using namespace rosflight;
using messages::to_message;

struct Peer {
  std::map<std::string_view, std::string_view> schemas{};
  messages::CdrWriter cdr{};
  link::Attitude attitude{};

  template <class Message>
  void put(const Message& message) {
    schemas[Message::kName] = Message::schema();
    cdr.begin();
    serialize(cdr, message);
    std::cout << Message::kName << '\t'
              << link::test::to_hex({cdr.bytes().begin(), cdr.bytes().end()}) << '\t';
  }

  void operator()(const std::monostate& /*none*/) {}
  void operator()(const link::RecordRequest& /*no ROS message*/) {}
  void operator()(const link::RecordPart& /*no ROS message*/) {}
  void operator()(const link::Imu& m) {
    put(to_message(m));
    put(to_message(m, attitude));
    put(messages::imu_temperature(m));
  }
  void operator()(const link::Attitude& m) {
    attitude = m;
    put(to_message(m));
    put(messages::euler_message(m));
  }
  void operator()(const link::StatusText& m) {
    put(to_message(m.severity, "fcu", {m.text.data(), m.text.size()}));
  }
  template <class M>
  void operator()(const M& m) {
    const auto message = to_message(m);
    put(message);
    if constexpr (requires { messages::to_link(message); } && !std::is_same_v<M, link::Attitude>) {
      link::MavlinkCodec sender({1, link::MavlinkCodec::kFcuComponent});
      const auto frame = link::test::encoded(sender, messages::to_link(message));
      std::cout << "frame\t" << link::test::to_hex(frame);
    }
  }
};

}  // namespace

int main() {
  Peer peer;
  link::MavlinkCodec receiver({1, link::MavlinkCodec::kFcuComponent});
  std::string line;
  while (std::getline(std::cin, line)) {
    for (const link::Message& message : link::test::decoded(receiver, link::test::from_hex(line)))
      std::visit(peer, message);
    std::cout << '\n';
  }
  for (const auto& [name, text] : peer.schemas)
    std::cout << name << ' ' << std::count(text.begin(), text.end(), '\n') << '\n' << text;
  return 0;
}
