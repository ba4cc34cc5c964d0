// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_list.hpp"

#include <algorithm>

namespace rosflight::companion {

namespace {
constexpr Time kMaxListRetry = std::chrono::seconds{3};
}  // namespace

void ParameterList::start(Time now) {
  phase_ = Phase::kAsking;
  due_ = now;
}

void ParameterList::received(std::size_t index, bool newly_fresh, Time now) {
  if (phase_ == Phase::kIdle) {
    return;
  }
  if (table_.all_fresh()) {
    phase_ = Phase::kIdle;
    return;
  }
  switch (phase_) {
    case Phase::kAsking:
    case Phase::kFlowing:
      phase_ = Phase::kFlowing;
      due_ = now + options_.stall;
      if (index + 1 == table_.count()) {
        due_ = now;
      }
      break;
    case Phase::kFilling:
      if (newly_fresh) {
        progress_ = true;
        waiting_for_ -= waiting_for_ > 0 ? 1 : 0;
        due_ = waiting_for_ == 0 ? now : due_;
      }
      break;
    case Phase::kIdle:
      break;
  }
}

void ParameterList::run(Port& port) {
  const Time now = port.now();
  if (phase_ == Phase::kIdle || now < due_) {
    return;
  }
  if (phase_ == Phase::kAsking) {
    const bool sent = port.send(link::ParamRequestList{port.target_system()}, kOrdinary);
    counters_.list_requests += sent ? 1 : 0;
    due_ = now + (sent ? options_.ask_period : kQueueFull);
    return;
  }
  if (phase_ == Phase::kFlowing) {
    phase_ = Phase::kFilling;
    retry_ = options_.retry;
    cursor_ = 0;
    progress_ = true;
  }
  ask_for_missing(port);
}

void ParameterList::ask_for_missing(Port& port) {
  retry_ = progress_ ? options_.retry : std::min(retry_ * 2, kMaxListRetry);
  progress_ = false;
  waiting_for_ = 0;
  due_ = port.now() + retry_;
  for (std::size_t looked = 0; looked < 2 && waiting_for_ < options_.window;) {
    const auto missing = table_.next_missing(cursor_);
    if (!missing) {
      cursor_ = 0;
      ++looked;  // at most one round; a short rest is requested once
      if (waiting_for_ > 0) {
        break;
      }
      continue;
    }
    link::ParamRequestRead request;
    request.target_system = port.target_system();
    request.index = static_cast<std::int16_t>(*missing);
    if (!port.send(request, kOrdinary)) {
      due_ = port.now() + kQueueFull;
      progress_ = true;
      return;
    }
    table_.note_read(*missing);
    ++counters_.index_requests;
    ++waiting_for_;
    cursor_ = *missing + 1;
  }
}

void ParameterList::copy_state_of(const ParameterList& other) {
  phase_ = other.phase_;
  due_ = other.due_;
  retry_ = other.retry_;
  waiting_for_ = other.waiting_for_;
  cursor_ = other.cursor_;
  progress_ = other.progress_;
  counters_ = other.counters_;
}

}  // namespace rosflight::companion
