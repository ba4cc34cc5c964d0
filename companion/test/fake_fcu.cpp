// SPDX-License-Identifier: BSD-3-Clause
#include "companion/test/fake_fcu.hpp"

#include <algorithm>
#include <array>

#include "companion/events.hpp"

namespace rosflight::companion::test {

std::vector<FakeFcu::Parameter> numbered_table(std::size_t n) {
  std::vector<FakeFcu::Parameter> table;
  for (std::size_t i = 0; i < n; ++i) {
    std::string number = std::to_string(i);
    number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
    const ParameterValue value = i % 3 == 0 ? ParameterValue::of(static_cast<std::int32_t>(i))
                                            : ParameterValue::of(static_cast<float>(i) / 10.0f);
    table.push_back({"P" + number, value});
  }
  return table;
}

void FakeFcu::step(Time now) {
  now_ = now;
  if (!booted_) {
    booted_ = now;
    next_heartbeat_ = now;
    list_at_.reset();
  }
  std::array<std::uint8_t, 256> buffer{};
  for (std::size_t size = 0; (size = transport_.read(buffer.data(), buffer.size())) > 0;) {
    for (std::size_t used = 0; used < size;) {
      const auto decoded = codec->decode(buffer.data() + used, size - used);
      used += decoded.consumed;
      if (decoded.complete && !silent) {
        handle(codec->message());
      }
    }
  }
  if (!silent) {
    stream();
  }
}

void FakeFcu::stream() {
  if (imu) {
    link::Imu sample;
    sample.time_boot_us = static_cast<std::uint64_t>(boot_clock().count() / 1000);
    send(sample, kUrgent);
    link::Attitude attitude;
    attitude.time_boot_ms = static_cast<std::uint32_t>(boot_clock().count() / 1000000);
    send(attitude);
  }
  if (now_ >= next_heartbeat_) {
    next_heartbeat_ += std::chrono::seconds{1};
    send(link::Heartbeat{link::VehicleType::kMultirotor});
  }
  if (list_at_) {
    send_value(*list_at_);
    list_at_ = *list_at_ + 1 < parameters.size() ? std::optional(*list_at_ + 1) : std::nullopt;
  }
}

void FakeFcu::send(const link::Message& message, std::uint8_t qos) {
  link::Frame frame;
  if (codec->encode(message, frame)) {
    transport_.write(frame.bytes.data(), frame.size, qos);
  }
}

void FakeFcu::send_text(std::string_view text, link::Severity severity) {
  link::StatusText line;
  line.severity = severity;
  copy_text(text, line.text);
  send(line);
}

void FakeFcu::send_value(std::size_t index) {
  const Parameter& p = parameters.at(index);
  link::ParamValue message;
  copy_text(p.name, message.name);
  message.type = p.value.type;
  message.value = p.value.bits;
  message.count = static_cast<std::uint16_t>(parameters.size());
  message.index = static_cast<std::uint16_t>(index);
  send(message);
}

FakeFcu::Parameter* FakeFcu::find(std::string_view name) {
  const auto it = std::find_if(parameters.begin(), parameters.end(),
                               [name](const Parameter& p) { return p.name == name; });
  return it == parameters.end() ? nullptr : &*it;
}

void FakeFcu::set_from_inside(std::string_view name, ParameterValue value) {
  Parameter* const p = find(name);
  p->value = value;
  send_value(static_cast<std::size_t>(p - parameters.data()));
}

void FakeFcu::handle(const link::Message& message) {
  received.push_back(message);
  if (intercept && intercept(message)) {
    return;
  }
  if (std::holds_alternative<link::ParamRequestList>(message)) {
    list_at_ = parameters.empty() ? std::nullopt : std::optional<std::size_t>(0);
  } else if (const auto* read = std::get_if<link::ParamRequestRead>(&message)) {
    handle_read(*read);
  } else if (const auto* set = std::get_if<link::ParamSet>(&message)) {
    handle_set(*set);
  } else if (const auto* sync = std::get_if<link::TimeSync>(&message)) {
    if (sync->tc1_ns == 0) {
      send(link::TimeSync{boot_clock().count(), sync->ts1_ns}, kTimely);
    }
  } else if (const auto* command = std::get_if<link::CommandRequest>(&message)) {
    handle_command(static_cast<link::Command>(command->command));
  }
}

void FakeFcu::handle_read(const link::ParamRequestRead& request) {
  if (request.index >= 0) {
    if (static_cast<std::size_t>(request.index) < parameters.size()) {
      send_value(static_cast<std::size_t>(request.index));
    }
    return;
  }
  if (const Parameter* p = find(text_of(request.name))) {
    send_value(static_cast<std::size_t>(p - parameters.data()));
  }
}

void FakeFcu::handle_set(const link::ParamSet& set) {
  Parameter* const p = find(text_of(set.name));
  if (p == nullptr || static_cast<std::uint8_t>(p->value.type) != set.type) {
    return;
  }
  ParameterValue wanted{p->value.type, set.value};
  if (wanted.number() < p->min || wanted.number() > p->max) {
    const double clamped = std::clamp(wanted.number(), p->min, p->max);
    std::string ignored;
    wanted = p->refuse_out_of_range ? p->value
                                    : to_value(clamped, p->value.type, ignored).value_or(p->value);
  } else if (same_value(wanted, p->value) && !answers_equal_sets) {
    return;
  }
  p->value = wanted;
  send_value(static_cast<std::size_t>(p - parameters.data()));
}

void FakeFcu::handle_command(link::Command command) {
  if (armed) {
    send(link::CommandAck{static_cast<std::uint8_t>(command), false});
    return;
  }
  if (command == link::Command::kSendVersion) {
    link::Version message;
    copy_text(version, message.text);
    send(message);
  }
  const std::optional<bool> ack = on_command ? on_command(command) : std::optional(true);
  if (ack) {
    send(link::CommandAck{static_cast<std::uint8_t>(command), *ack});
  }
}

}  // namespace rosflight::companion::test
