// SPDX-License-Identifier: BSD-3-Clause
// The contract suites of sensors, receiver and battery on a board itself. The far end exposes the board to a sample; its
// parts measure that at their own time.
#include <algorithm>

#include "firmware/boards/stm32h7/test/far_end.hpp"
#include "firmware/hal/test/contract/battery_contract.hpp"
#include "firmware/hal/test/contract/receiver_contract.hpp"
#include "firmware/hal/test/contract/source_contract.hpp"
// PartUnderTest of each kind of sample: what the part of this board makes of it.
#include ROSFLIGHT_PARTS_UNDER_TEST

namespace rosflight::boards::stm32h7 {
namespace {

hal::Time now() {
  return board_under_test().roles.clock.now();
}

template <class Sample>
struct Named;
template <>
struct Named<hal::ImuSample> {
  static constexpr const char* kKind = "show imu";
  static hal::Source<hal::ImuSample>& role() { return board_under_test().roles.imu; }
};
template <>
struct Named<hal::MagSample> {
  static constexpr const char* kKind = "show mag";
  static hal::Source<hal::MagSample>& role() { return board_under_test().roles.mag; }
};
template <>
struct Named<hal::BaroSample> {
  static constexpr const char* kKind = "show baro";
  static hal::Source<hal::BaroSample>& role() { return board_under_test().roles.baro; }
};
template <>
struct Named<hal::DiffPressureSample> {
  static constexpr const char* kKind = "show diff_pressure";
  static hal::Source<hal::DiffPressureSample>& role() {
    return board_under_test().roles.diff_pressure;
  }
};
template <>
struct Named<hal::GnssSample> {
  static constexpr const char* kKind = "show gnss";
  static hal::Source<hal::GnssSample>& role() { return board_under_test().roles.gnss; }
};
template <>
struct Named<hal::BatterySample> {
  static constexpr const char* kKind = "show battery";
  static hal::Battery& role() { return board_under_test().roles.battery; }
};

/// The stamp of a sample that was measured between two times is in their middle, to half of the time between them.
struct Interval {
  hal::Time begin{}, end{};
  hal::Time middle() const { return begin + (end - begin) / 2; }
  hal::Time half() const { return (end - begin + hal::Time{1}) / 2; }
};

/// A part that measures by itself from the start of the sensors on.
template <class S>
struct MeasuringPart {
  using Sample = S;
  using Part = PartUnderTest<S>;

  auto& role() { return Named<S>::role(); }
  void deliver(const S& sample) {
    if (!started_) {
      board_under_test().roles.system.start_sensors();
      sleep_for(Part::kStart);
    }
    started_ = true;
    exposure_ = far_end().show(Named<S>::kKind, &sample, sizeof sample);
    pass(since() + Part::kPeriod + Part::kLatency - now());
  }
  S expected(const S& delivered, hal::Time stamp) const {
    S sample = Part::expected(delivered, stamp - exposure_.valid);
    sample.stamp = Interval{since(), now()}.middle();
    return sample;
  }
  S tolerance() const {
    S sample = Part::tolerance();
    sample.stamp = Interval{since(), now()}.half();
    return sample;
  }
  hal::Time since() const { return exposure_.begin + Part::kSettling; }
  hal::Time period() const { return Part::kPeriod; }
  void pass(hal::Time time) { sleep_for(time); }

 private:
  bool started_{false};
  FarEnd::Exposure exposure_;
};

/// The pins of the battery: the far end is told what a battery is behind them.
struct BatteryPinsUnderTest : MeasuringPart<hal::BatterySample> {
  void deliver(const hal::BatterySample& pins) {
    const FlightBoard::Plan& plan = board_under_test().plan;
    MeasuringPart::deliver({pins.stamp, pins.voltage_V * plan.battery_voltage.scale,
                            pins.current_A * plan.battery_current.scale});
  }
  hal::BatterySample tolerance() const {
    return {MeasuringPart::tolerance().stamp, kPinTolerance_V, kPinTolerance_V};
  }
};

/// S.Bus. Nothing comes unless a frame was sent.
struct ReceiverFrames {
  using Sample = hal::RcFrame;
  hal::Receiver& role() { return board_under_test().roles.receiver; }
  void deliver(const hal::RcFrame& frame) {
    // 25 bytes last 3 ms; the line is then idle for a byte, and silent for the 1 ms that separates frames.
    constexpr hal::Time kFrame = hal::milliseconds(5);
    sent_.begin = far_end().show("frame", &frame, sizeof frame).begin;
    sleep_for(sent_.begin + kFrame - now());
    sent_.end = now();
  }
  /// 16 channels and 8 of two states, of which the third and the fourth are the flags.
  hal::RcFrame expected(const hal::RcFrame& delivered, hal::Time /*stamp*/) const {
    constexpr std::size_t kTwoState = 16;
    hal::RcFrame frame = delivered;
    frame.stamp = sent_.middle();
    frame.channel_count = hal::RcFrame::kMaxChannels;
    std::fill(frame.channels.begin() + kTwoState, frame.channels.end(), 1.0f);
    frame.channels[kTwoState + 2] = delivered.frame_lost ? 0.0f : 1.0f;
    frame.channels[kTwoState + 3] = delivered.failsafe ? 0.0f : 1.0f;
    return frame;
  }
  /// A step of 11 bits is 1/1639; half of it.
  hal::RcFrame tolerance() const {
    hal::RcFrame frame{};
    frame.stamp = sent_.half();
    frame.channels.fill(3.06e-4f);
    return frame;
  }

 private:
  Interval sent_;
};

}  // namespace
}  // namespace rosflight::boards::stm32h7

namespace rosflight::hal::contract {

using boards::stm32h7::BatteryPinsUnderTest;
using boards::stm32h7::MeasuringPart;
using boards::stm32h7::ReceiverFrames;

using Sources =
    ::testing::Types<MeasuringPart<ImuSample>, MeasuringPart<MagSample>, MeasuringPart<BaroSample>,
                     MeasuringPart<DiffPressureSample>, MeasuringPart<GnssSample>,
                     MeasuringPart<BatterySample>, ReceiverFrames>;

INSTANTIATE_TYPED_TEST_SUITE_P(Board, SourceContract, Sources);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, ReceiverContract, ReceiverFrames);
INSTANTIATE_TYPED_TEST_SUITE_P(Board, BatteryContract, BatteryPinsUnderTest);

}  // namespace rosflight::hal::contract
