// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/firmware.hpp"
#include "flight/replay/csv.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::flight {

/// Firmware on a board of memory, fed from a table; what comes by the link comes as real frames.
class ReplayRig {
 public:
  ReplayRig();

  /// Sets a parameter by name as a companion would. @throws InputError (without place) if the
  /// firmware does not take it.
  void set_parameter(const std::string& name, double value);

  /// Runs one pass with the inputs of `row`.
  void step(const CsvTable& table, std::size_t row);

  /// Value of an output column after the last step, as text. `column` is one of output_columns().
  std::string output(const std::string& column) const;

  /// What the firmware runs on.
  boards::SimulatedBoard& board() { return board_; }

  static const std::vector<std::string>& output_columns();
  /// True for a column that is an input, known and possibly ignored.
  static bool is_input(std::string_view column);

 private:
  struct Row;
  void feed_imu(const Row& row);
  void feed_receiver(const Row& row);
  void feed_link(const Row& row);
  void feed_events(const Row& row);
  void feed_auxiliary(const Row& row, std::string_view text);
  void send(const link::Message& message);

  boards::MemorySerial serial_;
  boards::SimulatedBoard board_;
  link::MavlinkCodec codec_;
  link::MavlinkCodec companion_;
  core::Firmware firmware_;
};

}  // namespace rosflight::flight
