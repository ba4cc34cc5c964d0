// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/common_hardware.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.hpp"
#include "firmware/boards/stm32h7/emulator/receiver_frames.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr parts::UartFormat kSbus{100'000, true, 2, true}, kCrsf{420'000, false, 1, false};
constexpr unsigned kUsbFunction = 10;

PinSignal signal_of(const TimerModel& timer, std::size_t channel) {
  const auto seconds = [](Ticks ticks) { return static_cast<double>(ticks) / kTicksPerSecond; };
  PinSignal out;
  out.count_s = seconds(timer.tick());
  out.period_s = seconds(timer.period());
  if (!timer.makes_dshot()) out.high_s = seconds(timer.pulse(channel));
  out.dshot_frames = timer.dshot_frames(channel);
  out.dshot_high = timer.dshot_high(channel);
  return out;
}

}  // namespace

CommonHardware::CommonHardware(Wiring wiring)
    : chip_{wiring.crystal_Hz},
      wiring_{std::move(wiring)},
      gnss_on_wire_{chip_.processor, chip_.*wiring_.gnss.uart, gnss_} {
  chip_.processor.add(gnss_on_wire_);
  chip_.processor.add(usb_host_);
  connect_serial();
  chip_.tim1.on_change = [this] { note_output(); };
  chip_.adc1.pin_V = [this](unsigned channel) { return battery_pin_V(channel); };
  gnss_.pulse = [this](bool high, hal::Time /*when*/) {
    chip_.port(wiring_.pulse_per_second).drive(wiring_.pulse_per_second.number, high);
  };
}

void CommonHardware::expect_pins(std::initializer_list<PinName> pins, unsigned function) {
  for (const PinName& each : pins) chip_.port(each).expect_alternate(each.number, function);
}

void CommonHardware::connect_serial() {
  (chip_.*wiring_.link.uart).on_byte = [this](std::uint8_t byte, std::uint32_t baud) {
    if (far_end_reads(baud)) {
      sent_.push_back(byte);
    } else {
      ++link_garbled_;
    }
  };
  usb_host_.on_data = [this](const UsbModel::Packet& packet) {
    sent_.insert(sent_.end(), packet.begin(), packet.end());
  };
  chip_.usb.on_attach = [this] { expect_pins({pin('A', 11), pin('A', 12)}, kUsbFunction); };
  for (const SerialPins& each : {wiring_.link, wiring_.gnss}) {
    (chip_.*each.uart).on_enable = [this, each] {
      expect_pins({each.receive, each.transmit}, each.function);
    };
  }
  (chip_.*wiring_.receiver.uart).on_enable = [this] {
    expect_pins({wiring_.receiver.receive}, wiring_.receiver.function);
  };
}

/// Whether the far end of the link, with its own rate, reads what is sent at this one.
bool CommonHardware::far_end_reads(std::uint32_t baud) const {
  constexpr double kTolerance = 0.03;
  return link_baud_ == 0 || std::abs(static_cast<double>(baud) / link_baud_ - 1.0) <= kTolerance;
}

/// The world's last solution before that time, moved on with its velocity.
parts::models::GnssTruth CommonHardware::gnss_truth(hal::Time when) const {
  const hal::GnssSample& s = gnss_samples_.at(when).former.sample;
  const double dt_s = 1e-6 * static_cast<double>((when - s.stamp).count());
  constexpr double kMetresPerDegree = 111'319.49;  // of latitude, and of longitude at the equator
  const double north_m_s = static_cast<double>(s.velocity_ned_m_s[0]);
  const double east_m_s = static_cast<double>(s.velocity_ned_m_s[1]);
  parts::models::GnssTruth truth;
  truth.latitude_deg = s.latitude_deg + north_m_s * dt_s / kMetresPerDegree;
  truth.longitude_deg = s.longitude_deg + east_m_s * dt_s / kMetresPerDegree /
                                              std::cos(s.latitude_deg * base::kRadPerDeg);
  truth.height_msl_m =
      static_cast<double>(s.height_msl_m) - static_cast<double>(s.velocity_ned_m_s[2]) * dt_s;
  for (std::size_t k = 0; k < 3; ++k)
    truth.velocity_ned_m_s[k] = static_cast<double>(s.velocity_ned_m_s[k]);
  truth.fix = static_cast<int>(s.fix);
  truth.satellites = s.satellites;
  truth.horizontal_accuracy_m = static_cast<double>(s.horizontal_accuracy_m);
  truth.vertical_accuracy_m = static_cast<double>(s.vertical_accuracy_m);
  truth.speed_accuracy_m_s = static_cast<double>(s.speed_accuracy_m_s);
  return truth;
}

void CommonHardware::data_ready(bool high) {
  if (imu_is_silent_ || chip_.processor.now() < edges_lost_until_) return;
  if (high) {
    note_output_latency();
    edge_ = chip_.processor.now();
    edges_[edge_count_++ % edges_.size()] = edge_;
  }
  chip_.port(wiring_.imu_ready).drive(wiring_.imu_ready.number, high);
}

