// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "apps/fly/firmware_board.hpp"
#include "apps/fly/link_tap.hpp"
#include "companion/transport.hpp"
#include "firmware/hal/roles.hpp"
#include "sim/serial_cable.hpp"

/// The two plugs of the simulated serial cable: the FCU's serial port and the companion's
/// transport.
namespace rosflight::apps {

/// The serial role of a board, its bytes on the cable.
class BoardEnd final : public BoardSerial {
 public:
  /// `clock` is the world's, not the board's: the cable outlives a reboot.
  BoardEnd(sim::SerialCable& cable, const hal::Time& clock) : cable_{cable}, now_{clock} {}
  void set_tap(LinkTap* tap) { tap_ = tap; }

  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    const bool taken = cable_.to_companion.push(now_, data, size, qos);
    if (tap_ != nullptr) tap_->on_frame(Direction::kToCompanion, now_, data, size, taken);
    return taken;
  }
  std::size_t writable() const override { return cable_.to_companion.writable(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    return cable_.to_board.pop(now_, data, capacity);
  }
  bool waiting() override { return cable_.to_board.waiting(now_) > 0; }

 private:
  sim::SerialCable& cable_;
  const hal::Time& now_;
  LinkTap* tap_{nullptr};
};

class CompanionEnd final : public companion::Transport {
 public:
  CompanionEnd(sim::SerialCable& cable, const hal::Time& clock) : cable_{cable}, now_{clock} {}
  void set_tap(LinkTap* tap) { tap_ = tap; }

  bool connected() override { return true; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    return cable_.to_companion.pop(now_, data, capacity);
  }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    const bool taken = cable_.to_board.push(now_, data, size, qos);
    if (tap_ != nullptr) tap_->on_frame(Direction::kToBoard, now_, data, size, taken);
    return taken;
  }

 private:
  sim::SerialCable& cable_;
  const hal::Time& now_;
  LinkTap* tap_{nullptr};
};

}  // namespace rosflight::apps
