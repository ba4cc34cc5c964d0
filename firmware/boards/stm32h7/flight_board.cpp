// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/flight_board.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kTick_us = 1000;

}  // namespace

void PinLeds::open() {
  for (const Pin& pin : {pins_.override_led, pins_.status_led, pins_.other}) {
    make_output(pin, pins_.low_is_lit, pins_.low_is_lit ? Drive::kOpenDrain : Drive::kPushPull);
  }
}

void PinLeds::set(hal::Led led, bool on) {
  const bool high = on != pins_.low_is_lit;
  set_level(led == hal::Led::kOverride ? pins_.override_led : pins_.status_led, high);
}

bool UartReceiver::start(hal::ReceiverType type) {
  if (type == hal::ReceiverType::kPpm) return false;
  const bool crsf = type == hal::ReceiverType::kCrsf;
  parts::ReceiverInput* const wanted = crsf ? static_cast<parts::ReceiverInput*>(&crsf_) : &sbus_;
  if (!uart_.open(crsf ? parts::CrsfInput::kFormat : parts::SbusInput::kFormat, *wanted))
    return false;
  input_ = wanted;
  return true;
}

bool UartReceiver::poll(hal::RcFrame& frame) {
  if (!input_->poll(frame)) return false;
  frame.rssi = input_->rssi(frame.stamp);
  return true;
}

FlightBoard::FlightBoard(const Plan& plan, Memory& memory, parts::Start how)
    : plan_{plan},
      gnss_uart_{plan.gnss,
                 {memory.gnss_in.data(), memory.gnss_in.size(), memory.gnss_out.data(),
                  memory.gnss_out.size()},
                 clock_},
      system_{clock_, how},
      link_{plan.link,
            {memory.link_in.data(), memory.link_in.size(), memory.link_out.data(),
             memory.link_out.size()}},
      receiver_{plan.receiver,
                {memory.receiver_in.data(), memory.receiver_in.size(), nullptr, 0},
                clock_},
      outputs_{plan.outputs, memory.outputs},
      backup_{&memory_at<std::uint8_t>(kBackupMemory)},
      leds_{plan.leds},
      battery_{plan.battery_voltage, plan.battery_current},
      battery_pins_{plan.battery, battery_} {}

void FlightBoard::open_common() {
  leds_.open();
  battery_pins_.open();
  gnss_uart_.connect(gnss_);
  static_cast<void>(gnss_uart_.set_format(parts::UartFormat{}));
  make_input(plan_.pulse_per_second, Pull::kDown);
  watch_rising_edge(plan_.pulse_per_second);
  enable_interrupt(plan_.pulse_irq, Priority::kBus);
  static_cast<void>(receiver_.start(hal::ReceiverType::kSbus));
  make_input(plan_.imu_ready, Pull::kDown);
  watch_rising_edge(plan_.imu_ready);
  enable_interrupt(plan_.imu_irq, Priority::kEdge);
  enable_interrupt(plan_.sample_irq, Priority::kBus);
  system_.start_imu();
  start_tick(kTick_us);
}

hal::Board FlightBoard::roles(hal::Storage& storage, hal::Source<hal::ImuSample>& imu,
                              hal::Source<hal::MagSample>& mag, hal::Source<hal::BaroSample>& baro,
                              hal::Source<hal::DiffPressureSample>& pitot) {
  return {clock_,   system_, link_, storage, backup_, leds_,  outputs_, receiver_,
          battery_, imu,     mag,   baro,    pitot,   range_, gnss_};
}

void FlightBoard::on_imu_ready() {
  edge_us_ = microseconds();
  clear_edge(plan_.imu_ready);
  pend_interrupt(plan_.sample_irq);
}

hal::Time FlightBoard::edge_time() const {
  const hal::Time now = clock_.now();
  const auto ago = static_cast<std::uint32_t>(now.count()) - edge_us_;
  return now - hal::Time{ago};
}

void FlightBoard::on_pulse_per_second() {
  const hal::Time now = clock_.now();
  clear_edge(plan_.pulse_per_second);
  gnss_.pulse(now);
}

void FlightBoard::step_common() {
  clock_.keep();
  link_.step();
  gnss_uart_.step();
  const hal::Time now = clock_.now();
  battery_pins_.step(now);
  system_.step(now);
  if (++ticks_ % kTicksPerWake == 0) wakes_ = true;
}

/// Bytes of the link do not wake by themselves: its UART interrupts at the end of a frame, so that a frame costs one
/// pass and not one at each interrupt meanwhile.
void FlightBoard::idle() {
  const hal::Time begin = clock_.now();
  for (bool awake = link_.has_left_over(); !awake;) {
    asm volatile("cpsid i" ::: "memory");
    awake = wakes_;
    if (!awake) wait_for_interrupt();
    asm volatile("cpsie i" ::: "memory");
  }
  wakes_ = false;
  system_.add_slept(clock_.now() - begin);
}

}  // namespace rosflight::boards::stm32h7
