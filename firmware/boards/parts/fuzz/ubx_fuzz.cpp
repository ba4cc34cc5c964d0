// SPDX-License-Identifier: BSD-3-Clause
// Any bytes from a u-blox receiver. The first byte says how they are divided into calls and whether
// pieces (message number, length, payload) are made frames. Samples are well formed, do not depend on
// the division, and a good solution after a pause is received.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "firmware/boards/parts/ublox.hpp"

namespace {

using namespace rosflight::boards::parts;
using rosflight::hal::GnssSample;
using rosflight::hal::milliseconds;
using Bytes = std::vector<std::uint8_t>;

void require(bool held) {
  if (!held) std::abort();
}

/// Acknowledges what it is sent.
struct Port final : UartPort {
  bool send(const std::uint8_t* data, std::size_t /*size*/) override {
    acknowledged = data[3];
    return true;
  }
  bool set_format(const UartFormat& /*format*/) override { return true; }
  bool idle() const override { return true; }
  std::uint8_t acknowledged{0};
};

Bytes frame(std::uint8_t message_class, std::uint8_t id, const Bytes& payload) {
  Bytes bytes(payload.size() + UbxFormat::kAround);
  UbxFormat::wrap(message_class, id, payload.data(), payload.size(), bytes.data());
  return bytes;
}

Bytes good_frames(const std::uint8_t* data, std::size_t size) {
  Bytes stream;
  for (std::size_t at = 0; at + 2 <= size;) {
    const std::uint8_t number = data[at];
    const std::size_t length = std::min<std::size_t>(data[at + 1], size - at - 2);
    Bytes payload(data + at + 2, data + at + 2 + length);
    at += 2 + length;
    if (number < 128) payload.resize(NavPvt::kBytes);
    const Bytes made = frame(number < 128 ? 0x01 : number, 0x07, payload);
    stream.insert(stream.end(), made.begin(), made.end());
  }
  return stream;
}

std::vector<GnssSample> receive(const Bytes& stream, std::size_t chunk) {
  Port port;
  Ublox driver{port, {}};
  std::vector<GnssSample> samples;
  rosflight::hal::Time now = milliseconds(1);
  const auto give = [&](const Bytes& bytes) {
    driver.receive(bytes.data(), bytes.size(), now);
    GnssSample sample;
    while (driver.poll(sample)) samples.push_back(sample);
  };
  driver.start(Start::kWarm, now);
  for (int k = 0; k < 40 && driver.state() != PartState::kRunning; ++k, now += milliseconds(1)) {
    give(frame(0x05, 0x01, {0x06, port.acknowledged}));
    driver.step(now);
  }
  require(driver.state() == PartState::kRunning);
  for (std::size_t at = 0; at < stream.size(); at += chunk) {
    const std::size_t size = std::min(chunk, stream.size() - at);
    give(Bytes(stream.begin() + static_cast<std::ptrdiff_t>(at),
               stream.begin() + static_cast<std::ptrdiff_t>(at + size)));
  }
  for (const GnssSample& sample : samples) {
    require(sample.fix <= rosflight::hal::GnssFix::kTimeOnly);
    require(sample.unix_ns >= 0 && sample.unix_ns < 1'000'000'000);
    require(std::abs(sample.latitude_deg) <= 90.0 && std::abs(sample.longitude_deg) <= 180.0);
  }
  const std::size_t before = samples.size();
  give(Bytes(UbxFormat::kMaxLength, 0));  // longer than what may still be missing of a frame
  require(samples.size() <= before + 1);
  const std::size_t then = samples.size();
  give(frame(0x01, 0x07, Bytes(NavPvt::kBytes)));
  require(samples.size() == then + 1);
  return samples;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes stream =
      data[0] >= 128 ? good_frames(data + 1, size - 1) : Bytes(data + 1, data + size);
  // Less than a solution per call, so that the main loop takes all.
  const std::vector<GnssSample> one = receive(stream, 80);
  const std::vector<GnssSample> cut = receive(stream, data[0] % 64u + 1u);
  require(one.size() == cut.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    require(one[k].unix_s == cut[k].unix_s && one[k].fix == cut[k].fix);
  }
  return 0;
}
