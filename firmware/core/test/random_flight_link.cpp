// SPDX-License-Identifier: BSD-3-Clause
// The part of a random flight that comes over the link.
#include <algorithm>
#include <cstring>
#include <limits>

#include "firmware/core/test/random_flight.hpp"

namespace rosflight::core {
namespace {

constexpr std::uint8_t kOtherSystem = 77;

bool is_one_of(std::size_t k, const std::array<std::size_t, 3>& channels) {
  return std::find(channels.begin(), channels.end(), k) != channels.end();
}

std::uint32_t bits_of_float(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

}  // namespace

void RandomFlight::put(const link::Message& message, bool foreign) {
  inputs_.packets.emplace_back();
  inputs_.packets.back().message = message;
  inputs_.packets.back().foreign = foreign;
}

void RandomFlight::companion() {
  Random& r = random(Ingredient::kCompanion);
  const Time now = inputs_.now;
  if (now >= companion_until_) {
    companion_on_ = !companion_on_ || r.chance(0.5f);
    companion_until_ = companion_on_ ? soon(r, 1000, 6000) : soon(r, 50, 2500);
  }
  if (!companion_on_) return;
  if (now >= next_beat_) {
    next_beat_ = now + hal::milliseconds(500);
    put(link::Heartbeat{});
  }
  if (now >= next_sync_) {
    next_sync_ = now + hal::milliseconds(100);
    put(link::TimeSync{0, now.count() * 1000});
  }
  if (now >= offboard_until_) {
    offboard_on_ = !offboard_on_;
    offboard_until_ = offboard_on_ ? soon(r, 200, 3000) : soon(r, 20, 800);
    constexpr std::array<std::int64_t, 4> kPeriods_us{2500, 10'000, 20'000, 90'000};
    offboard_period_ = hal::microseconds(r.pick(kPeriods_us));
    offboard_.mode = static_cast<std::uint8_t>(r.below(3));
    offboard_.ignore =
        r.chance(0.3f) ? static_cast<std::uint16_t>(r.below(1024)) : std::uint16_t{0};
  }
  if (!offboard_on_ || now < next_offboard_) return;
  next_offboard_ = now + offboard_period_;
  for (float& u : offboard_.u) u = r.uniform(-0.3f, 0.3f);
  offboard_.u[vehicle_ == Vehicle::kFixedWing ? 0 : 2] = r.uniform(0.2f, 0.8f);
  put(offboard_);
  if (r.chance(0.02f)) put(link::ExternalAttitude{{1.0f, 0.0f, 0.0f, r.uniform(-0.1f, 0.1f)}});
}

void RandomFlight::auxiliary() {
  Random& r = random(Ingredient::kAuxiliary);
  if (inputs_.now >= auxiliary_until_) {
    auxiliary_on_ = !auxiliary_on_;
    auxiliary_until_ = auxiliary_on_ ? soon(r, 50, 3000) : soon(r, 100, 3000);
  }
  if (!auxiliary_on_ || inputs_.now < next_auxiliary_) return;
  next_auxiliary_ = soon(r, 20, 300);
  link::AuxCommand c;
  for (std::size_t k = 0; k < c.type.size(); ++k) {
    if (is_one_of(k, kAuxMotors)) c.type[k] = static_cast<std::uint8_t>(link::AuxType::kMotor);
    if (is_one_of(k, kAuxServos)) c.type[k] = static_cast<std::uint8_t>(link::AuxType::kServo);
    if (r.chance(0.1f)) c.type[k] = 0;
    c.value[k] = r.uniform(-0.2f, 1.2f);
  }
  put(c);
}

link::Message RandomFlight::parameter_message(Random& r, bool sane) {
  constexpr std::array<const char*, 12> kTuned{
      "PID_ROLL_RATE_P", "PID_PITCH_ANG_P", "PID_YAW_RATE_P", "RC_MAX_ROLL",
      "PID_ROLL_RATE_I", "X_EQ_TORQUE",     "BATT_VOLT_LPF",  "OFFBOARD_TIMEOUT",
      "RC_OVRD_LAG_T",   "MOTOR_IDLE_THR",  "PRI_MIXER_2_1",  "GYRO_XY_LPF"};
  std::size_t index = r.below(kParamCount);
  if (sane && r.chance(0.8f)) index = Parameters::find(padded_name(r.pick(kTuned)));
  const ParamRow& row = Parameters::row(static_cast<Param>(index));
  link::ParamSet set{
      static_cast<std::uint8_t>(r.below(2)), row.name, {}, static_cast<std::uint8_t>(row.type)};
  if (row.type == ParamType::kInt32) {
    const std::int64_t value =
        sane ? row.initial.i + r.between(0, 3) : static_cast<std::int32_t>(r.next());
    set.value.bits = static_cast<std::uint32_t>(value);
  } else {
    const float near = row.initial.f * r.uniform(0.8f, 1.3f) + r.uniform(0.0f, 0.02f);
    set.value.bits = bits_of_float(sane ? near : hostile_value(r));
  }
  if (!sane && r.chance(0.2f)) set.type = static_cast<std::uint8_t>(r.below(256));
  return set;
}

void RandomFlight::parameters() {
  Random& r = random(Ingredient::kParameters);
  if (storm_ > 0) {
    const int now = std::min<int>(storm_, static_cast<int>(r.below(90)));
    storm_ -= now;
    for (int k = 0; k < now; ++k) {
      if (r.chance(0.5f)) {
        put(link::ParamRequestRead{1, static_cast<std::int16_t>(r.below(kParamCount)), {}});
      } else {
        put(parameter_message(r, true));
      }
    }
    return;
  }
  if (happens(Ingredient::kParameters, hal::milliseconds(400))) put(parameter_message(r, true));
  if (happens(Ingredient::kParameters, hal::milliseconds(4000))) put(link::ParamRequestList{1});
  if (!has(Ingredient::kForeign) && happens(Ingredient::kParameters, hal::milliseconds(5000))) {
    storm_ = static_cast<int>(r.below(400));
  }
}

float RandomFlight::hostile_value(Random& r) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr std::array<float, 14> kValues{std::numeric_limits<float>::quiet_NaN(),
                                          kInf,
                                          -kInf,
                                          3e38f,
                                          -3e38f,
                                          1e20f,
                                          1e6f,
                                          20.0f,
                                          -20.0f,
                                          2.0f,
                                          -2.0f,
                                          1e-40f,
                                          0.0f,
                                          -1.0f};
  return r.pick(kValues);
}

link::Message RandomFlight::hostile_message(Random& r) {
  const auto byte = [&r] { return static_cast<std::uint8_t>(r.below(256)); };
  switch (r.below(12)) {
    case 0: {
      link::OffboardControl c;
      c.mode = r.chance(0.8f) ? static_cast<std::uint8_t>(r.below(3)) : byte();
      c.ignore = r.chance(0.5f) ? std::uint16_t{0} : static_cast<std::uint16_t>(r.next());
      const bool finite = r.chance(0.7f);
      for (float& u : c.u) u = finite ? r.uniform(-30.0f, 30.0f) : hostile_value(r);
      return c;
    }
    case 1: {
      link::AuxCommand c;
      const bool finite = r.chance(0.6f);
      for (std::size_t k = 0; k < c.type.size(); ++k) {
        if (is_one_of(k, kAuxMotors)) c.type[k] = static_cast<std::uint8_t>(link::AuxType::kMotor);
        if (is_one_of(k, kAuxServos)) c.type[k] = static_cast<std::uint8_t>(link::AuxType::kServo);
        if (r.chance(0.01f)) c.type[k] = static_cast<std::uint8_t>(3 + r.below(250));
        c.value[k] = finite ? r.uniform(-5.0f, 5.0f) : hostile_value(r);
      }
      return c;
    }
    case 2: {
      link::ExternalAttitude a;
      for (float& q : a.q_WB) q = r.chance(0.5f) ? r.uniform(-1.0f, 1.0f) : hostile_value(r);
      return a;
    }
    case 3:
      return parameter_message(r, false);
    case 4:
      return link::ParamRequestRead{1, static_cast<std::int16_t>(r.next()), padded_name("NO_SUCH")};
    case 5: {
      auto set = std::get<link::ParamSet>(parameter_message(r, false));
      set.name[r.below(16)] = static_cast<char>(byte());
      return set;
    }
    case 6:
      return link::TimeSync{r.chance(0.5f) ? 0 : static_cast<std::int64_t>(r.next()),
                            static_cast<std::int64_t>(r.next())};
    case 7:
      return link::CommandRequest{static_cast<std::uint8_t>(11 + r.below(245))};
    case 8:
      return link::Heartbeat{};
    case 9: {
      link::ParamValue v;
      v.name = Parameters::row(static_cast<Param>(r.below(kParamCount))).name;
      v.value.bits = static_cast<std::uint32_t>(r.next());
      return v;
    }
    case 10:
      return link::CommandAck{byte(), true};
    default: {
      link::StatusText text;
      for (char& c : text.text) c = static_cast<char>(byte());
      return text;
    }
  }
}

void RandomFlight::hostile() {
  if (happens(Ingredient::kHostile, hal::milliseconds(250))) {
    put(hostile_message(random(Ingredient::kHostile)));
  }
}

void RandomFlight::foreign() {
  Random& r = random(Ingredient::kForeign);
  // One more than these could be put off to the next pass, and others behind it.
  constexpr std::size_t kFew = 6;
  if (inputs_.packets.size() > kFew || !happens(Ingredient::kForeign, hal::milliseconds(60)))
    return;
  link::Message message;
  switch (r.below(6)) {
    case 0: {
      link::ParamRequestRead read{
          kOtherSystem, static_cast<std::int16_t>(r.below(kParamCount)), {}};
      message = read;
      break;
    }
    case 1:
      message = link::ParamRequestList{kOtherSystem};
      break;
    case 2:
      message = link::MotorTest{kOtherSystem, static_cast<std::uint8_t>(r.below(4)), 0.2f};
      break;
    case 3:
      message = link::ReportRequest{kOtherSystem, static_cast<std::uint8_t>(r.below(2))};
      break;
    default: {
      auto set = std::get<link::ParamSet>(parameter_message(r, true));
      set.target_system = kOtherSystem;
      message = set;
      break;
    }
  }
  put(message, true);
}

void RandomFlight::garbage() {
  Random& r = random(Ingredient::kGarbage);
  if (!happens(Ingredient::kGarbage, hal::milliseconds(100))) return;
  // Sometimes more than a pass may read.
  constexpr std::uint32_t kMaxBurst = 60;
  const std::uint32_t count = r.chance(0.05f) ? r.below(kMaxBurst) : 1;
  for (std::uint32_t k = 0; k < count; ++k) {
    inputs_.packets.emplace_back();
    Packet& packet = inputs_.packets.back();
    packet.garbage_size = static_cast<std::uint8_t>(1 + r.below(64));
    for (auto& byte : packet.garbage) byte = static_cast<std::uint8_t>(r.below(256));
    if (r.chance(0.3f)) packet.garbage[0] = 0xFE;
  }
}

void RandomFlight::commands() {
  Random& r = random(Ingredient::kCommands);
  if (!happens(Ingredient::kCommands, hal::milliseconds(1200))) return;
  using link::Command;
  constexpr std::array<Command, 14> kCommands{Command::kRcCalibration,
                                              Command::kAccelCalibration,
                                              Command::kGyroCalibration,
                                              Command::kBaroCalibration,
                                              Command::kAirspeedCalibration,
                                              Command::kReadParams,
                                              Command::kWriteParams,
                                              Command::kSendVersion,
                                              Command::kWriteParams,
                                              Command::kReadParams,
                                              Command::kReboot,
                                              Command::kGyroCalibration,
                                              Command::kWriteParams,
                                              Command::kRebootToBootloader};
  const bool rare = r.chance(0.03f);
  const Command command = rare ? Command::kSetParamDefaults : r.pick(kCommands);
  put(link::CommandRequest{static_cast<std::uint8_t>(command)});
}

void RandomFlight::motor_tests() {
  Random& r = random(Ingredient::kMotorTests);
  const Time now = inputs_.now;
  if (now >= motor_test_until_) {
    if (happens(Ingredient::kMotorTests, hal::milliseconds(3000))) {
      put(link::ReportRequest{static_cast<std::uint8_t>(r.below(2)),
                              static_cast<std::uint8_t>(r.below(3))});
    }
    // Most in the pilot's pauses: refused at any other time.
    const bool pause = phase_ == Phase::kRest || r.chance(0.1f);
    if (!pause || !happens(Ingredient::kMotorTests, hal::milliseconds(500))) return;
    motor_test_until_ = soon(r, 20, 1500);
    motor_test_ = {static_cast<std::uint8_t>(r.below(2)),
                   static_cast<std::uint8_t>(vehicle_ == Vehicle::kFixedWing ? 4 : r.below(4)),
                   r.uniform(0.0f, 0.3f)};
    if (r.chance(0.1f)) motor_test_.value = hostile_value(r);
    if (r.chance(0.1f)) motor_test_.motor = static_cast<std::uint8_t>(r.below(20));
  }
  if (now < next_motor_test_) return;
  next_motor_test_ = soon(r, 20, 250);
  auto message = motor_test_;
  if (r.chance(0.05f)) message.motor = static_cast<std::uint8_t>(r.below(5));
  put(message);
}

}  // namespace rosflight::core
