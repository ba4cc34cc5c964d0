// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "link/messages.hpp"

/// Every field of every message, for tests that treat all messages alike: as text, and at random.
namespace rosflight::link::test {

template <typename T, typename Of>
concept Either = std::same_as<std::remove_const_t<T>, Of>;

// f(name, field) for each field of one message.

void each_field(Either<std::monostate> auto&, auto&&) {}
void each_field(Either<Heartbeat> auto& m, auto&& f) {
  f("type", m.type);
}
void each_field(Either<TimeSync> auto& m, auto&& f) {
  f("tc1", m.tc1_ns);
  f("ts1", m.ts1_ns);
}
void each_field(Either<ParamRequestRead> auto& m, auto&& f) {
  f("target_system", m.target_system);
  f("param_id", m.name);
  f("param_index", m.index);
}
void each_field(Either<ParamRequestList> auto& m, auto&& f) {
  f("target_system", m.target_system);
}
void each_field(Either<ParamSet> auto& m, auto&& f) {
  f("target_system", m.target_system);
  f("param_id", m.name);
  f("param_value", m.value);
  f("param_type", m.type);
}
void each_field(Either<OffboardControl> auto& m, auto&& f) {
  f("mode", m.mode);
  f("ignore", m.ignore);
  f("u", m.u);
}
void each_field(Either<AuxCommand> auto& m, auto&& f) {
  f("type_array", m.type);
  f("aux_cmd_array", m.value);
}
void each_field(Either<ExternalAttitude> auto& m, auto&& f) {
  f("qw", m.q_WB[0]);
  f("qx", m.q_WB[1]);
  f("qy", m.q_WB[2]);
  f("qz", m.q_WB[3]);
}
void each_field(Either<CommandRequest> auto& m, auto&& f) {
  f("command", m.command);
}
void each_field(Either<ParamValue> auto& m, auto&& f) {
  f("param_id", m.name);
  f("param_value", m.value);
  f("param_type", m.type);
  f("param_count", m.count);
  f("param_index", m.index);
}
void each_field(Either<CommandAck> auto& m, auto&& f) {
  f("command", m.command);
  f("success", m.success);
}
void each_field(Either<Attitude> auto& m, auto&& f) {
  f("time_boot_ms", m.time_boot_ms);
  f("q1", m.q_WB[0]);
  f("q2", m.q_WB[1]);
  f("q3", m.q_WB[2]);
  f("q4", m.q_WB[3]);
  f("rollspeed", m.rates_rad_s[0]);
  f("pitchspeed", m.rates_rad_s[1]);
  f("yawspeed", m.rates_rad_s[2]);
}
void each_field(Either<Imu> auto& m, auto&& f) {
  f("time_boot_us", m.time_boot_us);
  f("xacc", m.accel_m_s2[0]);
  f("yacc", m.accel_m_s2[1]);
  f("zacc", m.accel_m_s2[2]);
  f("xgyro", m.gyro_rad_s[0]);
  f("ygyro", m.gyro_rad_s[1]);
  f("zgyro", m.gyro_rad_s[2]);
  f("temperature", m.temperature_K);
}
void each_field(Either<Mag> auto& m, auto&& f) {
  f("xmag", m.field_T[0]);
  f("ymag", m.field_T[1]);
  f("zmag", m.field_T[2]);
}
void each_field(Either<Baro> auto& m, auto&& f) {
  f("altitude", m.altitude_m);
  f("pressure", m.pressure_Pa);
  f("temperature", m.temperature_K);
}
void each_field(Either<DiffPressure> auto& m, auto&& f) {
  f("velocity", m.airspeed_m_s);
  f("diff_pressure", m.pressure_Pa);
  f("temperature", m.temperature_K);
}
void each_field(Either<Range> auto& m, auto&& f) {
  f("type", m.kind);
  f("range", m.range_m);
  f("max_range", m.max_m);
  f("min_range", m.min_m);
}
void each_field(Either<RcChannels> auto& m, auto&& f) {
  f("time_boot_ms", m.time_boot_ms);
  f("chancount", m.count);
  for (std::size_t i = 0; i < kRcChannels; ++i) {
    f("chan" + std::to_string(i + 1) + "_raw", m.pulse_us[i]);
  }
  f("rssi", m.rssi);
}
void each_field(Either<OutputRaw> auto& m, auto&& f) {
  f("stamp", m.time_boot_ms);
  f("values", m.values);
}
void each_field(Either<Status> auto& m, auto&& f) {
  f("armed", m.armed);
  f("failsafe", m.failsafe);
  f("rc_override", m.rc_override);
  f("offboard", m.offboard);
  f("error_code", m.error_code);
  f("control_mode", m.control_mode);
  f("num_errors", m.sensor_errors);
  f("loop_time_us", m.loop_time_us);
}
void each_field(Either<Version> auto& m, auto&& f) {
  f("version", m.text);
}
void each_field(Either<HardError> auto& m, auto&& f) {
  f("error_code", m.error_code);
  f("pc", m.pc);
  f("reset_count", m.reset_count);
  f("doRearm", m.rearm);
}
void each_field(Either<Gnss> auto& m, auto&& f) {
  f("seconds", m.unix_s);
  f("nanos", m.unix_ns);
  f("fix_type", m.fix);
  f("num_sat", m.satellites);
  f("lat", m.latitude_deg);
  f("lon", m.longitude_deg);
  f("height", m.height_msl_m);
  f("vel_n", m.velocity_ned_m_s[0]);
  f("vel_e", m.velocity_ned_m_s[1]);
  f("vel_d", m.velocity_ned_m_s[2]);
  f("h_acc", m.horizontal_accuracy_m);
  f("v_acc", m.vertical_accuracy_m);
  f("s_acc", m.speed_accuracy_m_s);
  f("rosflight_timestamp", m.time_boot_us);
}
void each_field(Either<BatteryStatus> auto& m, auto&& f) {
  f("battery_voltage", m.voltage_V);
  f("battery_current", m.current_A);
}
void each_field(Either<StatusText> auto& m, auto&& f) {
  f("severity", m.severity);
  f("text", m.text);
}
void each_field(Either<MotorTest> auto& m, auto&& f) {
  f("target_system", m.target_system);
  f("motor", m.motor);
  f("value", m.value);
}
void each_field(Either<ReportRequest> auto& m, auto&& f) {
  f("target_system", m.target_system);
  f("kind", m.kind);
}
void each_field(Either<CheckResult> auto& m, auto&& f) {
  f("index", m.index);
  f("count", m.count);
  f("result", m.result);
  f("name", m.name);
  f("reason", m.reason);
}
void each_field(Either<Counters> auto& m, auto&& f) {
  f("longest_pass", m.longest_pass_us);
  f("pass_budget", m.pass_budget_us);
  f("passes_over_budget", m.passes_over_budget);
  f("passes", m.passes);
  f("frames_dropped", m.frames_dropped);
  f("tx_dropped", m.tx_dropped);
  f("texts_lost", m.texts_lost);
  f("imu_jitter", m.imu_jitter);
  f("rejected", m.rejected);
}
void each_field(Either<RecordRequest> auto& m, auto&& f) {
  f("target_system", m.target_system);
  f("first", m.first);
  f("count", m.count);
}
void each_field(Either<RecordPart> auto& m, auto&& f) {
  f("number", m.number);
  f("oldest", m.oldest);
  f("newest", m.newest);
  f("part", m.part);
  f("bytes", m.bytes);
}

template <typename To, typename From>
To bits_of(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to{};
  std::memcpy(&to, &from, sizeof to);
  return to;
}

/// Numbers in decimal, floats as the number their bits are, texts in hexadecimal without trailing
/// zeros.
struct Describe {
  std::ostringstream out;

