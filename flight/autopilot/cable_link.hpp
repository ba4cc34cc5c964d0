// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "companion/transport.hpp"
#include "firmware/hal/roles.hpp"
#include "flight/autopilot/link_tap.hpp"
#include "sim/serial_cable.hpp"

namespace rosflight::flight {

/// The simulated serial cable with a plug at each end: the serial port of the autopilot and the
/// transport of the companion. Its time is simulated time, which goes on during a reboot.
class CableLink {
 public:
  explicit CableLink(const sim::RandomSource& random) : cable_{sim::SerialLine::Config{}, random} {}
  CableLink(const CableLink&) = delete;
  CableLink& operator=(const CableLink&) = delete;

  void set_time(sim::Time now) { now_ = now; }
  void set_tap(LinkTap* tap) { tap_ = tap; }
  LinkTap* tap() { return tap_; }
  const sim::Time& time() const { return now_; }
  sim::SerialCable& cable() { return cable_; }
  hal::Serial& port() { return port_; }
  companion::Transport& companion_end() { return companion_; }
  /// Whether the autopilot would read bytes now.
  bool waiting() { return cable_.to_board.waiting(now_) > 0; }

 private:
  bool push(Direction direction, sim::SerialLine& line, const std::uint8_t* data, std::size_t size,
            std::uint8_t qos) {
    const bool taken = line.push(now_, data, size, qos);
    if (tap_ != nullptr) tap_->on_frame(direction, now_, data, size, taken);
    return taken;
  }

  class Port final : public hal::Serial {
   public:
    explicit Port(CableLink& link) : link_{link} {}
    bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
    bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
      return link_.push(Direction::kToCompanion, link_.cable_.to_companion, data, size, qos);
    }
    std::size_t writable() const override { return link_.cable_.to_companion.writable(); }
    std::size_t read(std::uint8_t* data, std::size_t capacity) override {
      const std::size_t count = link_.cable_.to_board.pop(link_.now_, data, capacity);
      if (link_.tap_ != nullptr && count > 0) link_.tap_->on_read(link_.now_, data, count);
      return count;
    }

   private:
    CableLink& link_;
  };

  class Companion final : public companion::Transport {
   public:
    explicit Companion(CableLink& link) : link_{link} {}
    bool connected() override { return true; }
    std::size_t read(std::uint8_t* data, std::size_t capacity) override {
      return link_.cable_.to_companion.pop(link_.now_, data, capacity);
    }
    bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
      return link_.push(Direction::kToAutopilot, link_.cable_.to_board, data, size, qos);
    }

   private:
    CableLink& link_;
  };

  sim::SerialCable cable_;
  sim::Time now_{};
  LinkTap* tap_{nullptr};
  Port port_{*this};
  Companion companion_{*this};
};

}  // namespace rosflight::flight
