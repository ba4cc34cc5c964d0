// SPDX-License-Identifier: BSD-3-Clause
#include "companion/session.hpp"

#include <algorithm>

#include "companion/version.hpp"

namespace rosflight::companion {

namespace {

using namespace std::chrono_literals;

constexpr Time kRatePeriod = 1s;
constexpr Time kFirstVersionRetry = 1s;
constexpr Time kMaxVersionRetry = 10s;

// Next time of a periodic action: in rhythm, but without making up for what was missed.
Time next_time(Time due, Time period, Time now) {
  return due + period > now ? due + period : now + period;
}

}  // namespace

Session::Session(link::Codec& codec, Transport& transport, const Options& options)
    : options_(options),
      codec_(codec),
      transport_(transport),
      connection_(options.connection_timeout),
      time_sync_(options.time_sync_rule),
      parameters_(options.parameters, *this),
      commands_(options.commands, *this, parameters_),
      offboard_(*this) {}

Session::~Session() {
  listeners_.clear();
}

void Session::step(Time now) {
  now_ = std::max(now_, now);
  if (transport_.connected() != link_open_) {
    watch_link();
  }
  receive();
  if (now_ >= next_due_) {
    run_timers();
  }
}

void Session::receive() {
  for (;;) {
    const std::size_t size = transport_.read(buffer_.data(), buffer_.size());
    if (size == 0) {
      return;
    }
    statistics_.bytes_received += size;
    for (std::size_t used = 0; used < size;) {
      const link::Codec::Decoded decoded = codec_.decode(buffer_.data() + used, size - used);
      used += decoded.consumed;
      if (decoded.complete) {
        dispatch(codec_.message());
      } else if (decoded.consumed == 0) {
        break;  // a codec always eats; never hang on one that does not
      }
    }
    watch_schema();
  }
}

void Session::watch_schema() {
  const link::Codec::SchemaMismatch* const mismatch = codec_.mismatch();
  if (mismatch == nullptr) {
    refused_schema_.reset();
  } else if (refused_schema_ != mismatch->theirs) {
    refused_schema_ = mismatch->theirs;
    publish(SchemaEvent{mismatch->ours, mismatch->theirs});
  }
}

bool Session::send(const link::Message& message, std::uint8_t qos) {
  if (refused() && !std::holds_alternative<link::Heartbeat>(message)) {
    ++statistics_.send_failures;
    return false;
  }
  if (!link_open_ || !codec_.encode(message, frame_) ||
      !transport_.write(frame_.bytes.data(), frame_.size, qos)) {
    ++statistics_.send_failures;
    return false;
  }
  statistics_.bytes_sent += frame_.size;
  notify([&](Listener& l) { l.on_sent(message, now_); });
  return true;
}

void Session::publish(const Event& event) {
  notify([&](Listener& l) { l.on_event(event); });
}

void Session::watch_link() {
  link_open_ = transport_.connected();
  if (link_open_) {
    publish(ConnectionEvent{ConnectionChange::kLinkOpened, now_});
    heartbeat_.due = sync_.due = version_request_.due = now_;
    version_retry_ = kFirstVersionRetry;
    parameters_.link_opened();
  } else {
    publish(ConnectionEvent{ConnectionChange::kLinkClosed, now_});
    if (connection_.close()) {
      publish(ConnectionEvent{ConnectionChange::kLost, now_});
      commands_.connection_lost();
    }
  }
  wake();
}

void Session::fcu_clock(Time fcu) {
  if (connection_.fcu_clock(fcu)) {
    restarted();
  }
}

void Session::restarted() {
  ++statistics_.restarts;
  time_sync_.reset();
  streams_.forget_clock();
  sync_.due = version_request_.due = heartbeat_.due = now_;
  version_retry_ = kFirstVersionRetry;
  version_ = {};
  version_match_ = VersionMatch::kUnreadable;
  publish(ConnectionEvent{ConnectionChange::kRestarted, now_});
  parameters_.fcu_restarted();
  commands_.fcu_restarted();
  wake();
}

void Session::run_timers() {
  next_due_ = kNever;
  if (connection_.expired(now_)) {
    publish(ConnectionEvent{ConnectionChange::kLost, now_});
    commands_.connection_lost();
  }
  if (rates_.expired(now_)) {
    const double dt_s = to_seconds(kRatePeriod + now_ - rates_.due);
    const LinkStatistics& s = statistics_;
    statistics_.receive_rate_bytes_s =
        static_cast<double>(s.bytes_received - bytes_received_before_) / dt_s;
    statistics_.send_rate_bytes_s = static_cast<double>(s.bytes_sent - bytes_sent_before_) / dt_s;
    bytes_received_before_ = s.bytes_received;
    bytes_sent_before_ = s.bytes_sent;
    streams_.update_rates(now_);
    rates_.due = now_ + kRatePeriod;
  }
  if (link_open_) {
    if (heartbeat_.expired(now_)) {
      send(link::Heartbeat{});
      heartbeat_.due = next_time(heartbeat_.due, options_.heartbeat_period, now_);
    }
    if (sync_.expired(now_) && options_.time_sync_period > Time{}) {
      send(time_sync_.request(now_), kTimely);
      sync_.due = next_time(sync_.due, options_.time_sync_period, now_);
    }
    if (version_request_.expired(now_)) {
      const bool sent =
          send(link::CommandRequest{static_cast<std::uint8_t>(link::Command::kSendVersion)});
      version_request_.due = now_ + (sent ? version_retry_ : kQueueFull);
      version_retry_ = sent ? std::min(version_retry_ * 2, kMaxVersionRetry) : version_retry_;
    }
    offboard_.run();
  }
  parameters_.run(link_open_);
  commands_.run(link_open_);

  // next_due_ is zero now if a client was given something new by a callback.
  next_due_ = std::min({next_due_, rates_.due, connection_.next_due(), commands_.next_due(),
                        parameters_.next_due(link_open_)});
  if (link_open_) {
    const Time sync_due = options_.time_sync_period > Time{} ? sync_.due : kNever;
    next_due_ =
        std::min({next_due_, heartbeat_.due, sync_due, version_request_.due, offboard_.next_due()});
  }
}

const LinkStatistics& Session::statistics() {
  statistics_.frames = codec_.counters();
  return statistics_;
}

void Session::copy_state_of(const Session& other) {
  options_ = other.options_;
  now_ = other.now_;
  next_due_ = other.next_due_;
  link_open_ = other.link_open_;
  refused_schema_ = other.refused_schema_;
  heartbeat_ = other.heartbeat_;
  sync_ = other.sync_;
  version_request_ = other.version_request_;
  rates_ = other.rates_;
  version_retry_ = other.version_retry_;
  bytes_received_before_ = other.bytes_received_before_;
  bytes_sent_before_ = other.bytes_sent_before_;
  connection_ = other.connection_;
  time_sync_ = other.time_sync_;
  streams_ = other.streams_;
  parameters_.copy_state_of(other.parameters_);
  commands_.copy_state_of(other.commands_);
  offboard_.copy_state_of(other.offboard_);
  version_ = other.version_;
  version_match_ = other.version_match_;
  statistics_ = other.statistics_;
}

}  // namespace rosflight::companion
