// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/absent.hpp"
#include "firmware/boards/common/memories.hpp"
#include "firmware/boards/parts/battery_monitor.hpp"
#include "firmware/boards/parts/crsf.hpp"
#include "firmware/boards/parts/sbus.hpp"
#include "firmware/boards/parts/shared_bus.hpp"
#include "firmware/boards/parts/ublox.hpp"
#include "firmware/boards/stm32h7/backup_domain.hpp"
#include "firmware/boards/stm32h7/battery_pins.hpp"
#include "firmware/boards/stm32h7/h7_system.hpp"
#include "firmware/boards/stm32h7/link_port.hpp"
#include "firmware/boards/stm32h7/part_uart.hpp"
#include "firmware/boards/stm32h7/pulses.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {

class PinLeds final : public hal::Leds {
 public:
  struct Pins {
    Pin override_led, status_led, other;
    bool low_is_lit;  ///< On open drains.
  };
  explicit PinLeds(const Pins& pins) : pins_{pins} {}

  /// All of them off.
  void open();
  void set(hal::Led led, bool on) override;

 private:
  Pins pins_;
};

/// S.Bus, or CRSF with its link quality as strength of the signal.
class UartReceiver final : public hal::Receiver {
 public:
  UartReceiver(const Uart::Pins& pins, const Uart::Memory& memory, const hal::Clock& clock)
      : uart_{pins, memory, clock} {}
  bool start(hal::ReceiverType type) override;
  bool poll(hal::RcFrame& frame) override;
  void on_interrupt() { uart_.on_interrupt(); }

 private:
  UartListener uart_;
  parts::SbusInput sbus_;
  parts::CrsfInput crsf_;
  parts::ReceiverInput* input_{&sbus_};
};

/// What the boards of this chip have in common: clock, link, receiver, battery, GNSS receiver with its
/// pulse per second, outputs, LEDs, watchdog, sleep. A board adds its buses and what is connected to them. The
/// image forwards interrupts to the public functions.
///
/// Interrupts: a data-ready edge (its time is noted, nothing else), then the bus context: buses, UARTs,
/// tick. The main loop sleeps between them.
class FlightBoard {
 public:
  struct Plan {
    LinkPort::Pins link;
    Uart::Pins receiver, gnss;
    Pin pulse_per_second;
    unsigned pulse_irq;
    Pin imu_ready;
    unsigned imu_irq;     ///< Interrupt of imu_ready.
    unsigned sample_irq;  ///< Any that is not used: the edge pends it, for the bus context.
    Pulses::Pins outputs;
    PinLeds::Pins leds;
    BatteryPins::Channels battery;
    parts::AdcScale battery_voltage, battery_current;
  };
  /// What the DMA touches; an object of section .dma.
  struct Memory {
    alignas(32) std::array<std::uint8_t, 4096> link_in;
    alignas(32) std::array<std::uint8_t, 512> link_out;
    alignas(32) std::array<std::uint8_t, 128> receiver_in;
    alignas(32) std::array<std::uint8_t, 512> gnss_in;
    alignas(32) std::array<std::uint8_t, 128> gnss_out;
    Pulses::Memory outputs;
  };

  const Plan& plan() const { return plan_; }
  /// Sleeps until there is something for the main loop.
  void idle();
  void start_watchdog() { system_.start_watchdog(); }
  /// Temperature of the processor's junction; 0 before it was measured.
  float temperature_K() const { return battery_pins_.temperature_K(); }

  void on_imu_ready();
  void on_link() { link_.on_uart(), wakes_ = true; }
  void on_link_sent() { link_.on_uart_sent(); }
  void on_usb() { link_.on_usb(), wakes_ = true; }
  void on_gnss() { gnss_uart_.on_interrupt(), wakes_ = true; }
  void on_gnss_sent() { gnss_uart_.on_sent(); }
  void on_pulse_per_second();
  void on_receiver() { receiver_.on_interrupt(), wakes_ = true; }

 protected:
  /// Clocks and memory system run already.
  FlightBoard(const Plan& plan, Memory& memory, parts::Start how);
  ~FlightBoard() = default;

  /// Opens inputs and starts the interrupts; the board has opened its buses.
  void open_common();
  /// Time of the newest data-ready edge; call it in the interrupt that the edge pended.
  hal::Time edge_time() const;
  /// The common part of a tick, after the board has stepped its buses.
  void step_common();
  void wake() { wakes_ = true; }
  /// Wakes the main loop at each end of a transfer, for a bus with few: the passes between those of the IMU are also
  /// what sends frames that wait for the line. Without them a companion gets attitudes later than 2.5 ms now and then.
  void wake_when_idle(const parts::SharedBus& bus) {
    if (bus.idle()) wakes_ = true;
  }
  /// Wakes the main loop if a count of samples has changed. Each interrupt of a bus asks; most of them only begin the
  /// next transfer of a reading. @param known  what it was the last time; kept by the caller.
  void wake_for(std::uint32_t count, std::uint32_t& known) {
    if (count == known) return;
    known = count;
    wakes_ = true;
  }
  hal::Board roles(hal::Storage& storage, hal::Source<hal::ImuSample>& imu,
                   hal::Source<hal::MagSample>& mag, hal::Source<hal::BaroSample>& baro,
                   hal::Source<hal::DiffPressureSample>& pitot);

  const Plan& plan_;
  MicrosecondClock clock_;
  PartUart gnss_uart_;
  parts::Ublox gnss_{gnss_uart_, parts::Ublox::Config{}};
  H7System system_;

 private:
  /// The tick wakes the main loop this often even if nothing else does.
  static constexpr unsigned kTicksPerWake = 10;

  LinkPort link_;
  UartReceiver receiver_;
  Pulses outputs_;
  BackupRam backup_;
  PinLeds leds_;
  parts::BatteryMonitor battery_;
  BatteryPins battery_pins_;
  Absent<hal::RangeSample> range_;
  volatile std::uint32_t edge_us_{0};
  unsigned ticks_{0};
  volatile bool wakes_{false};
};

}  // namespace rosflight::boards::stm32h7
