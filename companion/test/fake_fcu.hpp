// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "companion/parameter.hpp"
#include "companion/time.hpp"
#include "companion/transport.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::companion::test {

/// Small well-defined generator (xorshift64*), so that a seed means the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2685821657736338717ULL + 1) {}
  std::uint64_t next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 2685821657736338717ULL;
  }
  /// Next number in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

/// Loses single bytes of what is written through it.
class LossyTransport final : public Transport {
 public:
  LossyTransport(Transport& inner, double loss, std::uint64_t seed)
      : byte_loss(loss), inner_(inner), random_(seed) {}

  bool connected() override { return inner_.connected(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    return inner_.read(data, capacity);
  }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    std::vector<std::uint8_t> rest;
    for (std::size_t i = 0; i < size; ++i) {
      if (random_.uniform() >= byte_loss) {
        rest.push_back(data[i]);
      }
    }
    return inner_.write(rest.data(), rest.size(), qos);
  }

  double byte_loss;

 private:
  Transport& inner_;
  Random random_;
};

/// A flight control unit at message level: parameters and commands as the protocol sheet of
/// ROSflight 2.x (release 2.0.1) says, with switches for what firmwares do differently and for
/// mischief.
class FakeFcu {
 public:
  struct Parameter {
    std::string name;
    ParameterValue value;
    double min{-1e30};
    double max{1e30};
    bool refuse_out_of_range{true};  ///< Else clamp.
  };

  FakeFcu(Transport& transport, std::vector<Parameter> table)
      : parameters(std::move(table)), transport_(transport) {}

  /// One main-loop pass. The boot clock runs from the first step or restart.
  void step(Time now);
  void restart() { booted_.reset(); }
  Time boot_clock() const { return now_ - booted_.value_or(now_); }

  void send(const link::Message& message, std::uint8_t qos = kOrdinary);
  void send_text(std::string_view text, link::Severity severity = link::Severity::kInfo);
  void send_value(std::size_t index);
  void set_from_inside(std::string_view name, ParameterValue value);
  Parameter* find(std::string_view name);

  template <class T>
  std::size_t count_received() const {
    std::size_t n = 0;
    for (const link::Message& m : received) {
      n += std::holds_alternative<T>(m) ? 1U : 0U;
    }
    return n;
  }

  std::vector<Parameter> parameters;
  bool silent{false};             ///< Dead: reads and sends nothing.
  bool answers_equal_sets{true};  ///< ROSflight 2.x: false.
  bool armed{false};
  bool imu{true};  ///< Streams IMU and attitude every pass.
  std::string version{"v2.0.1-12-gabcdef12"};
  /// What a command does; the return value is the acknowledge, nothing means none.
  std::function<std::optional<bool>(link::Command)> on_command;
  /// Return true to swallow a message before the FCU sees it.
  std::function<bool(const link::Message&)> intercept;
  std::vector<link::Message> received;
  /// What it speaks.
  std::shared_ptr<link::Codec> codec{std::make_shared<link::MavlinkCodec>(
      link::MavlinkCodec::Identity{1, link::MavlinkCodec::kFcuComponent})};

 private:
  void handle(const link::Message& message);
  void handle_set(const link::ParamSet& set);
  void handle_read(const link::ParamRequestRead& request);
  void handle_command(link::Command command);
  void stream();

  Transport& transport_;
  Time now_{};
  std::optional<Time> booted_;
  Time next_heartbeat_{};
  std::optional<std::size_t> list_at_;
};

template <std::size_t N>
void copy_text(std::string_view text, std::array<char, N>& field) {
  field.fill('\0');
  for (std::size_t i = 0; i < text.size() && i < N; ++i) {
    field[i] = text[i];
  }
}

/// `n` parameters P000, P001, ...: every third an int32 of its index, the others floats of index
/// / 10.
std::vector<FakeFcu::Parameter> numbered_table(std::size_t n);

}  // namespace rosflight::companion::test
