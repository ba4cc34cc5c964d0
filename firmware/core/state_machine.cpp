// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/state_machine.hpp"

namespace rosflight::core {
namespace {

/// First row of each state and event, or the table's end, so that a pass need not search the table.
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
    case Condition::kNotReady:
      return !request.ready;
    case Condition::kCalibrationWanted:
      return request.calibrate_gyro;
    case Condition::kSaveWanted:
      return request.save;
    case Condition::kErrorFlag:
      return error_;
    case Condition::kCannotFly:
      return has(Error::kInvalidMixer) || has(Error::kImuNotResponding) || has(Error::kRcLost);
  }
  return false;
}

Actions StateMachine::handle(Event event, const ArmRequest& request) {
  for (std::size_t k = kIndex.first[slot(state_, event)]; k < kTransitions.size(); ++k) {
    const Transition& row = kTransitions[k];
    if (row.state != state_ || row.event != event) break;
    if (holds(row.condition, request)) return apply(row);
  }
  return action::kNone;
}

Actions StateMachine::apply(const Transition& row) {
  const State before = state_;
  if ((row.actions & action::kArm) != 0) armed_ = true;
  if ((row.actions & action::kDisarm) != 0) armed_ = false;
  if ((row.actions & action::kFailsafeOn) != 0) failsafe_ = true;
  if ((row.actions & action::kFailsafeOff) != 0) failsafe_ = false;
  if ((row.actions & action::kErrorOn) != 0) error_ = true;
  if ((row.actions & action::kErrorOff) != 0) error_ = false;
  state_ = row.next;
  constexpr Actions kOwn = action::kFailsafeOn | action::kFailsafeOff | action::kErrorOn |
                           action::kErrorOff | action::kSetRcLost | action::kClearRcLost;
  Actions result = row.actions & ~kOwn;
  if (state_ != before) result |= action::kSendStatus;
  if ((row.actions & action::kSetRcLost) != 0) result |= set_error(Error::kRcLost);
  if ((row.actions & action::kClearRcLost) != 0) result |= clear_error(Error::kRcLost);
  return result;
}

Actions StateMachine::set_error(Error error) {
  const std::uint16_t before = errors_;
  errors_ |= static_cast<std::uint16_t>(error);
  const Actions changed = errors_ != before ? action::kSendStatus : action::kNone;
  return handle(Event::kError) | changed;
}

Actions StateMachine::clear_error(Error error) {
  if (!has(error)) return action::kNone;
  errors_ &= static_cast<std::uint16_t>(~static_cast<std::uint16_t>(error));
  return update() | action::kSendStatus;
}

}  // namespace rosflight::core
