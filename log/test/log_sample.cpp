// SPDX-License-Identifier: BSD-3-Clause
// Writes a log with one message of every kind, all fields different, for test_log_reads_back.py to
// compare.
//   log_sample FILE [none|zstd] [REPEAT]     REPEAT > 0 adds that many truth steps of 2.5 ms.
#include <bit>
#include <cstdlib>
#include <iostream>
#include <string>

#include "log/flight_log.hpp"

namespace {

using rosflight::hal::Time;
using rosflight::log::Bytes;
using rosflight::log::Direction;
using rosflight::log::FlightLog;
namespace link = rosflight::link;
namespace sim = rosflight::sim;

constexpr Direction kUp = Direction::kCompanionToFcu;
constexpr Direction kDown = Direction::kFcuToCompanion;

template <std::size_t kLength>
std::array<char, kLength> text(std::string_view words) {
  std::array<char, kLength> out{};
  words.copy(out.data(), kLength);
  return out;
}

/// first, first + step, ...
template <class T, std::size_t kCount>
std::array<T, kCount> ramp(T first, T step) {
  std::array<T, kCount> out{};
  for (std::size_t k = 0; k < kCount; ++k)
    out[k] = static_cast<T>(first + static_cast<T>(k) * step);
  return out;
}

/// Messages from the flight control unit, 1 ms apart from 1.000 s on.
void write_fcu_messages(FlightLog& log) {
  std::int64_t ms = 1000;
  const auto put = [&](const link::Message& message) {
    log.write_link(kDown, rosflight::hal::milliseconds(ms++), message, {});
  };
  put(link::Imu{900'001, {1.5F, -2.5F, -9.75F}, {0.125F, -0.25F, 0.375F}, 300.15F});
  put(link::Attitude{902, {0.5F, -0.5F, 0.5F, 0.5F}, {0.01F, 0.02F, 0.03F}});
  put(link::Imu{903'003, {0.5F, 0.25F, -9.5F}, {-0.125F, 0.5F, 0.0625F}, 301.15F});
  put(link::Heartbeat{link::VehicleType::kMultirotor});
  put(link::TimeSync{123'456'789'012, -5});
  put(link::ParamValue{
      text<16>("RC_ATT_OVRD_CHN_"), {0xFFFFFFFEU}, link::ParamType::kInt32, 333, 332});
  put(link::ParamValue{text<16>("PID_ROLL_RATE_P"),
                       {std::bit_cast<std::uint32_t>(0.07F)},
                       link::ParamType::kFloat,
                       333,
                       17});
  put(link::CommandAck{6, true});
  put(link::Mag{{2.5e-5F, -1.25e-5F, 4.5e-5F}});
  put(link::Baro{123.5F, 99'876.5F, 299.25F});
  put(link::DiffPressure{-3.5F, -7.5F, 298.5F});
  put(link::Range{0, 1.25F, 8.0F, 0.25F});
  put(link::Range{1, 11.5F, 40.0F, 0.125F});
  put(link::RcChannels{1013, ramp<std::uint16_t, link::kRcChannels>(1000, 25), 18, 200});
  put(link::OutputRaw{1014, ramp<float, link::kOutputs>(-0.5F, 0.125F)});
  put(link::Status{true, false, true, 0x0241, 0x24, 2, -3, 245});
  put(link::Version{text<link::kTextLength>("v2.0.1-3-gabc")});
  put(link::HardError{0x1234, 0x0800'1234, 3, 1});
  put(link::Gnss{1'767'225'612,
                 345'678'901,
                 3,
                 14,
                 40.267'123'456'789,
                 -111.635'987'654'321,
                 1387.5F,
                 {1.5F, -2.25F, 0.75F},
                 0.5F,
                 0.875F,
                 0.0625F,
                 1'018'500});
  put(link::BatteryStatus{14.75F, 21.5F});
  put(link::StatusText{link::Severity::kWarning, text<link::kTextLength>("RC lost \xC3\xA4 \xFF")});
  put(link::StatusText{link::Severity::kCritical, text<link::kTextLength>("Hard fault")});
  put(link::CheckResult{3, 9, 2, text<link::kCheckNameLength>("gyro still"),
                        text<link::kTextLength>("0.21 rad/s")});
  put(link::Counters{310, 2500, 2, 400'000, 5, 6, 7, ramp<std::uint32_t, link::kCounterBins>(10, 1),
                     ramp<std::uint32_t, link::kCounterBins>(30, 2)});
}

/// Messages to the flight control unit, 1 ms apart from 2.000 s on.
void write_companion_messages(FlightLog& log) {
  std::int64_t ms = 2000;
  const auto put = [&](const link::Message& message) {
    log.write_link(kUp, rosflight::hal::milliseconds(ms++), message, {});
  };
  put(link::Heartbeat{});
  put(link::TimeSync{0, 987'654'321});
  put(link::ParamRequestRead{7, -1, text<16>("FILT_GYRO")});
  put(link::ParamRequestList{9});
  put(link::ParamSet{1, text<16>("ARM_THRESHOLD"), {std::bit_cast<std::uint32_t>(0.15F)}, 9});
  put(link::ParamSet{1, text<16>("BAD_TYPE"), {77}, 3});
  put(link::OffboardControl{2, 0x3C1, ramp<float, link::kCommandAxes>(-1.0F, 0.25F)});
  put(link::AuxCommand{ramp<std::uint8_t, link::kOutputs>(0, 1),
                       ramp<float, link::kOutputs>(1.0F, -0.125F)});
  put(link::ExternalAttitude{{0.75F, 0.125F, -0.25F, 0.5F}});
  put(link::CommandRequest{10});
  put(link::MotorTest{1, 3, 0.25F});
  put(link::ReportRequest{1, 1});
}

sim::Truth truth_at(Time time) {
  sim::Truth truth;
  truth.time = time;
  truth.body.p_W = {1.5, -2.5, -10.25};
  truth.body.q_WB =
      sim::Quaternion(0.5, 0.5, 0.5, 0.5);  // Down is along body y: gravity adds to y.
  truth.body.v_B = {3.5, 0.25, -0.125};
  truth.body.w_B = {0.1, 0.2, 0.3};
  truth.specific_force_B = {0.5, -1.5, -9.0};
  truth.angular_acceleration_B = {4.5, 5.5, 6.5};
  truth.air = {1.1875, 98'765.25, 287.5, {2.0, -1.0, 0.5}};
  truth.wrench = {{10.5, 20.5, -30.5}, {0.5, 0.25, -0.125}};
  truth.on_ground = false;
  truth.battery_voltage_V = 15.25;
  truth.battery_current_A = 33.5;
  truth.rotor_count = 4;
  truth.rotor_speed_rad_s = ramp<double, sim::kMaxRotors>(400.0, 10.5);
  return truth;
}

/// Every kind of input, at 3.005 s and 3.0075 s.
void write_inputs(FlightLog& log) {
  using rosflight::hal::microseconds;
  const Time now = microseconds(3'005'000);
  sim::SensorSamples s;
  s.has_imu = s.has_mag = s.has_baro = s.has_diff_pressure = s.has_range = s.has_gnss =
      s.has_battery = true;
  s.imu = {now, {1.5F, 2.5F, 3.5F}, {4.5F, 5.5F, 6.5F}, 7.5F};
  s.mag = {now - microseconds(100), {8.5F, 9.5F, 10.5F}, 11.5F};
  s.baro = {now, 12.5F, 13.5F};
  s.diff_pressure = {now, 14.5F, 15.5F};
  s.range = {now - microseconds(20'000), 16.5F, 17.5F, 18.5F, rosflight::hal::RangeKind::kLidar};
  s.gnss = {now - microseconds(150'000),
            1'767'225'612,
            345'678'901,
            rosflight::hal::GnssFix::k3d,
            14,
            40.267123456789,
            -111.635987654321,
            19.5F,
            {20.5F, 21.5F, 22.5F},
            23.5F,
            24.5F,
            25.5F};
  s.battery = {now, 26.5F, 27.5F};
  rosflight::hal::RcFrame frame;
  frame.stamp = now - microseconds(7);
  frame.channel_count = 3;
  frame.channels = {0.25F, 0.5F, 0.75F};
  frame.failsafe = true;
  log.write_inputs(now, s, &frame);
  log.write_inputs(now, sim::SensorSamples{}, nullptr);
  constexpr std::array<std::uint8_t, 3> kRead{0xFE, 0x00, 0xFF};
  log.write_inputs(now + microseconds(2500), kRead);
}

void write_others(FlightLog& log) {
  using rosflight::hal::seconds;
  const auto at = [](std::int64_t ms) { return rosflight::hal::milliseconds(ms); };
  constexpr std::array<std::uint8_t, 5> kFrame{0xFE, 0x00, 0x7F, 0x80, 0xFF};
  log.write_link(kUp, at(2500), {}, kFrame);
  log.write_link(kDown, at(2549), {}, Bytes(kFrame).first(2));
  log.write_link(kUp, at(2550), {}, Bytes(kFrame).last(1));
  auto outputs = ramp<float, rosflight::hal::kOutputs>(-0.125F, 0.125F);
  log.write_truth(truth_at(at(3000)), outputs);
  log.write_setpoint(at(3001), {{},
                                {1.5F, 2.5F, -3.5F},
                                {0.5F, 0.25F, 0.125F},
                                {-0.5F, -0.25F, 9.5F},
                                1.25F,
                                -0.75F,
                                0.625F});
  log.write_phase(at(3002), "climb");
  rosflight::messages::rosflight_log_msgs::Estimate estimate;
  estimate.position = {1.5F, -2.5F, -10.5F};
  estimate.velocity = {0.5F, 0.25F, -0.125F};
  estimate.attitude = {0.5F, -0.5F, 0.5F, 0.5F};
  estimate.gyro_bias = {0.01F, 0.02F, 0.03F};
  estimate.accel_bias = {0.1F, 0.2F, 0.3F};
  estimate.wind = {4.5F, -3.5F};
  estimate.airspeed = 15.5F;
  estimate.course = -1.25F;
  estimate.position_sigma = {0.375F, 0.5F, 0.625F};
  estimate.velocity_sigma = {0.0625F, 0.03125F, 0.015625F};
  estimate.attitude_sigma = {0.004F, 0.005F, 0.006F};
  estimate.wind_sigma = {0.75F, 0.875F};
  estimate.innovation = ramp<float, 9>(0.25F, 0.5F);
  estimate.refusing = {false, true, false, false, true, false, false, false, true};
  log.write_estimate(at(3002), estimate);
  log.write_event(at(3003), link::Severity::kError, "autonomy",
                  "Waypoint 3 \"north\" not reached <&>");
  log.write_parameter(at(3004), "BATT_VOLT_MAX", link::ParamType::kFloat,
                      {std::bit_cast<std::uint32_t>(23.5F)});
  constexpr std::array<std::array<double, 3>, 2> kPath{{{1.5, 2.5, -3.5}, {4.5, 5.5, -6.5}}};
  log.write_description(at(3004), "<robot/>");
  log.write_settings(at(3004), "type: multirotor\n");
  write_inputs(log);
  log.write_path(at(3004), kPath);
}

int run(const std::string& path, bool zstd, std::int64_t repeat) {
  FlightLog::Options options;
  options.detail = rosflight::log::Detail::kFull;
  using rosflight::log::Compression;
  options.mcap.compression = zstd ? Compression::kZstd : Compression::kNone;
  FlightLog log(path, options, {{"vehicle", "quadrotor"}, {"seed", "42"}});
  log.attach("vehicle.yaml", "application/yaml", "mass_kg: 3.5  # \xC3\xA4\n");
  write_fcu_messages(log);
  write_companion_messages(log);
  write_others(log);
  for (std::int64_t k = 0; k < repeat; ++k) {
    log.write_truth(truth_at(rosflight::hal::microseconds(4'000'000 + 2500 * k)), {});
  }
  log.add_metadata("parameters", {{"BATT_VOLT_MAX", "23.5"}, {"RC_ATT_OVRD_CHN", "5"}});
  const rosflight::log::LogSummary summary = log.close();
  std::cout << summary.path.string() << ' ' << summary.sha256 << ' ' << summary.messages << ' '
            << summary.bytes << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: log_sample FILE [none|zstd] [REPEAT]\n";
    return 2;
  }
  try {
    return run(argv[1], argc > 2 && std::string(argv[2]) == "zstd",
               argc > 3 ? std::atoll(argv[3]) : 0);
  } catch (const rosflight::log::LogError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
