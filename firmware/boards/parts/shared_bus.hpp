// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/bus.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// What a chip does for a bus: one transfer at a time, to a device it knows by number. SharedBus calls
/// it, with interrupts masked.
class BusHardware {
 public:
  /// Starts one transfer and returns; later, from its interrupt, the chip calls SharedBus::complete().
  /// Selects the device itself (chip select with setup and hold time, or I2C address and condition).
  /// @param device  a number of the board's choice, given to SharedPort.
  virtual void begin(std::uint8_t device, const Transfer& transfer) = 0;
  /// Stops the transfer that runs, deselects, and brings the bus into a state in which begin() works
  /// (I2C: up to nine clocks until the data line is free, then a stop). complete() is not called for it.
  virtual void abort() = 0;
  /// Keeps the bus context away while the queue changes; returns what unmask() restores. A board
  /// without interrupts returns 0.
  virtual std::uint32_t mask() = 0;
  virtual void unmask(std::uint32_t state) = 0;

 protected:
  ~BusHardware() = default;
};

/// Divides one bus among its ports: urgent ports first, otherwise in order of start(). A transfer that
/// runs is not interrupted, so an urgent one waits for at most one other (72 bytes: 144 us at 4 MHz).
///
/// A transfer that has not ended kLimit after it began is aborted and reported as kTimeout; the others
/// follow. So a stuck bus costs each driver its transfers, and nobody waits for ever.
class SharedBus {
 public:
  static constexpr std::size_t kSlots = 12;  ///< Transfers that wait, of all ports.
  static constexpr Time kDefaultLimit = hal::milliseconds(5);

  /// Both must outlive this. @param limit  longest time of one transfer; I2C at 100 kHz: 8 ms.
  SharedBus(BusHardware& hardware, const hal::Clock& clock, Time limit = kDefaultLimit)
      : hardware_{hardware}, clock_{clock}, limit_{limit} {}

  /// The transfer that runs has ended; called by the chip, in the bus context. Ignored if none runs.
  void complete(TransferResult result);
  /// Aborts what has been running for too long. Bus context, once per tick.
  void step();
  /// Bus context or main loop; see Port::start().
  bool submit(std::uint8_t device, bool urgent, Transfer& transfer);

  bool idle() const { return active_ == nullptr; }
  /// Transfers that ended other than kDone, since construction.
  std::uint32_t failures() const { return failures_; }

 private:
  struct Waiting {
    Transfer* transfer{};
    std::uint8_t device{};
    bool urgent{};
  };
  void begin_next();
  void finish(TransferResult result);

  BusHardware& hardware_;
  const hal::Clock& clock_;
  Time limit_;
  Time begun_{};
  std::array<Waiting, kSlots> waiting_{};
  std::size_t count_{0};
  Transfer* volatile active_{nullptr};
  std::uint32_t failures_{0};
};

/// A port of a shared bus.
class SharedPort final : public Port {
 public:
  /// @param urgent  goes before others that wait; for the IMU.
  SharedPort(SharedBus& bus, std::uint8_t device, bool urgent = false)
      : bus_{bus}, device_{device}, urgent_{urgent} {}
  bool start(Transfer& transfer) override { return bus_.submit(device_, urgent_, transfer); }

 private:
  SharedBus& bus_;
  std::uint8_t device_;
  bool urgent_;
};

}  // namespace rosflight::boards::parts
