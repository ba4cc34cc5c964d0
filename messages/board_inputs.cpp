// SPDX-License-Identifier: BSD-3-Clause
#include "messages/board_inputs.hpp"

#include <algorithm>
#include <utility>

namespace rosflight::messages {
namespace {

using rosflight_log_msgs::BoardInputs;

/// Puts the numbers of a sample into a message.
struct Writer {
  BoardInputs& out;
  void value(float x) { out.values.push_back(x); }
  void number(double x) { out.doubles.push_back(x); }
  template <class T>
  void small(T x) {
    value(static_cast<float>(x));
  }
  template <class T>
  void whole(T x) {
    number(static_cast<double>(x));
  }
};

/// Takes them out again.
struct Reader {
  const BoardInputs& in;
  std::size_t values{0};
  std::size_t doubles{0};
  bool complete{true};

  void value(float& x) {
    if (values < in.values.size()) {
      x = in.values[values++];
    } else {
      complete = false;
    }
  }
  void number(double& x) {
    if (doubles < in.doubles.size()) {
      x = in.doubles[doubles++];
    } else {
      complete = false;
    }
  }
  template <class T>
  void small(T& x) {
    float read{};
    value(read);
    // A byte, a flag, an enumerator; or a count, as far as a float holds whole numbers.
    constexpr float kMaxExact = sizeof(T) == 1 ? 255.0F : 16777216.0F;
    if (read >= 0.0F && read <= kMaxExact) {
      x = static_cast<T>(read);
    } else {
      complete = false;
    }
  }
  template <class T>
  void whole(T& x) {
    double read{};
    number(read);
    x = static_cast<T>(read);
  }
};

template <class Io, class Values>
void exchange_all(Io& io, Values& values) {
  for (auto& x : values) io.value(x);
}

/// `Sample` is const for a Writer.
template <class Io, class Sample>
void exchange(Io& io, Sample& s) {
  if constexpr (requires { s.gyro_rad_s; }) {
    exchange_all(io, s.accel_m_s2);
    exchange_all(io, s.gyro_rad_s);
    io.value(s.temperature_K);
  } else if constexpr (requires { s.field_T; }) {
    exchange_all(io, s.field_T);
    io.value(s.temperature_K);
  } else if constexpr (requires { s.pressure_Pa; }) {
    io.value(s.pressure_Pa);
    io.value(s.temperature_K);
  } else if constexpr (requires { s.range_m; }) {
    io.value(s.range_m);
    io.value(s.min_m);
    io.value(s.max_m);
    io.small(s.kind);
  } else if constexpr (requires { s.latitude_deg; }) {
    io.small(s.fix);
    io.small(s.satellites);
    io.value(s.height_msl_m);
    exchange_all(io, s.velocity_ned_m_s);
    io.value(s.horizontal_accuracy_m);
    io.value(s.vertical_accuracy_m);
    io.value(s.speed_accuracy_m_s);
    io.number(s.latitude_deg);
    io.number(s.longitude_deg);
    io.whole(s.unix_s);
    io.whole(s.unix_ns);
  } else if constexpr (requires { s.voltage_V; }) {
    io.value(s.voltage_V);
    io.value(s.current_A);
  } else {
    io.small(s.channel_count);
    io.small(s.frame_lost);
    io.small(s.failsafe);
    const std::size_t count = std::min<std::size_t>(s.channel_count, s.channels.size());
    for (std::size_t k = 0; k < count; ++k) io.value(s.channels[k]);
  }
}

void add(std::uint8_t kind, std::uint32_t delay_us, hal::Time age, BoardInputs& out) {
  out.kind.push_back(kind);
  out.delay_us.push_back(delay_us);
  out.age_us.push_back(static_cast<std::int32_t>(age.count()));
}

/// Where a sample of this kind belongs, and the flag that says it is new.
template <class Samples, class Use>
void with_sample(std::uint8_t kind, Samples& s, const Use& use) {
  switch (kind) {
    case BoardInputs::IMU:
      return use(s.has_imu, s.imu);
    case BoardInputs::MAG:
      return use(s.has_mag, s.mag);
    case BoardInputs::BARO:
      return use(s.has_baro, s.baro);
    case BoardInputs::DIFF_PRESSURE:
      return use(s.has_diff_pressure, s.diff_pressure);
    case BoardInputs::RANGE:
      return use(s.has_range, s.range);
    case BoardInputs::GNSS:
      return use(s.has_gnss, s.gnss);
    default:
      return use(s.has_battery, s.battery);
  }
}

}  // namespace

void append(const sim::SensorSamples& samples, const hal::RcFrame* receiver, hal::Time now,
            std::uint32_t delay_us, BoardInputs& out) {
  Writer writer{out};
  for (std::uint8_t kind = BoardInputs::IMU; kind <= BoardInputs::BATTERY; ++kind) {
    with_sample(kind, samples, [&](bool is_new, const auto& sample) {
      if (!is_new) return;
      add(kind, std::exchange(delay_us, 0), now - sample.stamp, out);
      exchange(writer, sample);
    });
  }
  if (receiver == nullptr) return;
  add(BoardInputs::RECEIVER, delay_us, now - receiver->stamp, out);
  exchange(writer, *receiver);
}

void append(std::span<const std::uint8_t> bytes, std::uint32_t delay_us, BoardInputs& out) {
  add(BoardInputs::LINK, delay_us, {}, out);
  out.values.push_back(static_cast<float>(bytes.size()));
  out.bytes.insert(out.bytes.end(), bytes.begin(), bytes.end());
}

bool append_to(std::vector<StepInputs>& steps, hal::Time start, const BoardInputs& in) {
  if (in.delay_us.size() != in.kind.size() || in.age_us.size() != in.kind.size()) return false;
  Reader reader{in};
  std::size_t first_byte = 0;
  hal::Time now = start;
  for (std::size_t k = 0; k < in.kind.size(); ++k) {
    now += hal::Time{in.delay_us[k]};
    if (steps.empty() || steps.back().time != now) steps.emplace_back().time = now;
    StepInputs& step = steps.back();
    const hal::Time stamp = now - hal::Time{in.age_us[k]};
    if (in.kind[k] == BoardInputs::LINK) {
      std::uint32_t count = 0;
      reader.small(count);
      if (!reader.complete || count > in.bytes.size() - first_byte) return false;
      const auto from = in.bytes.begin() + static_cast<std::ptrdiff_t>(first_byte);
      step.bytes.insert(step.bytes.end(), from, from + static_cast<std::ptrdiff_t>(count));
      first_byte += count;
    } else if (in.kind[k] == BoardInputs::RECEIVER) {
      step.receiver.emplace().stamp = stamp;
      exchange(reader, *step.receiver);
    } else if (in.kind[k] > BoardInputs::LINK) {
      return false;
    } else {
      with_sample(in.kind[k], step.samples, [&](bool& is_new, auto& sample) {
        is_new = true;
        sample.stamp = stamp;
        exchange(reader, sample);
      });
    }
  }
  return reader.complete;
}

}  // namespace rosflight::messages
