// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/state_machine.hpp"

namespace rosflight::core {
namespace {

/// First row of each state and event, or the table's end: saves walking the table on every pass.
struct RowIndex {
  std::array<std::uint8_t, kStateCount * kEventCount> first{};
};

constexpr std::size_t slot(State state, Event event) {
  return static_cast<std::size_t>(state) * kEventCount + static_cast<std::size_t>(event);
}

constexpr RowIndex make_index() {
  RowIndex index;
  for (auto& row : index.first) row = kTransitions.size();
  for (std::size_t k = kTransitions.size(); k-- > 0;) {
    index.first[slot(kTransitions[k].state, kTransitions[k].event)] = static_cast<std::uint8_t>(k);
  }
  return index;
}

constexpr RowIndex kIndex = make_index();

}  // namespace

bool StateMachine::holds(Condition condition, const ArmRequest& request) const {
  switch (condition) {
    case Condition::kAlways:
      return true;
    case Condition::kThrottleHigh:
      return !request.throttle_low;
    case Condition::kOverrideOff:
      return !request.override_ok;
    case Condition::kCalibrationWanted:
      return request.calibrate_gyro;
    case Condition::kErrorFlag:
      return error_;
  }
  return false;
}

std::uint16_t StateMachine::handle(Event event, const ArmRequest& request) {
  for (std::size_t k = kIndex.first[slot(state_, event)]; k < kTransitions.size(); ++k) {
    const Transition& row = kTransitions[k];
    if (row.state != state_ || row.event != event) break;
    if (holds(row.condition, request)) return apply(row);
  }
  return action::kNone;
}

std::uint16_t StateMachine::apply(const Transition& row) {
  const State before = state_;
  if ((row.actions & action::kArm) != 0) armed_ = true;
  if ((row.actions & action::kDisarm) != 0) armed_ = false;
  if ((row.actions & action::kFailsafeOn) != 0) failsafe_ = true;
  if ((row.actions & action::kFailsafeOff) != 0) failsafe_ = false;
  if ((row.actions & action::kErrorOn) != 0) error_ = true;
  if ((row.actions & action::kErrorOff) != 0) error_ = false;
  state_ = row.next;
  constexpr std::uint16_t kForOwner = action::kArm | action::kDisarm | action::kCalibrateGyro |
                                      action::kRefuseThrottle | action::kRefuseOverride |
                                      action::kRefuseErrors;
  auto result = static_cast<std::uint16_t>(row.actions & kForOwner);
  if (state_ != before) result |= action::kSendStatus;
  if ((row.actions & action::kSetRcLost) != 0) result |= set_error(Error::kRcLost);
  if ((row.actions & action::kClearRcLost) != 0) result |= clear_error(Error::kRcLost);
  return result;
}

std::uint16_t StateMachine::set_error(Error error) {
  const std::uint16_t before = errors_;
  errors_ |= static_cast<std::uint16_t>(error);
  const std::uint16_t changed = errors_ != before ? action::kSendStatus : action::kNone;
  return static_cast<std::uint16_t>(handle(Event::kError) | changed);
}

std::uint16_t StateMachine::clear_error(Error error) {
  if (!has(error)) return action::kNone;
  errors_ &= static_cast<std::uint16_t>(~static_cast<std::uint16_t>(error));
  return static_cast<std::uint16_t>(update() | action::kSendStatus);
}

std::uint16_t StateMachine::update() {
  // The flag follows the word in every state that the table reaches, so equal means nothing to do.
  if ((errors_ != 0) == error_) return action::kNone;
  return handle(errors_ != 0 ? Event::kError : Event::kNoError);
}

}  // namespace rosflight::core
