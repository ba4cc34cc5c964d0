// SPDX-License-Identifier: BSD-3-Clause
// The link at every rate of the line: what a wire of baud/10 bytes per second brings across.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/firmware.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::core {
namespace {

/// Sends exactly baud/10 bytes per second out of a queue of a few hundred bytes.
class Wire final : public hal::Serial {
 public:
  Wire(std::size_t capacity, bool takes_rates) : capacity_{capacity}, takes_rates_{takes_rates} {}
  bool open(std::uint32_t baud, std::uint8_t /*device*/) override {
    baud_ = baud;
    return takes_rates_;
  }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) override {
    if (size > writable()) {
      ++dropped;
      return false;
    }
    queue_.insert(queue_.end(), data, data + size);
    return true;
  }
  std::size_t writable() const override { return capacity_ - queue_.size(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t count = std::min(capacity, incoming_.size());
    std::copy_n(incoming_.begin(), count, data);
    incoming_.erase(incoming_.begin(), incoming_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  void put(const link::Frame& frame) {
    incoming_.insert(incoming_.end(), frame.bytes.begin(),
                     frame.bytes.begin() + static_cast<std::ptrdiff_t>(frame.size));
  }
  /// What left the queue by `now`.
  std::vector<std::uint8_t> carry(hal::Time now) {
    const auto due = static_cast<std::uint64_t>(now.count()) * (baud_ / 10) / 1'000'000;
    std::vector<std::uint8_t> bytes;
    for (; carried_ < due; ++carried_) {
      if (queue_.empty()) continue;  // an idle wire
      bytes.push_back(queue_.front());
      queue_.pop_front();
    }
    return bytes;
  }

  std::size_t dropped{0};

 private:
  std::size_t capacity_;
  bool takes_rates_;
  std::uint32_t baud_{0};
  std::uint64_t carried_{0};
  std::deque<std::uint8_t> queue_;
  std::deque<std::uint8_t> incoming_;
};

/// A whole vehicle with every sensor at its rate, and a companion at the other end of the wire.
class Vehicle {
 public:
  /// @param pass_us  period of the IMU
  Vehicle(std::int32_t baud, std::size_t queue, bool takes_rates = true,
          std::int64_t pass_us = 2500)
      : wire{queue, takes_rates}, pass_us_{pass_us}, firmware_(board_.roles(wire), fcu_) {
    Parameters p;
    static_cast<void>(p.set_int(Param::kBaudRate, baud));
    static_cast<void>(ParameterStore(board_.storage).save(p));
    firmware_.start();
  }

  void run_for(std::int64_t ms) {
    for (const std::int64_t end = us_ + ms * 1000; us_ < end;) pass();
  }
  void send(const link::Message& message) {
    link::Frame frame;
    ASSERT_TRUE(companion_.encode(message, frame));
    wire.put(frame);
  }
  template <class M>
  std::size_t count() const {
    const auto found = counts_.find(link::Message(std::in_place_type<M>).index());
    return found == counts_.end() ? 0 : found->second;
  }
  void forget() { counts_.clear(); }

  Wire wire;
  std::set<std::uint16_t> listed;
  std::vector<link::ParamValue> values;
  std::vector<std::int64_t> imu_us;

  const Firmware& firmware() const { return firmware_; }

 private:
  bool every(std::int64_t hz) const {
    const std::int64_t period = 1'000'000 / hz;
    return us_ / period != (us_ - pass_us_) / period;
  }
  void pass() {
    us_ += pass_us_;
    const hal::Time now = hal::microseconds(us_);
    board_.clock.set(now);
    const float wobble = 0.001f * static_cast<float>(us_ / pass_us_ % 7);
    board_.imu.put({now, {wobble, 0.0f, -9.8f}, {wobble, 0.0f, 0.0f}, 300.0f});
    if (every(100)) board_.mag.put({now, {2e-5f, 0.0f, 4e-5f}});
    if (every(50)) board_.baro.put({now, 101'325.0f, 290.0f});
    if (every(100)) board_.diff_pressure.put({now, 10.0f, 290.0f});
    if (every(50)) board_.range.put({now, 1.0f, 0.1f, 40.0f, hal::RangeKind::kLidar});
    if (every(10)) {
      hal::GnssSample fix;
      fix.stamp = now;
      board_.gnss.put(fix);
      board_.battery.put({now, 12.0f, 1.0f});
      send(link::TimeSync{0, us_ * 1000});
    }
    if (every(50)) {
      hal::RcFrame frame;
      frame.stamp = now;
      frame.channel_count = 8;
      frame.channels.fill(0.5f);
      board_.receiver.put(frame);
    }
    if (every(1)) send(link::Heartbeat{});
    firmware_.run();
    if (boards::aids_waiting(board_)) firmware_.run();
    const auto bytes = wire.carry(now);
    for (std::size_t used = 0; used < bytes.size();) {
      const auto step = companion_.decode(bytes.data() + used, bytes.size() - used);
      used += step.consumed;
      if (step.complete) take(companion_.message());
    }
  }
  void take(const link::Message& message) {
    ++counts_[message.index()];
    if (std::holds_alternative<link::Imu>(message)) imu_us.push_back(us_);
    if (const auto* value = std::get_if<link::ParamValue>(&message)) {
      listed.insert(value->index);
      values.push_back(*value);
    }
  }

  std::int64_t pass_us_;
  boards::SimulatedBoard board_;
  link::MavlinkCodec fcu_{{1, link::MavlinkCodec::kFcuComponent}};
  link::MavlinkCodec companion_{{1, link::MavlinkCodec::kCompanionComponent}};
  Firmware firmware_;
  std::map<std::size_t, std::size_t> counts_;
  std::int64_t us_{0};
};

class Line : public testing::TestWithParam<std::tuple<std::int32_t, std::size_t>> {
 protected:
  std::int32_t baud() const { return std::get<0>(GetParam()); }
  Vehicle vehicle_{std::get<0>(GetParam()), std::get<1>(GetParam())};
};

TEST_P(Line, CarriesHeartbeatAndStatusAndSomeOfEveryStream) {
  vehicle_.run_for(3000);
  vehicle_.forget();
  vehicle_.run_for(30'000);
  EXPECT_EQ(vehicle_.wire.dropped, 0u);
  EXPECT_EQ(vehicle_.count<link::Heartbeat>(), 30u);
  EXPECT_GE(vehicle_.count<link::TimeSync>(), 299u);
  EXPECT_GE(vehicle_.count<link::Status>(), baud() < 20'000 ? 59u : 299u);
  EXPECT_GT(vehicle_.count<link::Imu>(), 30u);
  EXPECT_GT(vehicle_.count<link::Attitude>(), 30u);
  EXPECT_GT(vehicle_.count<link::OutputRaw>(), 5u);
  EXPECT_GT(vehicle_.count<link::RcChannels>(), 5u);
  EXPECT_GT(vehicle_.count<link::Mag>(), 10u);
  EXPECT_GT(vehicle_.count<link::Baro>(), 5u);
  EXPECT_GT(vehicle_.count<link::DiffPressure>(), 10u);
  EXPECT_GT(vehicle_.count<link::Range>(), 5u);
  EXPECT_GE(vehicle_.count<link::Gnss>(), 1u);
  EXPECT_GE(vehicle_.count<link::BatteryStatus>(), 1u);
  if (baud() == 921'600) {
    EXPECT_GE(vehicle_.count<link::Imu>(), 11'999u);
    EXPECT_GE(vehicle_.count<link::Gnss>(), 299u);
  }
}

TEST_P(Line, DecimatesEveryStreamAlikeAndEvenly) {
  vehicle_.run_for(3000);
  vehicle_.forget();
  vehicle_.imu_us.clear();
  vehicle_.run_for(30'000);
  const double n = 12'000.0 / static_cast<double>(vehicle_.count<link::Imu>());
  EXPECT_NEAR(n, vehicle_.firmware().telemetry().decimation(), 0.1 * n);
  EXPECT_NEAR(12'000.0 / n, static_cast<double>(vehicle_.count<link::Attitude>()),
              0.02 * 12'000 / n);
  EXPECT_NEAR(3000.0 / n, static_cast<double>(vehicle_.count<link::Mag>()), 2.0 + 0.02 * 3000 / n);
  EXPECT_NEAR(1500.0 / n, static_cast<double>(vehicle_.count<link::RcChannels>()),
              2.0 + 0.02 * 1500 / n);
  std::int64_t longest = 0;
  for (std::size_t k = 1; k < vehicle_.imu_us.size(); ++k) {
    longest = std::max(longest, vehicle_.imu_us[k] - vehicle_.imu_us[k - 1]);
  }
  // The wire itself delays a frame behind what is queued before it.
  const double queued_us = 512.0 / (static_cast<double>(baud()) / 10.0) * 1e6;
  EXPECT_LT(static_cast<double>(longest), 2500.0 * n * 1.25 + queued_us + 2500.0);
}

TEST_P(Line, BringsTheWholeListOfParametersInBoundedTimeAndAllElseBeside) {
  vehicle_.run_for(3000);
  vehicle_.forget();
  vehicle_.send(link::ParamRequestList{});
  std::int64_t s = 0;
  while (vehicle_.listed.size() < kParamCount && s < 60) {
    vehicle_.run_for(1000);
    ++s;
  }
  EXPECT_EQ(vehicle_.listed.size(), kParamCount);
  const std::int64_t limit_s = baud() < 20'000 ? 60 : baud() < 100'000 ? 15 : 6;
  EXPECT_LE(s, limit_s);
  EXPECT_EQ(vehicle_.wire.dropped, 0u);
  EXPECT_GE(vehicle_.count<link::Heartbeat>(), static_cast<std::size_t>(s - 1));
  EXPECT_GT(vehicle_.count<link::Imu>(), 0u);
  RecordProperty("seconds", static_cast<int>(s));
  RecordProperty("every", static_cast<int>(vehicle_.firmware().telemetry().decimation()));
}

TEST_P(Line, AnswersCommandsAndParametersInAStormOfThem) {
  vehicle_.run_for(3000);
  vehicle_.forget();
  vehicle_.values.clear();
  for (int n = 0; n < 60; ++n) {
    link::ParamSet set;
    set.name = padded_name("RC_MAX_ROLL");
    const float value = 0.5f + 0.001f * static_cast<float>(n);
    std::memcpy(&set.value.bits, &value, sizeof value);
    set.type = 9;
    vehicle_.send(set);
  }
  for (int n = 0; n < 5; ++n) {
    vehicle_.send(link::CommandRequest{static_cast<std::uint8_t>(link::Command::kSendVersion)});
    vehicle_.run_for(2000);
  }
  EXPECT_EQ(vehicle_.wire.dropped, 0u);
  EXPECT_EQ(vehicle_.count<link::CommandAck>(), 5u);
  EXPECT_EQ(vehicle_.count<link::Version>(), 5u);
  float last = 0.0f;
  for (const link::ParamValue& value : vehicle_.values) {
    if (value.index == static_cast<std::uint16_t>(Param::kRcMaxRoll)) {
      std::memcpy(&last, &value.value.bits, sizeof last);
    }
  }
  EXPECT_FLOAT_EQ(last, 0.559f);
}

INSTANTIATE_TEST_SUITE_P(
    Rates, Line,
    testing::Combine(testing::Values(9600, 57'600, 115'200, 230'400, 460'800, 921'600),
                     testing::Values(std::size_t{512}, std::size_t{1024}, std::size_t{2048})),
    [](const auto& of) {
      return std::to_string(std::get<0>(of.param)) + "Queue" +
             std::to_string(std::get<1>(of.param));
    });

TEST(LineOfAnotherRate, ABoardThatUsesItsOwnRateGetsEverySample) {
  Vehicle vehicle(9600, std::size_t{1} << 20U, false);
  vehicle.run_for(1000);
  EXPECT_EQ(vehicle.firmware().telemetry().decimation(), 1u);
}

/// A gyro of 1 kHz at the default rate of the line offers more than it carries, of which 11 kB/s do not follow it.
TEST(LineOfAFastImu, ThinsOutWhatFollowsTheImuAlone) {
  Vehicle vehicle(921'600, 2048, true, 1000);
  vehicle.run_for(3000);  // the first second is not measured yet
  vehicle.forget();
  vehicle.wire.dropped = 0;
  vehicle.run_for(30'000);
  EXPECT_EQ(vehicle.wire.dropped, 0u);
  EXPECT_EQ(vehicle.firmware().telemetry().decimation(), 2u);
  EXPECT_NEAR(static_cast<double>(vehicle.count<link::Imu>()), 15'000.0, 2.0);
  EXPECT_NEAR(static_cast<double>(vehicle.count<link::Attitude>()), 15'000.0, 2.0);
  EXPECT_GE(vehicle.count<link::Gnss>(), 299u);
  EXPECT_GE(vehicle.count<link::Mag>(), 2998u);
  EXPECT_GE(vehicle.count<link::DiffPressure>(), 2998u);
  EXPECT_GE(vehicle.count<link::Baro>(), 1499u);
  EXPECT_GE(vehicle.count<link::Range>(), 1499u);
}

TEST(LineOfAnotherRate, TheFirstSecondFitsToo) {
  Vehicle vehicle(57'600, 512);
  vehicle.run_for(1000);
  EXPECT_EQ(vehicle.wire.dropped, 0u);
  EXPECT_GT(vehicle.count<link::Imu>(), 20u);
}

}  // namespace
}  // namespace rosflight::core
