// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/hal/time.hpp"

/// Models of parts at the level of their registers, for tests of drivers and for an emulated chip.
/// Host code. A model has no clock: its driver sets the time before anything else of
/// that time happens, and reads from next_event() when to do so again.
namespace rosflight::boards::parts::models {

using hal::Time;

/// No further event.
inline constexpr Time kNever{INT64_MAX};

class Part {
 public:
  virtual ~Part() = default;
  /// Everything that happens up to and including `now`, in order: conversions end, lines change. Times
  /// never decrease.
  virtual void advance(Time now) = 0;
  /// When something happens next without a transfer, for a scheduler; kNever if nothing does.
  virtual Time next_event() const = 0;
  /// Takes and gives the power; registers are lost.
  virtual void set_power(bool on) = 0;

  /// What the part saw that silicon would not forgive, such as a write within its start-up time. A test
  /// demands that it stays empty.
  const std::vector<std::string>& complaints() const { return complaints_; }

 protected:
  void complain(std::string what) { complaints_.push_back(std::move(what)); }

 private:
  std::vector<std::string> complaints_;
};

/// An output of a part: data ready, end of conversion.
using Line = std::function<void(bool high, Time when)>;

/// A part on SPI. Three or four wires are the same here: a byte goes each way.
class SpiPart : public Part {
 public:
  /// Chip select; `true` is low on the pin. advance() was called with the same time.
  virtual void select(bool selected) = 0;
  /// One byte each way while selected.
  virtual std::uint8_t exchange(std::uint8_t out) = 0;
};

/// A part on I2C. What it answers is valid at the time of the last advance().
class I2cPart : public Part {
 public:
  virtual std::uint8_t address() const = 0;
  /// A start condition with this part's address. @returns whether it acknowledges.
  virtual bool begin(bool read) = 0;
  /// @returns whether it acknowledges.
  virtual bool write(std::uint8_t byte) = 0;
  virtual std::uint8_t read() = 0;
  virtual void stop() = 0;
};

/// A part on a UART, byte by byte. A byte at another rate than the part's own is noise to it.
class UartPart : public Part {
 public:
  virtual void receive(std::uint8_t byte, std::uint32_t baud) = 0;
  /// Takes the byte whose stop bit ended by the time of the last advance(). @returns false if none did.
  virtual bool take(std::uint8_t& byte, std::uint32_t& baud, Time& end) = 0;
};

}  // namespace rosflight::boards::parts::models
