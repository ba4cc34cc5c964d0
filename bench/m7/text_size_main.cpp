// SPDX-License-Identifier: BSD-3-Clause
// Firmware core and MAVLink link with a board that does nothing: an image to be weighed, not run.
#include "bench/m7/idle_board.hpp"
#include "firmware/boards/qemu_m7/startup.hpp"
#include "firmware/core/firmware.hpp"
#include "link/mavlink/mavlink_codec.hpp"

int board_main() {
  rosflight::bench::IdleBoard board;
  rosflight::link::MavlinkCodec codec{{1, rosflight::link::MavlinkCodec::kFcuComponent},
                                      rosflight::link::mavlink::fcu_messages()};
  rosflight::core::Firmware firmware(board.roles(), codec);
  firmware.start();
  for (;;) firmware.run();
}
