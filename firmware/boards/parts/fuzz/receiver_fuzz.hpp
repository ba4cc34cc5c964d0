// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "firmware/boards/parts/fuzz/exact_block.hpp"
#include "firmware/boards/parts/receiver_input.hpp"

/// Feeds arbitrary bytes to a receiver's decoder. The first byte says how the stream is divided into
/// calls. Then come pieces: silence before it (a byte, in 100 us; 255 is a line error), length, and bytes;
/// a length with its top bit set asks for a good frame made of the bytes. Whatever comes, frames are
/// well formed, their number does not depend on the division, and a good frame after silence is taken.
namespace rosflight::boards::parts::fuzz {

using Bytes = std::vector<std::uint8_t>;

inline void require(bool held) {
  if (!held) std::abort();
}

struct Outcome {
  std::vector<hal::RcFrame> frames;
  std::uint32_t good{};
  std::uint32_t bad{};
  std::uint32_t strays{};
};

template <class Traits>
class Feed {
 public:
  explicit Feed(std::size_t chunk) : chunk_{chunk} {}

  void bytes(const Bytes& piece, Time silence) {
    now_ += silence;
    for (std::size_t at = 0; at < piece.size(); at += chunk_) {
      const std::size_t size = std::min(chunk_, piece.size() - at);
      sent_ += size;
      input_.receive(block_.holding(piece.data() + at, size), size,
                     now_ + Traits::on_the_wire(at + size));
      collect();
    }
    now_ += Traits::on_the_wire(piece.size());
  }
  void line_error() { input_.line_error(now_); }
  const Outcome& outcome() {
    outcome_.good = input_.good();
    outcome_.bad = input_.bad();
    outcome_.strays = input_.strays();
    return outcome_;
  }

 private:
  void collect() {
    hal::RcFrame frame;
    while (input_.poll(frame)) {
      require(frame.channel_count == Traits::kChannels);
      for (const float channel : frame.channels) require(channel > -0.2f && channel < 1.2f);
      require(frame.stamp <= now_ + Traits::on_the_wire(sent_));
      outcome_.frames.push_back(frame);
    }
    require(outcome_.frames.size() <= sent_ / Traits::kMinFrame);
    require(input_.good() >= outcome_.frames.size());
  }

  ExactBlock block_;
  typename Traits::Input input_{};
  std::size_t chunk_;
  std::size_t sent_{0};
  Time now_{hal::milliseconds(1000)};
  Outcome outcome_;
};

template <class Traits>
Outcome feed(const std::uint8_t* data, std::size_t size, std::size_t chunk) {
  Feed<Traits> feed{chunk};
  for (std::size_t at = 0; at + 2 <= size;) {
    const std::uint8_t silence = data[at];
    const bool good = data[at + 1] >= 128;
    const std::size_t length = std::min<std::size_t>(data[at + 1] % 128u, size - at - 2);
    const Bytes piece(data + at + 2, data + at + 2 + length);
    at += 2 + length;
    if (silence == 255) feed.line_error();
    feed.bytes(good ? Traits::good_frame(piece) : piece, Time{std::int64_t{silence} % 128 * 100});
  }
  // Whatever came before: silence, and a good frame is taken.
  const std::size_t before = feed.outcome().frames.size();
  feed.bytes(Traits::good_frame({}), hal::milliseconds(10));
  require(feed.outcome().frames.size() == before + 1);
  return feed.outcome();
}

template <class Traits>
int run(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Outcome whole = feed<Traits>(data + 1, size - 1, 200);
  const Outcome cut = feed<Traits>(data + 1, size - 1, data[0] % 64u + 1u);
  require(whole.good == cut.good && whole.bad == cut.bad && whole.strays == cut.strays);
  require(whole.frames.size() == cut.frames.size());
  for (std::size_t k = 0; k < whole.frames.size(); ++k) {
    require(whole.frames[k].channels == cut.frames[k].channels);
    require(whole.frames[k].failsafe == cut.frames[k].failsafe);
    require(std::abs((whole.frames[k].stamp - cut.frames[k].stamp).count()) <= 1);
  }
  return 0;
}

/// At least `size` bytes.
inline Bytes padded(Bytes bytes, std::size_t size) {
  if (bytes.size() < size) bytes.resize(size, 0x55);
  return bytes;
}

}  // namespace rosflight::boards::parts::fuzz