  template <typename T>
  void value(const T& v) {
    if constexpr (std::same_as<T, float>) {
      out << bits_of<std::uint32_t>(v);
    } else if constexpr (std::same_as<T, double>) {
      out << bits_of<std::uint64_t>(v);
    } else if constexpr (std::same_as<T, ParamBits>) {
      out << v.bits;
    } else if constexpr (std::is_enum_v<T>) {
      out << static_cast<unsigned>(v);
    } else {
      out << +v;
    }
  }
  template <std::size_t kSize>
  void value(const std::array<char, kSize>& text) {
    std::size_t size = kSize;
    while (size > 0 && text[size - 1] == 0) --size;
    constexpr const char* kDigits = "0123456789abcdef";
    for (std::size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      out << kDigits[byte / 16] << kDigits[byte % 16];
    }
  }
  template <typename T, std::size_t kSize>
    requires(!std::same_as<T, char>)
  void value(const std::array<T, kSize>& values) {
    for (std::size_t i = 0; i < kSize; ++i) {
      out << (i == 0 ? "" : ",");
      value(values[i]);
    }
  }
};

inline std::string describe(const Message& message) {
  Describe describe;
  describe.out << message.index();
  std::visit(
      [&](const auto& m) {
        each_field(m, [&](const std::string& name, const auto& field) {
          describe.out << ' ' << name << '=';
          describe.value(field);
        });
      },
      message);
  return describe.out.str();
}

/// Any bits a field can hold: NaNs and values outside of enumerations included.
struct Randomise {
  std::mt19937_64& random;

  template <typename T>
  void value(T& v) {
    if constexpr (std::same_as<T, bool>) {
      v = random() % 2 == 1;
    } else if constexpr (std::same_as<T, ParamBits>) {
      value(v.bits);
    } else {
      const std::uint64_t bits = random();
      std::memcpy(&v, &bits, sizeof v);
    }
  }
  template <std::size_t kSize>
  void value(std::array<char, kSize>& text) {
    text = {};
    const std::size_t longest = kSize == kTextLength ? kSize - 1 : kSize;
    const std::size_t size = random() % (longest + 1);
    for (std::size_t i = 0; i < size; ++i) text[i] = static_cast<char>(1 + random() % 255);
  }
  template <typename T, std::size_t kSize>
    requires(!std::same_as<T, char>)
  void value(std::array<T, kSize>& values) {
    for (T& v : values) value(v);
  }
};

/// A message of alternative `index` with random fields.
template <std::size_t kIndex = 0>
Message random_message(std::size_t index, std::mt19937_64& random) {
  if constexpr (kIndex < std::variant_size_v<Message>) {
    if (index != kIndex) return random_message<kIndex + 1>(index, random);
    std::variant_alternative_t<kIndex, Message> m{};
    Randomise randomise{random};
    each_field(m, [&](const std::string&, auto& field) { randomise.value(field); });
    return m;
  } else {
    return std::monostate{};
  }
}

}  // namespace rosflight::link::test
