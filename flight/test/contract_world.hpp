// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "flight/autopilot/chip_autopilot.hpp"

namespace rosflight::flight::testing {

/// The far end of the link of an image that runs the contract suites of the HAL on an emulated board, and the world around
/// that board: carries out the orders of firmware/boards/stm32h7/test/far_end.hpp.
class ContractWorld {
 public:
  enum class Cable : std::uint8_t { kUart, kUsb };
  struct Result {
    std::string printed;  ///< By GoogleTest.
    std::string problem;  ///< Empty if the image ended by itself, with status 0.
  };

  /// Power is off.
  explicit ContractWorld(const boards::stm32h7::ChipProcess::Options& image);

  /// Puts the power on, runs the image with an option of GoogleTest (without its beginning "--gtest_") to its end, over
  /// restarts that the test asks for. A complaint of a model is an exception.
  Result run(const std::string& option, Cable cable);

 private:
  void power_on();
  void step();
  void take_output();
  void carry_out(const std::string& order);
  void begin_image();
  void show(const std::string& kind, const std::string& bytes);
  void answer(const std::string& line);
  void answer_times(std::int64_t valid_us);

  boards::stm32h7::ChipProcess chip_;
  std::int64_t now_us_{0};
  std::int64_t powered_at_us_{0};
  std::vector<std::uint8_t> to_board_;
  std::string output_;  ///< What the image sent in this run, without orders.
  std::string option_, after_;
  Cable cable_{Cable::kUart};
  bool begun_{false}, restart_expected_{false};
  std::uint32_t resets_{0};  ///< When the test announced one more.
  std::size_t searched_{0};  ///< The output has no order before this place.
  bool marked_{false};
  std::size_t mark_{0};
  std::string ended_;  ///< Status of GoogleTest.
  std::string problem_;
};

}  // namespace rosflight::flight::testing