/// Latency of the edge before: an output was written between it and now.
void CommonHardware::note_output_latency() {
  const Ticks written = chip_.tim1.written(0);
  if (edge_ != 0 && written > edge_) latency_ = std::max(latency_, written - edge_);
}

/// The first output is written: the samples of the last transfer have become commands.
void CommonHardware::note_output() {
  const Ticks written = chip_.tim1.written(0), ended = (chip_.*wiring_.imu_bus).ended();
  if (written == judged_ || ended < edge_) return;
  judged_ = written;
  computing_ = std::max(computing_, written - ended);
}

/// Which samples it is of shows the write of the outputs that were computed from them: the newest data-ready edge
/// before that write is the edge of the last of them. Neither the stamp nor its nearness to some edge decides that, so
/// a stamp of the sample before is wrong by a whole period. Judged when the stamp is new: then the newest write and the
/// stamp are of the same pass.
double CommonHardware::stamp_error_us(std::int64_t stamp_us) {
  if (stamp_us == judged_stamp_us_ || !chip_.tim5.counts()) return stamp_error_us_;
  judged_stamp_us_ = stamp_us;
  const std::size_t averaged = wiring_.imu_samples_per_output;
  const std::size_t kept = std::min(edge_count_, edges_.size());
  const auto edge = [this](std::size_t back) {
    return edges_[(edge_count_ - 1 - back) % edges_.size()];
  };
  std::size_t last = 0;
  while (last < kept && edge(last) >= chip_.tim1.written(0)) ++last;
  if (last + averaged > kept) return stamp_error_us_ = 0.0;
  double sum_us = 0.0;
  for (std::size_t k = 0; k < averaged; ++k) {
    const auto on_clock = static_cast<double>(edge(last + k) - chip_.tim5.zero());
    sum_us += on_clock / kTicksPerMicrosecond - imu_delay_us();
  }
  stamp_error_us_ = static_cast<double>(stamp_us) - sum_us / static_cast<double>(averaged);
  return stamp_error_us_;
}

parts::models::ImuTruth CommonHardware::imu_truth(hal::Time when) const {
  const auto place = imu_truths_.at(when);
  const parts::models::ImuTruth& former = place.former.sample;
  const parts::models::ImuTruth& later = place.later.sample;
  parts::models::ImuTruth truth = former;
  for (std::size_t k = 0; k < 3; ++k) {
    truth.accel_m_s2[k] += place.share * (later.accel_m_s2[k] - former.accel_m_s2[k]);
    truth.gyro_rad_s[k] += place.share * (later.gyro_rad_s[k] - former.gyro_rad_s[k]);
  }
  return truth;
}

void CommonHardware::power_on() {
  const hal::Time now = part_time(chip_.processor.now());
  const auto renew = [now](parts::models::Part& part) {
    part.advance(now);
    part.set_power(false);
    part.set_power(true);
  };
  for (const parts::models::Part* const part : parts())
    renew(const_cast<parts::models::Part&>(*part));
  renew(gnss_);
  advance_parts();
  gnss_on_wire_.advance();
  sent_.clear();
  latency_ = computing_ = edge_ = 0;
  edge_count_ = 0;
}

void CommonHardware::expose(const ToChip& world) {
  advance_parts();
  imu_is_silent_ = world.has_imu == 0;
  chip_.temperature_degC = world.chip_degC;
  const std::int64_t now_us = world.time_us;
  const bool no_baro = baro_presence_.lost(world.has_baro != 0, now_us);
  const bool no_pitot = pitot_presence_.lost(world.has_diff_pressure != 0, now_us);
  set_broken({no_baro || is_mute(FaultyPart::kBaro), mag_presence_.lost(world.has_mag != 0, now_us),
              no_pitot || is_mute(FaultyPart::kPitot), is_mute(FaultyPart::kMag), i2c_is_stuck_});
  const bool no_gnss = gnss_presence_.lost(world.has_gnss != 0, now_us);
  gnss_on_wire_.set_mute(no_gnss || is_mute(FaultyPart::kGnss));
  take_samples(world);
  if (world.has_rc != 0) send_receiver_frame(world);
  usb_host_.plug(world.usb_plugged != 0);
  link_baud_ = world.link_baud;
  if (world.usb_plugged != 0) {
    usb_host_.send(world.link.data(), world.link_count);
  } else if (world.link_count > 0) {
    parts::UartFormat format;
    format.baud = world.link_baud;
    (chip_.*wiring_.link.uart).feed(world.link.data(), world.link_count, format);
  }
}

void CommonHardware::send_receiver_frame(const ToChip& world) {
  UartModel& uart = chip_.*wiring_.receiver.uart;
  if (world.receiver_is_crsf != 0) {
    const parts::models::Bytes frames = crsf_frames(world.rc);
    return uart.feed(frames.data(), frames.size(), kCrsf);
  }
  const SbusFrame frame = sbus_frame(world.rc);
  uart.feed(frame.data(), frame.size(), kSbus);
}

/// Behind the divider and the amplifier of the power module.
double CommonHardware::battery_pin_V(unsigned channel) const {
  const BatteryWiring& w = wiring_.battery;
  if (channel == w.voltage_channel) return battery_V_ / w.volts_per_volt;
  return channel == w.current_channel ? w.offset_V + battery_A_ / w.amperes_per_volt : 0.0;
}

