// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/firmware.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::core {

inline link::ParamName param_name(const std::string& name) {
  link::ParamName padded{};
  std::memcpy(padded.data(), name.data(), std::min(name.size(), padded.size()));
  return padded;
}
inline std::string to_string(const link::ParamName& name) {
  return {name.data(), strnlen(name.data(), name.size())};
}
inline std::uint32_t bits_of(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// A whole firmware on the simulated board, at rest and level, with a pilot's receiver and a
/// companion that speaks MAVLink bytes. Passes are 2.5 ms apart, an IMU sample in each.
class FirmwareRig {
 public:
  static constexpr std::int64_t kPass_us = 2500;
  static constexpr std::int64_t kRcPeriod_us = 20'000;

  /// What the companion got, with the sender's identity.
  struct Received {
    link::Message message;
    std::uint8_t system_id, component_id;
    Time at;
  };

  FirmwareRig() : firmware_(board.roles(serial), fcu_codec_) {
    rc.channel_count = 8;
    rc.channels.fill(0.5f);
    rc.channels[kThrottle] = 0.0f;
    for (std::size_t k = 4; k < rc.channels.size(); ++k) rc.channels[k] = 0.0f;
  }

  // ---- before start()

  void store(const std::function<void(Parameters&)>& change) {
    Parameters p;
    ParameterStore nvm(board.storage);
    ParameterStore::LoadReport report;
    static_cast<void>(nvm.load(p, report));
    change(p);
    ASSERT_EQ(nvm.save(p), StoreResult::kOk);
  }
  /// A quadrotor X that may arm: mixer, failsafe throttle, a bias so that the IMU counts as
  /// calibrated.
  void store_quadrotor() {
    store([](Parameters& p) {
      ASSERT_EQ(p.set_int(Param::kPrimaryMixer, 2), SetResult::kChanged);
      ASSERT_EQ(p.set_float(Param::kFailsafeThr, 0.4f), SetResult::kChanged);
      ASSERT_EQ(p.set_float(Param::kAccXBias, 1e-6f), SetResult::kChanged);
      ASSERT_EQ(p.set_float(Param::kGyroXBias, 1e-6f), SetResult::kChanged);
    });
  }
  void store_airplane() {
    store([](Parameters& p) {
      ASSERT_EQ(p.set_int(Param::kPrimaryMixer, 9), SetResult::kChanged);
      ASSERT_EQ(p.set_int(Param::kFixedWing, 1), SetResult::kChanged);
      ASSERT_EQ(p.set_int(Param::kRcFAxis, 0), SetResult::kChanged);
      ASSERT_EQ(p.set_float(Param::kAccXBias, 1e-6f), SetResult::kChanged);
    });
  }
  void set_time(Time now) {
    now_ = now;
    board.clock.set(now);
  }
  void start() { firmware_.start(); }

  // ---- running

  void pass() {
    now_ += hal::microseconds(kPass_us);
    board.clock.set(now_);
    imu_offset += imu_drift;
    if (imu_on) board.imu.put(imu_at(now_));
    if (rc_on && now_ >= next_rc_) {
      next_rc_ = now_ + hal::microseconds(kRcPeriod_us);
      rc.stamp = now_;
      board.receiver.put(rc);
    }
    if (companion_on && now_ >= next_beat_) {
      next_beat_ = now_ + hal::milliseconds(1000);
      send(link::Heartbeat{});
    }
    if (offboard) send(*offboard);
    firmware_.run();
    if (boards::aids_waiting(board)) firmware_.run();
    collect();
  }
  void run_for(std::int64_t ms) {
    const Time end = now_ + hal::milliseconds(ms);
    while (now_ < end) pass();
  }
  /// @returns how long it took until `done`, or -1 if that did not come.
  std::int64_t ms_until(const std::function<bool()>& done, std::int64_t limit_ms) {
    const Time begin = now_;
    while (now_ - begin < hal::milliseconds(limit_ms)) {
      pass();
      if (done()) return hal::to_ms(now_ - begin);
    }
    return -1;
  }
  /// At rest but for the last bit of one number, as no real sensor repeats itself.
  hal::ImuSample imu_at(Time t) const {
    hal::ImuSample sample{t + imu_offset, accel_m_s2, gyro_rad_s, 298.15f};
    const bool odd = t.count() / kPass_us % 2 != 0;
    if (dither && odd) sample.accel_m_s2[2] = std::nextafter(accel_m_s2[2], 0.0f);
    return sample;
  }

  void send(const link::Message& message) {
    link::Frame frame;
    ASSERT_TRUE(companion_codec_.encode(message, frame));
    serial.put(frame.bytes.data(), frame.size);
  }
  void set_param(const std::string& name, std::int32_t value) {
    send(link::ParamSet{1, param_name(name), {static_cast<std::uint32_t>(value)}, 6});
  }
  void set_param(const std::string& name, float value) {
    send(link::ParamSet{1, param_name(name), {bits_of(value)}, 9});
  }
  void command(link::Command c) { send(link::CommandRequest{static_cast<std::uint8_t>(c)}); }

  // ---- pilot

  static constexpr std::size_t kRoll = 0, kPitch = 1, kThrottle = 2, kYaw = 3;

  void hold_arming_corner() {
    rc.channels[kThrottle] = 0.0f;
    rc.channels[kYaw] = 1.0f;
  }
  void release() { rc.channels[kYaw] = 0.5f; }
  bool armed() const { return firmware_.state().armed(); }
  /// Settles, arms by sticks, centres them and waits for the override to end.
  void arm() {
    run_for(100);
    hold_arming_corner();
    ASSERT_GE(ms_until([this] { return armed(); }, 1500), 0)
        << "word 0x" << std::hex << firmware_.state().errors();
    release();
    run_for(1100);
    inbox.clear();
  }

  // ---- what came back

  template <class M>
  std::vector<M> got() const {
    std::vector<M> found;
    for (const Received& r : inbox) {
      if (const auto* m = std::get_if<M>(&r.message)) found.push_back(*m);
    }
    return found;
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> lines;
    for (const auto& t : got<link::StatusText>()) lines.emplace_back(t.text.data());
    return lines;
  }
  std::size_t count_text(const std::string& text) const {
    std::size_t n = 0;
    for (const auto& line : texts()) n += line == text ? 1u : 0u;
    return n;
  }
  bool said(const std::string& text) const { return count_text(text) > 0; }
  std::vector<link::ParamValue> values_of(const std::string& name) const {
    std::vector<link::ParamValue> found;
    for (const auto& v : got<link::ParamValue>()) {
      if (to_string(v.name) == name) found.push_back(v);
    }
    return found;
  }
  const Firmware& firmware() const { return firmware_; }
  Firmware& firmware() { return firmware_; }
  std::uint16_t errors() const { return firmware_.state().errors(); }
  const hal::OutputValues& outputs() const { return board.outputs.values(); }
  Time now() const { return now_; }

  boards::SimulatedBoard board;
  boards::MemorySerial serial{16384};
  hal::RcFrame rc;
  hal::Vec3 accel_m_s2{0.0f, 0.0f, -9.80665f};
  hal::Vec3 gyro_rad_s{1e-6f, 0.0f, 0.0f};
  Time imu_offset{};  ///< Offset of the stamps.
  Time imu_drift{};   ///< Drift of the stamps per pass.
  bool dither{true};
  bool imu_on{true};
  bool rc_on{true};
  bool companion_on{true};
  std::optional<link::OffboardControl> offboard;
  std::vector<Received> inbox;

 private:
  void collect() {
    const auto bytes = serial.take_sent();
    // The codec hides identities; take them from the frames, whose sizes the decoder reports.
    for (std::size_t used = 0; used < bytes.size();) {
      const auto result = companion_codec_.decode(bytes.data() + used, bytes.size() - used);
      if (result.complete) {
        inbox.push_back({companion_codec_.message(), bytes[used + 3], bytes[used + 4], now_});
      }
      used += result.consumed;
    }
  }

  link::MavlinkCodec fcu_codec_{{1, link::MavlinkCodec::kFcuComponent}};
  link::MavlinkCodec companion_codec_{{1, link::MavlinkCodec::kCompanionComponent}};
  Firmware firmware_;
  Time now_{};
  Time next_rc_{};
  Time next_beat_{};
};

}  // namespace rosflight::core
