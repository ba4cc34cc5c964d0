// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware/hal/samples.hpp"
#include "firmware/hal/time.hpp"

/// What the autopilot needs from a board: one narrow interface per role. Every function is called
/// from the single control thread, does not block unless its comment states otherwise, and does not
/// throw. test/contract/ has one suite per role, which every implementation passes.
namespace rosflight::hal {

class Clock {
 public:
  /// Time since boot, never decreasing; same origin as the stamps of the samples.
  virtual Time now() const = 0;

 protected:
  ~Clock() = default;
};

/// A sensor or receiver that hands over complete samples.
template <class Sample>
class Source {
 public:
  /// Fills `sample` and returns true exactly once per new sample; otherwise leaves it untouched.
  virtual bool poll(Sample& sample) = 0;

 protected:
  ~Source() = default;
};

enum class ReceiverType : std::uint8_t { kPpm = 0, kSbus = 1, kCrsf = 2 };

class Receiver : public Source<RcFrame> {
 public:
  /// May be called again at any time. @returns false if the board has no such receiver input; the
  /// previous one then stays in use.
  virtual bool start(ReceiverType type) = 0;

 protected:
  ~Receiver() = default;
};

class Battery : public Source<BatterySample> {
 public:
  /// Scales from the pin to the battery, at first the board's own; 0 keeps the one in force.
  virtual void set_multipliers(float voltage, float current) = 0;

 protected:
  ~Battery() = default;
};

/// The serial link to the companion computer.
class Serial {
 public:
  static constexpr std::uint8_t kUrgent = 0;  ///< Transmitted first; IMU samples.
  static constexpr std::uint8_t kTimely = 1;  ///< Time synchronisation.
  static constexpr std::uint8_t kOrdinary = 255;
  /// The three classes in the order of transmission, the same on every board that has queues.
  static constexpr std::size_t kClasses = 3;
  /// Class of a quality of service: 0 for kUrgent, 2 for kOrdinary, 1 for every value between.
  static constexpr std::size_t class_of(std::uint8_t qos) {
    return qos == kUrgent ? 0 : qos == kOrdinary ? 2 : 1;
  }

  /// Called once. @returns false if the board has no such device or rate; it then uses its own.
  virtual bool open(std::uint32_t baud, std::uint8_t device) = 0;
  /// Queues a whole frame or drops it whole. @returns false if it was dropped.
  virtual bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) = 0;
  /// Bytes that write() would accept now; senders of bulk data pace themselves with it.
  virtual std::size_t writable() const = 0;
  /// Whether the connection in use has room for every sample, whatever rate was asked for: USB.
  virtual bool carries_all() const { return false; }
  /// Copies up to `capacity` received bytes. @returns the number copied, 0 if none was received.
  virtual std::size_t read(std::uint8_t* data, std::size_t capacity) = 0;

 protected:
  ~Serial() = default;
};

class Outputs {
 public:
  static constexpr float kHighLevel = 0.5f;
  /// Sets pulse rates; allowed at run time. A rate of 0 means no pulses: the pin is a level. It fits any rate
  /// of the others. @returns false if the board cannot give some channel its rate (a timer group has one
  /// rate); it then uses the nearest it can.
  virtual bool configure(const OutputRates& rates_hz) = 0;
  /// Clamps to 0..1 (NaN to 0) and drives the pins, a level high from kHighLevel up; ignores channels the
  /// board lacks.
  virtual void write(const OutputValues& values) = 0;
  /// Stops all pulses and makes all levels low until the next configure().
  virtual void disable() = 0;

 protected:
  ~Outputs() = default;
};

/// Non-volatile memory, byte addressed. Contents survive power cuts except for the bytes being
/// written.
class Storage {
 public:
  virtual std::size_t size() const = 0;
  /// @returns false if the range is outside or the medium failed; `data` is then unspecified.
  virtual bool read(std::size_t offset, std::uint8_t* data, std::size_t count) = 0;
  /// May block up to 1 s; called disarmed only. Bytes reach the medium in ascending order.
  virtual bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) = 0;
  /// Called after a set of writes. Returns when all of it is stored. @returns false if that failed.
  virtual bool flush() = 0;

 protected:
  ~Storage() = default;
};

/// A few bytes that survive a reset but not a power cycle.
class BackupMemory {
 public:
  static constexpr std::size_t kSize = 128;
  /// Reads the first `count` <= kSize bytes. @returns false if there is no such memory or its content
  /// did not survive.
  virtual bool read(std::uint8_t* data, std::size_t count) = 0;
  /// Writes the first `count` <= kSize bytes. @returns false if there is no such memory.
  virtual bool write(const std::uint8_t* data, std::size_t count) = 0;
  /// Sets every byte to 0.
  virtual void clear() = 0;

 protected:
  ~BackupMemory() = default;
};

enum class Led : std::uint8_t { kOverride = 0, kStatus = 1 };

class Leds {
 public:
  /// Switches an LED; a board without it does nothing.
  virtual void set(Led led, bool on) = 0;

 protected:
  ~Leds() = default;
};

/// The processor and its peripherals as a whole.
class System {
 public:
  /// Starts the sensors. Called once, after parameters and link are up.
  virtual void start_sensors() = 0;
  /// Sensors that failed to start or to answer, since boot.
  virtual std::uint16_t sensor_errors() const = 0;
  /// Start-up report, one line per sensor; nullptr past the last. Sets `ok` to false for a sensor
  /// that failed.
  virtual const char* sensor_message(std::size_t index, bool& ok) const = 0;
  /// The next sensor that failed since the start-up report, or that works again after a failure that was reported:
  /// one line, once for each change. nullptr if nothing has changed. Sets `ok` to false for a failure.
  virtual const char* sensor_change(bool& /*ok*/) { return nullptr; }
  /// Restarts the processor, into its bootloader if requested. Returns only on a simulated board,
  /// which restarts when the pass has ended.
  virtual void reset(bool to_bootloader) = 0;
  /// Feeds the watchdog; called once per pass.
  virtual void feed_watchdog() = 0;
  /// Processor time that this thread has used, from any origin; never decreases. The difference of
  /// two calls is the cost of a pass. A board that runs nothing else returns its clock.
  virtual Time busy_time() const = 0;
  /// Other programs share the processor, so the duration of a pass does not depend on the firmware
  /// alone.
  virtual bool shares_processor() const = 0;

 protected:
  ~System() = default;
};

/// A board: names its implementation of each role. Held by reference for the life of the firmware.
struct Board {
  Clock& clock;
  System& system;
  Serial& serial;
  Storage& storage;
  BackupMemory& backup;
  Leds& leds;
  Outputs& outputs;
  Receiver& receiver;
  Battery& battery;
  Source<ImuSample>& imu;
  Source<MagSample>& mag;
  Source<BaroSample>& baro;
  Source<DiffPressureSample>& diff_pressure;
  Source<RangeSample>& range;
  Source<GnssSample>& gnss;
};

}  // namespace rosflight::hal
