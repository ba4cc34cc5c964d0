// SPDX-License-Identifier: BSD-3-Clause
// Any bytes from a u-blox receiver. The first byte says how they are divided into calls, whether pieces
// (message number, length, payload) are made frames, and whether what follows them is judged. Samples are well formed,
// do not depend on the division, and a good solution is received once a frame that was cut can be no longer.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "firmware/boards/parts/fuzz/exact_block.hpp"
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

/// A driver that has set up its receiver.
class Running {
 public:
  Running() {
    driver_.start(Start::kWarm, now_);
    for (int k = 0; k < 40 && driver_.state() != PartState::kRunning; ++k) {
      give(frame(0x05, 0x01, {0x06, port_.acknowledged}), kWhole);
      driver_.step(now_);
      now_ += milliseconds(1);
    }
    require(driver_.state() == PartState::kRunning);
  }

  static constexpr std::size_t kWhole = fuzz::ExactBlock::kMost;
  /// @param chunk  bytes in a call.
  void give(const Bytes& bytes, std::size_t chunk) {
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      const std::size_t size = std::min(chunk, bytes.size() - at);
      driver_.receive(block_.holding(bytes.data() + at, size), size, now_);
      GnssSample sample;
      while (driver_.poll(sample)) samples_.push_back(sample);
    }
  }
  const std::vector<GnssSample>& samples() const { return samples_; }

 private:
  fuzz::ExactBlock block_;
  Port port_;
  Ublox driver_{port_, {}};
  std::vector<GnssSample> samples_;
  rosflight::hal::Time now_ = milliseconds(1);
};

void judge(const std::vector<GnssSample>& samples) {
  for (const GnssSample& sample : samples) {
    require(sample.fix <= rosflight::hal::GnssFix::kTimeOnly);
    require(sample.unix_ns >= 0 && sample.unix_ns < 1'000'000'000);
    require(std::abs(sample.latitude_deg) <= 90.0 && std::abs(sample.longitude_deg) <= 180.0);
  }
}

void receives_a_good_one(Running& receiver) {
  const std::size_t before = receiver.samples().size();
  static const Bytes nothing(UbxFormat::kMaxLength, 0);
  receiver.give(nothing, Running::kWhole);  // longer than what may still be missing of a frame
  const std::size_t then = receiver.samples().size();
  require(then <= before + 1);
  static const Bytes good = frame(0x01, 0x07, Bytes(NavPvt::kBytes));
  receiver.give(good, Running::kWhole);
  require(receiver.samples().size() == then + 1);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes stream =
      data[0] >= 128 ? good_frames(data + 1, size - 1) : Bytes(data + 1, data + size);
  Running whole, cut;
  whole.give(stream, 80);  // less than a solution per call, so that the main loop takes all
  cut.give(stream, data[0] % 64u + 1u);
  judge(whole.samples());
  require(whole.samples().size() == cut.samples().size());
  for (std::size_t k = 0; k < whole.samples().size(); ++k) {
    require(whole.samples()[k].unix_s == cut.samples()[k].unix_s);
    require(whole.samples()[k].fix == cut.samples()[k].fix);
  }
  if ((data[0] & 64u) != 0) receives_a_good_one(cut);
  return 0;
}
