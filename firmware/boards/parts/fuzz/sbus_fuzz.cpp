// SPDX-License-Identifier: BSD-3-Clause
// The decoder of S.Bus, see receiver_fuzz.hpp.
#include "firmware/boards/parts/fuzz/receiver_fuzz.hpp"
#include "firmware/boards/parts/sbus.hpp"

namespace {

using namespace rosflight::boards::parts;

struct Sbus {
  using Input = SbusInput;
  static constexpr std::size_t kChannels = 24;
  static constexpr std::size_t kMinFrame = SbusInput::kFrameBytes;
  static Time on_the_wire(std::size_t bytes) {
    return static_cast<std::int64_t>(bytes) * SbusInput::kByte;
  }
  static fuzz::Bytes good_frame(fuzz::Bytes bytes) {
    bytes = fuzz::padded(std::move(bytes), SbusInput::kFrameBytes);
    bytes.resize(SbusInput::kFrameBytes);
    bytes.front() = 0x0F;
    bytes.back() = 0x00;
    return bytes;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run<Sbus>(data, size);
}
