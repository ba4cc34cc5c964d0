// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_requests.hpp"

#include <algorithm>
#include <utility>

namespace rosflight::companion {

namespace {

constexpr Time kMaxRequestRetry = std::chrono::seconds{1};
// Sets after which only a read was answered, by the old value: an FCU that is silent about what it
// refuses. With 1 % of the bytes lost, one set in 10^6 looks so.
constexpr int kOldRoundsUntilRefused = 8;

std::string number_text(double number) {
  std::string error;
  const auto whole = to_value(number, link::ParamType::kInt32, error);
  const auto real = to_value(number, link::ParamType::kFloat, error);
  return whole ? whole->text() : real ? real->text() : "the wanted value";
}

}  // namespace

void ParameterRequests::read(std::string_view name, Done done) {
  Request request;
  request.done = std::move(done);
  enqueue(name, std::move(request));
}

void ParameterRequests::set(std::string_view name, double wanted,
                            std::optional<link::ParamType> type, Done done) {
  Request request;
  request.is_set = true;
  request.wanted = wanted;
  request.required_type = type;
  request.done = std::move(done);
  enqueue(name, std::move(request));
}

void ParameterRequests::enqueue(std::string_view name, Request request) {
  request.result.name = name;
  request.result.wanted = request.wanted;
  // An impossible name stays all NUL and is found out when its turn comes.
  request.name = make_name(name).value_or(link::ParamName{});
  queue_.push_back(std::move(request));
  due_ = Time{};
  port_.wake();
}

void ParameterRequests::run(bool link_open) {
  const Time now = port_.now();
  if (idle()) {
    due_ = kNever;
    return;
  }
  if (!link_open) {
    closed_since_ = closed_since_.value_or(now);
    due_ = *closed_since_ + options_.closed_link_timeout;
    if (now >= due_) {
      abandon("the link is closed");
    }
    return;
  }
  closed_since_.reset();
  for (Request& request : active_) {
    if (request.ended || now < request.retry_at) {
      continue;
    }
    const bool alive = last_answer_ && *last_answer_ >= request.started;
    if (request.attempts < (alive ? options_.attempts_connected : options_.attempts)) {
      transmit(request);
      continue;
    }
    end(request, ParameterOutcome::kNoAnswer, "no answer");
    if (!alive) {
      sweep();
      abandon("the flight control unit does not answer");
      return;
    }
  }
  sweep();
  activate();
  reschedule();
}

void ParameterRequests::activate() {
  const auto is_active = [this](const link::ParamName& name) {
    return std::any_of(active_.begin(), active_.end(),
                       [&](const Request& r) { return r.name == name; });
  };
  while (!queue_.empty() && active_.size() < options_.window && !is_active(queue_.front().name)) {
    active_.push_back(std::move(queue_.front()));
    queue_.pop_front();
    active_.back().started = port_.now();
    active_.back().retry = options_.retry;
    const bool sent = transmit(active_.back());
    sweep();
    if (!sent) {
      break;  // overtaking would change the order of the sets
    }
  }
}

// Finds the parameter and turns the wanted number into its type. False: not known yet, or the
// request ended.
bool ParameterRequests::resolve(Request& request) {
  if (request.resolved) {
    return true;
  }
  const std::optional<std::size_t> index = table_.find(request.name);
  if (!index) {
    if (table_.complete() || request.name == link::ParamName{}) {
      end(request, ParameterOutcome::kUnknown, "no such parameter");
    }
    return false;
  }
  request.index = *index;
  if (request.is_set) {
    const ParameterValue& present = table_[*index].value;
    request.result.value = present;
    if (request.required_type && *request.required_type != present.type) {
      end(request, ParameterOutcome::kWrongType,
          std::string("given as ") + type_name(*request.required_type) + ", is " +
              type_name(present.type));
      return false;
    }
    std::string error;
    const auto target = to_value(request.wanted, present.type, error);
    if (!target) {
      end(request, ParameterOutcome::kRefused, error);
      return false;
    }
    request.target = *target;
  }
  request.resolved = true;
  return true;
}

bool ParameterRequests::send_read(const Request& request) {
  link::ParamRequestRead message;
  message.target_system = port_.target_system();
  message.index = request.resolved ? static_cast<std::int16_t>(request.index) : std::int16_t{-1};
  message.name = request.name;
  const bool sent = port_.send(message, kOrdinary);
  if (sent && request.resolved) table_.note_read(request.index);
  return sent;
}

bool ParameterRequests::transmit(Request& request) {
  const bool resolved = resolve(request);
  if (request.ended) {
    return true;
  }
  bool sent = false;
  const bool must_set =
      resolved && request.is_set &&
      (request.sets > 0 || !same_value(table_[request.index].value, request.target));
  if (must_set) {
    link::ParamSet message;
    message.target_system = port_.target_system();
    message.name = request.name;
    message.value = request.target.bits;
    message.type = static_cast<std::uint8_t>(request.target.type);
    sent = port_.send(message, kOrdinary);
    request.late = table_[request.index].awaited;
    if (sent && request.sets > 0) {
      send_read(request);
    }
    if (sent) {
      request.before = request.sets == 0 ? table_[request.index].value : request.before;
      ++request.sets;
      request.old_values = 0;
    }
  } else {
    sent = send_read(request);
  }
  if (!sent) {
    request.retry_at = port_.now() + kQueueFull;
    return false;
  }
  request.retry_at = port_.now() + request.retry;
  request.retry = std::min(request.retry * 3 / 2, kMaxRequestRetry);
  ++request.attempts;
  return true;
}

void ParameterRequests::received(const link::ParamName& name, const ParameterValue& value) {
  last_answer_ = port_.now();
  for (Request& request : active_) {
    if (!request.ended && request.name == name) {
      answered(request, value);
    }
  }
  const bool progress =
      std::any_of(active_.begin(), active_.end(), [](const Request& r) { return r.ended; });
  sweep();
  if (progress && !queue_.empty()) {
    due_ = Time{};
    port_.wake();
  }
}

void ParameterRequests::answered(Request& request, const ParameterValue& value) {
  if (!resolve(request)) {
    return;
  }
  request.result.value = value;
  if (!request.is_set) {
    end(request, ParameterOutcome::kRead, "is " + value.text());
  } else if (same_value(value, request.target)) {
    const bool changed = request.sets > 0 && !same_value(request.before, value);
    end(request, changed ? ParameterOutcome::kSet : ParameterOutcome::kUnchanged,
        (changed ? "set to " : "is already ") + value.text());
  } else if (request.sets == 0) {
    transmit(request);
  } else {
    contradicted(request, value);
  }
}

void ParameterRequests::contradicted(Request& request, const ParameterValue& value) {
  if (!same_value(value, request.before)) {
    if (request.other && same_value(value, *request.other)) {
      end(request, ParameterOutcome::kClamped,
          number_text(request.wanted) + " not taken, is now " + value.text());
      return;
    }
    request.other = value;
    send_read(request);
    return;
  }
  if (request.late > 0) {
    --request.late;
    return;
  }
  ++request.old_values;
  request.old_rounds += request.old_values == 1 ? 1 : 0;
  if (request.sets == 1) {
    transmit(request);
    return;
  }
  request.old_pairs += request.old_values == 2 ? 1 : 0;
  const int pairs_wanted = table_.all_fresh() ? 1 : 2;
  if (request.old_pairs >= pairs_wanted || request.old_rounds >= kOldRoundsUntilRefused) {
    refused(request);
  } else if (request.old_values == 2) {
    transmit(request);
  }
}

void ParameterRequests::refused(Request& request) {
  end(request, ParameterOutcome::kRefused,
      number_text(request.wanted) + " refused, stays at " + request.before.text());
}

void ParameterRequests::table_forgotten() {
  for (Request& request : active_) {
    request.resolved = false;
    request.other.reset();
    request.sets = 0;
    request.late = 0;
    request.old_values = 0;
    request.old_pairs = 0;
    request.old_rounds = 0;
    request.attempts = 0;
    request.retry = options_.retry;
    request.retry_at = port_.now() + request.retry;
  }
  reschedule();
}

void ParameterRequests::end(Request& request, ParameterOutcome outcome, const std::string& reason) {
  request.ended = true;
  request.result.outcome = outcome;
  request.result.text = request.result.name + ": " + reason;
}

// Removes ended requests before their callbacks: `done` may start new ones.
void ParameterRequests::sweep() {
  std::vector<Request> ended;
  for (Request& request : active_) {
    if (request.ended) {
      ended.push_back(std::move(request));
    }
  }
  if (ended.empty()) {
    return;
  }
  std::erase_if(active_, [](const Request& r) { return r.ended; });
  for (Request& request : ended) {
    request.done(request.result);
  }
}

void ParameterRequests::abandon(const std::string& reason) {
  for (Request& request : std::exchange(queue_, {})) {
    active_.push_back(std::move(request));
  }
  for (Request& request : active_) {
    end(request, ParameterOutcome::kNoAnswer, reason);
  }
  sweep();
  closed_since_.reset();
  reschedule();
}

void ParameterRequests::reschedule() {
  // A waiting queue needs no time of its own: an ending request of the window makes room for it.
  due_ = active_.empty() && !queue_.empty() ? Time{} : kNever;
  for (const Request& request : active_) {
    due_ = std::min(due_, request.retry_at);
  }
}

void ParameterRequests::copy_state_of(const ParameterRequests& other) {
  last_answer_ = other.last_answer_;
  closed_since_ = other.closed_since_;
  due_ = other.due_;
}

}  // namespace rosflight::companion
