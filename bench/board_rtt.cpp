// SPDX-License-Identifier: BSD-3-Clause
// Round trips of offboard commands to the image of a board on the emulated STM32H7, in its own time.
//
//     board_rtt BOARD usb|BAUD [--count N] [--csv FILE]
//
// Commands go out at 399.8 Hz, so that their phase to the streams of the board sweeps seven times over it in
// 45 s, and then as fast as each is answered. The
// image is that of the board with an echo (firmware/boards/common/echo_main.hpp). Every sensor of the
// board measures, so that all streams run, the GNSS receiver at 10 Hz, and an S.Bus receiver sends at
// 111 Hz. The time is the emulated chip's, read every 10 us. Prints one JSON object; the CSV has a
// round trip [us] in each line.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "firmware/boards/common/echo_main.hpp"
#include "flight/autopilot/chip_autopilot.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
using boards::EchoCodec;
using boards::stm32h7::ChipOrder;
using boards::stm32h7::ChipProcess;

constexpr std::int64_t kResolution_us = 10, kPeriod_us = 2501, kLost_us = 100'000;
constexpr std::int64_t kGnssPeriod_us = 100'000, kReceiverPeriod_us = 9000;
constexpr std::uint32_t kUsualBaud = 921'600;

ChipProcess::Options echo_image(const std::string& board) {
  ChipProcess::Options options = flight::emulated_chip(board);
  options.image.replace_filename("firmware_" + board + "_echo.elf");
  return options;
}

/// The board, level and at rest, and the companion at the far end of its link.
class Rig {
 public:
  Rig(const std::string& board, bool usb) : chip_{echo_image(board)}, usb_{usb} { chip_.start(); }

  void power_on(std::uint32_t baud) {
    baud_ = baud;
    chip_.to_chip().order = ChipOrder::kPowerOn;
    exchange(now_us_);
    chip_.to_chip().order = ChipOrder::kStep;
  }
  std::int64_t now_us() const { return now_us_; }
  void send(const link::Message& message) {
    link::Frame frame;
    if (!codec_.encode(message, frame)) throw std::runtime_error("a message that has no frame");
    boards::stm32h7::ToChip& order = chip_.to_chip();
    std::copy_n(frame.bytes.begin(), frame.size, order.link.begin() + order.link_count);
    order.link_count += static_cast<std::uint32_t>(frame.size);
  }
  /// @returns the number of the last answer that came until then, 0 if none did.
  std::uint32_t run_until(std::int64_t until_us) {
    exchange(until_us);
    std::uint32_t answer = 0;
    const boards::stm32h7::FromChip& from = chip_.from_chip();
    for (std::size_t at = 0; at < from.link_count;) {
      const auto decoded = codec_.decode(from.link.data() + at, from.link_count - at);
      at += decoded.consumed;
      if (!decoded.complete) continue;
      count(codec_.message());
      const auto* const output = std::get_if<link::OutputRaw>(&codec_.message());
      if (output != nullptr && output->time_boot_ms == 0)
        answer = static_cast<std::uint32_t>(output->values[EchoCodec::kAnswered]);
    }
    received_ += from.link_count;
    return answer;
  }
  void run_for(std::int64_t duration_us) {
    for (const std::int64_t end = now_us_ + duration_us; now_us_ < end;)
      run_until(std::min(end, now_us_ + kPeriod_us));
  }
  std::uint64_t received() const { return received_; }
  /// Messages of the streams that depend on what is connected to the board, since it was built.
  struct Streams {
    std::size_t gnss{}, receiver{}, battery{};
  };
  const Streams& streams() const { return streams_; }
  /// Time not slept, by the count of instructions.
  std::uint64_t busy_us() { return chip_.from_chip().busy_us; }

