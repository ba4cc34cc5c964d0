// SPDX-License-Identifier: BSD-3-Clause
#include "link/test/codec_contract.hpp"

#include "link/detect/detecting_codec.hpp"
#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::link::contract {
namespace {

struct Mavlink {
  static MavlinkCodec fcu() { return MavlinkCodec({1, MavlinkCodec::kFcuComponent}); }
  static MavlinkCodec companion() { return MavlinkCodec({1, MavlinkCodec::kCompanionComponent}); }
};

struct Lean {
  static LeanCodec fcu() { return LeanCodec(); }
  static LeanCodec companion() { return LeanCodec(); }
};

template <class Board>
struct Detecting {
  static auto fcu() { return Board::fcu(); }
  static DetectingCodec companion() { return DetectingCodec(); }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Mavlink, CodecContract, Mavlink);
INSTANTIATE_TYPED_TEST_SUITE_P(Lean, CodecContract, Lean);
INSTANTIATE_TYPED_TEST_SUITE_P(DetectingMavlink, CodecContract, Detecting<Mavlink>);
INSTANTIATE_TYPED_TEST_SUITE_P(DetectingLean, CodecContract, Detecting<Lean>);

}  // namespace
}  // namespace rosflight::link::contract
