// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "firmware/boards/stm32h7/emulator/usb_model.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// The computer at the far end of the USB cable, with a program that has the virtual serial port open. It
/// enumerates the device as Linux does and then moves bytes: one transaction in each direction per 64 us,
/// somewhat slower than the bus allows.
///
/// Complains of: a device that does not answer within 0.5 s, stalls what it must support, has another
/// address than it was given, or descriptors that contradict themselves.
class UsbHost final : public Timed {
 public:
  static constexpr Ticks kTransaction = 64 * kTicksPerMicrosecond;

  UsbHost(Core& core, UsbModel& device) : core_{core}, device_{device} {}

  /// The cable. Out: what waits is lost.
  void plug(bool in);
  /// Queues bytes for the device.
  void send(const std::uint8_t* data, std::size_t count) {
    to_device_.insert(to_device_.end(), data, data + count);
  }
  std::function<void(const UsbModel::Packet&)> on_data;
  /// The chip was reset or lost its power: it is no longer attached.
  void event(Ticks now) override;
  bool running() const { return stage_ == Stage::kRunning; }
  std::uint64_t enumerations() const { return enumerations_; }

 private:
  enum class Stage : std::uint8_t { kUnplugged, kWaiting, kSettling, kReset, kControl, kRunning };
  enum class Phase : std::uint8_t { kSetup, kData, kStatus };
  struct Request {
    std::uint8_t type{}, request{};
    std::uint16_t value{}, index{}, length{};
    UsbModel::Packet out;
  };
  static const std::vector<Request>& script();

  void enter(Stage stage, Ticks delay);
  void step_control();
  bool phase_done();
  void finish_request();
  void check_answer(const Request& request);
  void step_data();

  Core& core_;
  UsbModel& device_;
  Stage stage_{Stage::kUnplugged};
  Phase phase_{Phase::kSetup};
  std::size_t next_{0};  ///< Next item of the script.
  Ticks since_{0};
  UsbModel::Packet answer_;
  std::deque<std::uint8_t> to_device_;
  std::uint64_t enumerations_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
