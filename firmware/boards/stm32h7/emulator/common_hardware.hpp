// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "firmware/boards/parts/models/dps310_model.hpp"
#include "firmware/boards/parts/models/truth.hpp"
#include "firmware/boards/parts/models/ublox_model.hpp"
#include "firmware/boards/stm32h7/emulator/emulated_hardware.hpp"
#include "firmware/boards/stm32h7/emulator/history.hpp"
#include "firmware/boards/stm32h7/emulator/part_on_spi.hpp"
#include "firmware/boards/stm32h7/emulator/part_on_uart.hpp"
#include "firmware/boards/stm32h7/emulator/usb_host.hpp"

namespace rosflight::boards::stm32h7::emulator {

constexpr PinName pin(char port, unsigned number) {
  return {static_cast<unsigned>(port - 'A'), number};
}

/// What the boards of this chip have in common: link, receiver, GNSS receiver, outputs, LEDs, and the
/// world that their parts are exposed to. A board adds its buses and parts.
///
/// The wiring is written down independently of the firmware's pin table, so that each checks the other:
/// a pin given to a wrong function is complained of.
class CommonHardware : public EmulatedHardware {
 public:
  Chip& chip() override { return chip_; }
  void power_on() override;
  void expose(const ToChip& world) override;
  void inject(const ToChip& world) override;
  void report(FromChip& out) override;
  double stamp_error_us(std::int64_t stamp_us) override;
  std::vector<std::string> complaints() const override;

 protected:
  struct Output {
    TimerModel Chip::*timer;
    std::size_t channel;
    PinName pin;
    unsigned function;
  };
  struct SerialPins {
    UartModel Chip::*uart;
    PinName receive, transmit;
    unsigned function;
  };
  struct BatteryWiring {
    unsigned voltage_channel, current_channel;
    double volts_per_volt, amperes_per_volt, offset_V;
  };
  struct Wiring {
    std::uint64_t crystal_Hz;
    SpiModel Chip::*imu_bus;
    PinName imu_ready, pulse_per_second;
    SerialPins link, receiver, gnss;  ///< Nothing is connected to the receiver's transmit pin.
    std::vector<Output> outputs;
    std::array<PinName, 3> leds;  ///< Override, status, the other.
    bool low_is_lit;
    BatteryWiring battery;
    std::size_t imu_samples_per_output;  ///< The core takes the mean of so many.
  };
  /// Whether a sensor that delivered before has been without samples of the world for too long: then
  /// it is broken, and mute on its bus. One that never delivered is not connected.
  class Presence {
   public:
    static constexpr std::int64_t kTimeout_us = 300'000;
    bool lost(bool sample, std::int64_t now_us) {
      if (sample) newest_us_ = now_us;
      return connected() && now_us - newest_us_ > kTimeout_us;
    }
    bool connected() const { return newest_us_ >= 0; }

   private:
    std::int64_t newest_us_{-1};
  };
  /// Which sensors of the world are broken, and what else is.
  struct Broken {
    bool baro, mag, pitot;
    bool no_mag;     ///< Injected: the magnetometer is mute.
    bool stuck_i2c;  ///< Injected: the data line of the I2C stays low.
  };
  /// A part as faults are injected into it.
  struct Breakable {
    std::vector<parts::models::Part*> supplied;  ///< What loses its registers together.
    PartOnSpi* on_spi{};                         ///< nullptr if it is on another bus.
    std::function<void(bool wrong)> set_identity;
  };

  explicit CommonHardware(Wiring wiring);

  /// The parts of the board, the GNSS receiver aside.
  virtual std::vector<const parts::models::Part*> parts() const = 0;
  /// Brings the parts to this time, before the world changes.
  virtual void advance_parts() = 0;
  /// Age, at the data-ready edge, of what a sample of the IMU shows.
  virtual double imu_delay_us() const = 0;
  virtual void set_broken(const Broken& broken) = 0;
  /// For Breakable: this register reads as that of another part.
  static std::function<void(bool)> identity_of(parts::models::RegisterFile& registers,
                                               std::uint8_t reg);
  /// IMU, barometer or magnetometer.
  virtual Breakable breakable(FaultyPart which) = 0;
  /// The data-ready line of the IMU.
  void data_ready(bool high);
  /// What an IMU on the board's axes was exposed to, between the samples of the world.
  parts::models::ImuTruth imu_truth(hal::Time when) const;
  void expect_pins(std::initializer_list<PinName> pins, unsigned function);

  Chip chip_;
  parts::models::BaroTruth baro_truth_;
  parts::models::MagTruth mag_truth_;  ///< In the axes of the board.
  parts::models::DiffPressureTruth pitot_truth_;
  Presence pitot_presence_;

 private:
  parts::models::GnssTruth gnss_truth(hal::Time when) const;
  void connect_serial();
  bool far_end_reads(std::uint32_t baud) const;
  void note_output_latency();
  void note_output();
  void take_samples(const ToChip& world);
  void send_receiver_frame(const ToChip& world);
  double battery_pin_V(unsigned channel) const;
  void inject_into_flash(const ToChip& world);
  void inject_into_part(const ToChip& world);
  void inject_overrun(FaultyPart part);
  void repair();
  bool is_mute(FaultyPart part) const { return mute_[static_cast<std::size_t>(part)]; }

  Wiring wiring_;
  double battery_V_{0.0}, battery_A_{0.0};
  /// As long as a solution needs to be sent, and longer.
  History<hal::GnssSample, 64> gnss_samples_;
  parts::models::UbloxModel gnss_{[this](hal::Time when) { return gnss_truth(when); }};
  PartOnUart gnss_on_wire_;
  UsbHost usb_host_{chip_.processor, chip_.usb};
  Presence baro_presence_, mag_presence_, gnss_presence_;
  std::vector<std::uint8_t> sent_;
  std::uint32_t link_baud_{0};     ///< Rate of the far end; 0: any.
  std::uint64_t link_garbled_{0};  ///< Bytes that it could not read.
  History<parts::models::ImuTruth, 8> imu_truths_;
  std::array<Ticks, 16> edges_{};  ///< Times of the newest data-ready edges.
  std::size_t edge_count_{0};
  std::int64_t judged_stamp_us_{0};
  double stamp_error_us_{0.0};  ///< That of judged_stamp_us_.
  Ticks edge_{0};               ///< Time of the newest data-ready edge.
  Ticks latency_{0};            ///< Longest from an edge to the write that followed,
  Ticks computing_{0};          ///< and from the end of the transfer before it.
  Ticks judged_{0};             ///< Time of the last write that was judged so.
  bool imu_is_silent_{false};   ///< Injected: no data-ready edge reaches the chip.
  // Injected too:
  Ticks edges_lost_until_{0};
  std::array<bool, 6> mute_{};  ///< By FaultyPart.
  bool i2c_is_stuck_{false};
  std::vector<const parts::models::Part*>
      browned_out_;  ///< The firmware cannot know when their start-up ends.
  std::size_t torn_word_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