 private:
  void count(const link::Message& message) {
    if (std::holds_alternative<link::Gnss>(message)) ++streams_.gnss;
    if (std::holds_alternative<link::RcChannels>(message)) ++streams_.receiver;
    if (std::holds_alternative<link::BatteryStatus>(message)) ++streams_.battery;
  }
  void exchange(std::int64_t until_us) {
    boards::stm32h7::ToChip& order = chip_.to_chip();
    order.time_us = now_us_;
    order.until_us = until_us;
    order.usb_plugged = static_cast<std::uint8_t>(usb_);
    order.link_baud = baud_;
    order.has_imu = order.has_baro = order.has_mag = order.has_diff_pressure = 1;
    order.imu.accel_m_s2 = {0.0F, 0.0F, -static_cast<float>(base::kStandardGravity_m_s2)};
    order.imu.temperature_K = 300.0F;
    order.baro.pressure_Pa = 101'325.0F;
    order.baro.temperature_K = 300.0F;
    order.diff_pressure.temperature_K = 300.0F;
    order.mag.field_T = {2e-5F, 0.0F, 4e-5F};
    order.has_battery = 1;
    order.battery.voltage_V = 15.2F;
    order.battery.current_A = 12.0F;
    order.has_rc = is_due(next_receiver_us_, kReceiverPeriod_us);
    order.rc.channel_count = 16;
    order.rc.channels = {0.5F, 0.5F, 0.0F, 0.5F};
    order.has_gnss = is_due(next_gnss_us_, kGnssPeriod_us);
    if (order.has_gnss != 0) order.gnss = solution();
    chip_.exchange();
    order.link_count = 0;
    now_us_ = until_us;
  }
  /// Whether something comes now that comes in each period.
  std::uint8_t is_due(std::int64_t& next_us, std::int64_t period_us) const {
    if (now_us_ < next_us) return 0;
    next_us += period_us;
    return 1;
  }
  hal::GnssSample solution() const {
    constexpr std::int64_t kSecond_us = 1'000'000;
    hal::GnssSample sample;
    sample.stamp = hal::Time{now_us_};
    sample.unix_s = 1'700'000'000 + now_us_ / kSecond_us;
    sample.unix_ns = static_cast<std::int32_t>(now_us_ % kSecond_us * 1000);
    sample.fix = hal::GnssFix::k3d;
    sample.satellites = 14;
    sample.latitude_deg = 40.25;
    sample.longitude_deg = -111.65;
    sample.height_msl_m = 1400.0F;
    sample.horizontal_accuracy_m = sample.vertical_accuracy_m = 1.0F;
    sample.speed_accuracy_m_s = 0.2F;
    return sample;
  }

  ChipProcess chip_;
  bool usb_;
  std::uint32_t baud_{kUsualBaud};
  std::int64_t now_us_{0}, next_receiver_us_{0}, next_gnss_us_{0};
  std::uint64_t received_{0};
  Streams streams_;
  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kCompanionComponent}};
};