void CommonHardware::take_samples(const ToChip& world) {
  const auto copy = [](const hal::Vec3& from, std::array<double, 3>& to) {
    std::copy(from.begin(), from.end(), to.begin());
  };
  if (world.has_imu != 0) {
    parts::models::ImuTruth truth;
    copy(world.imu.accel_m_s2, truth.accel_m_s2);
    copy(world.imu.gyro_rad_s, truth.gyro_rad_s);
    truth.temperature_K = static_cast<double>(world.imu.temperature_K);
    imu_truths_.put(hal::Time{world.time_us}, truth);
  }
  if (world.has_battery != 0) {
    battery_V_ = static_cast<double>(world.battery.voltage_V);
    battery_A_ = static_cast<double>(world.battery.current_A);
  }
  if (world.has_mag != 0) {
    copy(world.mag.field_T, mag_truth_.field_T);
    mag_truth_.temperature_K = static_cast<double>(world.mag.temperature_K);
  }
  if (world.has_baro != 0) {
    baro_truth_ = {static_cast<double>(world.baro.pressure_Pa),
                   static_cast<double>(world.baro.temperature_K)};
  }
  if (world.has_diff_pressure != 0) {
    pitot_truth_ = {static_cast<double>(world.diff_pressure.pressure_Pa),
                    static_cast<double>(world.diff_pressure.temperature_K)};
  }
  if (world.has_gnss != 0) {
    gnss_samples_.put(world.gnss.stamp, world.gnss);
    constexpr std::int64_t kPerSecond = 1'000'000;
    gnss_.epoch =
        world.gnss.stamp - hal::Time{world.gnss.unix_s * kPerSecond + world.gnss.unix_ns / 1000};
  }
}

void CommonHardware::report(FromChip& out) {
  constexpr float kMinPulse_us = 1000.0F, kSpan_us = 1000.0F;
  out.levels = 0;
  for (std::size_t k = 0; k < wiring_.outputs.size(); ++k) {
    const Output& output = wiring_.outputs[k];
    const TimerModel& timer = chip_.*output.timer;
    const Ticks pulse = timer.pulse(output.channel);
    out.signals[k] = signal_of(timer, output.channel);
    out.outputs[k] = 0.0F;
    if (timer.forces(output.channel)) {
      const bool high = timer.forced_high(output.channel);
      if (high) expect_pins({output.pin}, output.function);
      out.outputs[k] = high ? 1.0F : 0.0F;
      out.levels = static_cast<std::uint16_t>(out.levels | 1U << k);
      continue;
    }
    if (timer.makes_dshot()) {
      constexpr float kStop = 47.0F, kFull = 2047.0F;
      const auto throttle = static_cast<float>(timer.dshot_throttle(output.channel));
      expect_pins({output.pin}, output.function);
      out.outputs[k] = std::max(throttle - kStop, 0.0F) / (kFull - kStop);
      continue;
    }
    if (pulse == 0) continue;
    expect_pins({output.pin}, output.function);
    const float us = static_cast<float>(pulse) / static_cast<float>(kTicksPerMicrosecond);
    out.outputs[k] = std::max((us - kMinPulse_us) / kSpan_us, 0.0F);
  }
  for (std::size_t k = 0; k < wiring_.leds.size(); ++k) {
    const PinName& led = wiring_.leds[k];
    const PinPort& port = chip_.port(led);
    const bool lit = port.is_output(led.number) && port.level(led.number) != wiring_.low_is_lit;
    out.leds[k] = static_cast<std::uint8_t>(lit);
  }
  const std::size_t count = std::min(sent_.size(), out.link.size());
  std::copy_n(sent_.begin(), count, out.link.begin());
  out.link_count = static_cast<std::uint32_t>(count);
  sent_.erase(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(count));
  const UartModel& link = chip_.*wiring_.link.uart;
  out.link_received = link.received();
  out.link_sent = link.sent();
  out.link_lost = link.overruns() + link.line_errors() + link_garbled_;
  out.flash_is_busy = static_cast<std::uint8_t>(chip_.flash.sectors.busy());
  out.torn_words = static_cast<std::uint32_t>(chip_.flash.sectors.torn);
  out.clock_zero_us = chip_.tim5.counts()
                          ? static_cast<std::int64_t>(chip_.tim5.zero() / kTicksPerMicrosecond)
                          : -1;
  out.edge_to_output_us =
      static_cast<std::uint32_t>(std::exchange(latency_, 0) / kTicksPerMicrosecond);
  out.transfer_to_output_us =
      static_cast<std::uint32_t>(std::exchange(computing_, 0) / kTicksPerMicrosecond);
}

std::vector<std::string> CommonHardware::complaints() const {
  std::vector<std::string> all = gnss_.complaints();
  for (const parts::models::Part* const part : parts()) {
    if (std::count(browned_out_.begin(), browned_out_.end(), part) > 0) continue;
    all.insert(all.end(), part->complaints().begin(), part->complaints().end());
  }
  return all;
}

}  // namespace rosflight::boards::stm32h7::emulator
