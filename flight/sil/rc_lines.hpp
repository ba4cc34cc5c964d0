// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string>

#include "sim/rc/pilot.hpp"

namespace rosflight::flight {

/// A pilot moved by lines from a pipe or terminal, as they come: "roll 0.5", "arm 1". Controls are those of
/// sim::rc::kControlNames, positions 0 to 1.
class RcLines {
 public:
  /// @param fd  to read from. @param pilot  must outlive this. @param err  gets a line for each line that is none.
  RcLines(int fd, sim::rc::Pilot& pilot, std::ostream& err) : fd_{fd}, pilot_{pilot}, err_{err} {}

  /// Reads what has come since the last call, at most 4 kB, and moves the controls; does not wait.
  void step();

 private:
  void move(const std::string& line);

  int fd_;  ///< -1: it has ended.
  sim::rc::Pilot& pilot_;
  std::ostream& err_;
  std::string rest_;  ///< Start of a line whose end has not come.
};

}  // namespace rosflight::flight