/// Lets the board use another rate from its next start on.
void store_baud(Rig& rig, std::uint32_t baud) {
  link::ParamSet set;
  const std::string name = "BAUD_RATE";
  std::copy(name.begin(), name.end(), set.name.begin());
  set.value.bits = baud;
  set.type = static_cast<std::uint8_t>(link::ParamType::kInt32);
  rig.send(set);
  rig.run_for(500'000);
  rig.send(link::CommandRequest{static_cast<std::uint8_t>(link::Command::kWriteParams)});
  rig.run_for(1'000'000);
  rig.power_on(baud);
}

/// One command and its answer. @returns the round trip, nothing if it was lost.
std::optional<std::int64_t> round_trip(Rig& rig, std::uint32_t number) {
  link::OffboardControl command;
  command.u[EchoCodec::kAsked] = static_cast<float>(number);
  rig.send(command);
  const std::int64_t sent = rig.now_us();
  while (rig.now_us() - sent < kLost_us) {
    if (rig.run_until(rig.now_us() + kResolution_us) == number) return rig.now_us() - sent;
  }
  return std::nullopt;
}

struct Table {
  std::vector<std::int64_t> us;
  std::size_t lost{0};

  void add(const std::optional<std::int64_t>& trip) {
    if (trip) us.push_back(*trip);
    if (!trip) ++lost;
  }
  double ms(double share) {
    if (us.empty()) return -1.0;
    std::sort(us.begin(), us.end());
    const auto last = static_cast<double>(us.size() - 1);
    return 1e-3 * static_cast<double>(us[static_cast<std::size_t>(share * last)]);
  }
  double mean_ms() const {
    const double sum = static_cast<double>(std::accumulate(us.begin(), us.end(), std::int64_t{0}));
    return us.empty() ? -1.0 : 1e-3 * sum / static_cast<double>(us.size());
  }
};

int measure(const std::string& board, const std::string& link, std::size_t count,
            const std::string& csv) {
  constexpr std::size_t kFast = 2000;
  const bool usb = link == "usb";
  const auto baud = usb ? kUsualBaud : static_cast<std::uint32_t>(std::stoul(link));
  Rig rig(board, usb);
  rig.power_on(kUsualBaud);
  rig.run_for(2'000'000);
  if (baud != kUsualBaud) {
    store_baud(rig, baud);
    rig.run_for(2'000'000);
  }
  Table steady;
  const std::int64_t begin = rig.now_us();
  const std::uint64_t before = rig.received(), busy_before_us = rig.busy_us();
  const Rig::Streams streams_before = rig.streams();
  for (std::uint32_t k = 1; k <= count; ++k) {
    steady.add(round_trip(rig, k));
    const std::int64_t next = begin + static_cast<std::int64_t>(k) * kPeriod_us;
    if (rig.now_us() < next) rig.run_until(next);
  }
  const double lasted_s = 1e-6 * static_cast<double>(rig.now_us() - begin);
  const double busy_s = 1e-6 * static_cast<double>(rig.busy_us() - busy_before_us);
  const auto per_s = [&](std::size_t Rig::Streams::*stream) {
    return static_cast<double>(rig.streams().*stream - streams_before.*stream) / lasted_s;
  };
  const double gnss_hz = per_s(&Rig::Streams::gnss), receiver_hz = per_s(&Rig::Streams::receiver);
  const double battery_hz = per_s(&Rig::Streams::battery);
  const double sent_per_s = static_cast<double>(rig.received() - before) / lasted_s;
  if (!csv.empty()) {
    std::FILE* const file = std::fopen(csv.c_str(), "w");
    if (file == nullptr) throw std::runtime_error(csv + ": cannot be written");
    for (const std::int64_t us : steady.us)
      std::fprintf(file, "%lld\n", static_cast<long long>(us));
    std::fclose(file);
  }
  Table fast;
  const std::int64_t fast_begin = rig.now_us();
  for (std::uint32_t k = 0; k < kFast; ++k)
    fast.add(round_trip(rig, static_cast<std::uint32_t>(count) + 1 + k));
  const double fast_s = 1e-6 * static_cast<double>(rig.now_us() - fast_begin);
  std::cout << nlohmann::ordered_json{{"board", board},
                                      {"link", link},
                                      {"commands", count},
                                      {"lost", steady.lost + fast.lost},
                                      {"mean_ms", steady.mean_ms()},
                                      {"median_ms", steady.ms(0.5)},
                                      {"p999_ms", steady.ms(0.999)},
                                      {"max_ms", steady.ms(1.0)},
                                      {"streams_bytes_per_s", sent_per_s},
                                      {"gnss_hz", gnss_hz},
                                      {"receiver_hz", receiver_hz},
                                      {"battery_hz", battery_hz},
                                      {"idle_fraction", 1.0 - busy_s / lasted_s},
                                      {"fastest_hz", static_cast<double>(fast.us.size()) / fast_s}}
                   .dump()
            << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    std::size_t count = 18'000;
    std::string csv;
    for (std::size_t k = 2; k + 1 < words.size(); k += 2) {
      if (words[k] == "--count") count = std::stoul(words[k + 1]);
      if (words[k] == "--csv") csv = words[k + 1];
    }
    if (words.size() < 2 || words.size() % 2 != 0 || count == 0)
      throw std::runtime_error("usage: board_rtt BOARD usb|BAUD [--count N] [--csv FILE]");
    return measure(words[0], words[1], count, csv);
  } catch (const std::exception& error) {
    std::cerr << "board_rtt: " << error.what() << "\n";
    return 1;
  }
}
