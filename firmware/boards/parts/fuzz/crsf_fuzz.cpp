// SPDX-License-Identifier: BSD-3-Clause
// The decoder of CRSF, see receiver_fuzz.hpp.
#include "firmware/boards/parts/crsf.hpp"
#include "firmware/boards/parts/fuzz/receiver_fuzz.hpp"

namespace {

using namespace rosflight::boards::parts;

/// Channels, or link statistics if the first byte is odd.
fuzz::Bytes make_frame(fuzz::Bytes payload) {
  const bool statistics = !payload.empty() && (payload[0] & 1u) != 0;
  payload = fuzz::padded(std::move(payload), 22);
  payload.resize(statistics ? 10 : 22);
  fuzz::Bytes frame{0xC8, static_cast<std::uint8_t>(payload.size() + 2),
                    static_cast<std::uint8_t>(statistics ? 0x14 : 0x16)};
  frame.insert(frame.end(), payload.begin(), payload.end());
  frame.push_back(CrsfFormat::crc8(frame.data() + 2, frame.size() - 2));
  return frame;
}

struct Crsf {
  using Input = CrsfInput;
  static constexpr std::size_t kChannels = 16;
  static constexpr std::size_t kMinFrame = 26;
  static Time on_the_wire(std::size_t bytes) {
    return Time{static_cast<std::int64_t>(bytes) * 10'000'000 / 420'000};
  }
  static fuzz::Bytes good_frame(fuzz::Bytes payload) { return make_frame(std::move(payload)); }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run<Crsf>(data, size);
}
