// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#include "link/messages.hpp"
#include "link/text.hpp"

/// The fields of each message in the order of transmission. Packing, unpacking, lengths, the schema
/// and the table in docs/link.md are derived from this list.
namespace rosflight::link::lean {

template <typename M, typename T>
struct Field {
  const char* name;
  T M::*member;
};

/// One field of a layout: its name in the schema and the member of the struct.
template <typename M, typename T>
constexpr Field<M, T> field(const char* name, T M::*member) {
  return {name, member};
}

template <typename M>
struct Layout;

/// The heartbeat on the wire; it carries the schema of its sender. It is the same in every schema.
struct Greeting {
  VehicleType type{};
  std::uint32_t schema{};
};
template <>
struct Layout<Greeting> {
  static constexpr const char* kName = "Heartbeat";
  static constexpr auto kFields =
      std::make_tuple(field("type", &Greeting::type), field("schema", &Greeting::schema));
};

template <>
struct Layout<TimeSync> {
  static constexpr const char* kName = "TimeSync";
  static constexpr auto kFields =
      std::make_tuple(field("tc1_ns", &TimeSync::tc1_ns), field("ts1_ns", &TimeSync::ts1_ns));
};

template <>
struct Layout<ParamRequestRead> {
  static constexpr const char* kName = "ParamRequestRead";
  static constexpr auto kFields = std::make_tuple(
      field("target_system", &ParamRequestRead::target_system),
      field("index", &ParamRequestRead::index), field("name", &ParamRequestRead::name));
};

template <>
struct Layout<ParamRequestList> {
  static constexpr const char* kName = "ParamRequestList";
  static constexpr auto kFields =
      std::make_tuple(field("target_system", &ParamRequestList::target_system));
};

template <>
struct Layout<ParamSet> {
  static constexpr const char* kName = "ParamSet";
  static constexpr auto kFields = std::make_tuple(
      field("target_system", &ParamSet::target_system), field("name", &ParamSet::name),
      field("value", &ParamSet::value), field("type", &ParamSet::type));
};

template <>
struct Layout<OffboardControl> {
  static constexpr const char* kName = "OffboardControl";
  static constexpr auto kFields =
      std::make_tuple(field("mode", &OffboardControl::mode),
                      field("ignore", &OffboardControl::ignore), field("u", &OffboardControl::u));
};

template <>
struct Layout<AuxCommand> {
  static constexpr const char* kName = "AuxCommand";
  static constexpr auto kFields =
      std::make_tuple(field("type", &AuxCommand::type), field("value", &AuxCommand::value));
};

template <>
struct Layout<ExternalAttitude> {
  static constexpr const char* kName = "ExternalAttitude";
  static constexpr auto kFields = std::make_tuple(field("q_NB", &ExternalAttitude::q_WB));
};

template <>
struct Layout<CommandRequest> {
  static constexpr const char* kName = "CommandRequest";
  static constexpr auto kFields = std::make_tuple(field("command", &CommandRequest::command));
};

template <>
struct Layout<ParamValue> {
  static constexpr const char* kName = "ParamValue";
  static constexpr auto kFields =
      std::make_tuple(field("name", &ParamValue::name), field("value", &ParamValue::value),
                      field("type", &ParamValue::type), field("count", &ParamValue::count),
                      field("index", &ParamValue::index));
};

template <>
struct Layout<CommandAck> {
  static constexpr const char* kName = "CommandAck";
  static constexpr auto kFields = std::make_tuple(field("command", &CommandAck::command),
                                                  field("success", &CommandAck::success));
};

template <>
struct Layout<Attitude> {
  static constexpr const char* kName = "Attitude";
  static constexpr auto kFields =
      std::make_tuple(field("time_boot_ms", &Attitude::time_boot_ms),
                      field("q_NB", &Attitude::q_WB), field("rates_rad_s", &Attitude::rates_rad_s));
};

template <>
struct Layout<Imu> {
  static constexpr const char* kName = "Imu";
  static constexpr auto kFields = std::make_tuple(
      field("time_boot_us", &Imu::time_boot_us), field("accel_m_s2", &Imu::accel_m_s2),
      field("gyro_rad_s", &Imu::gyro_rad_s), field("temperature_K", &Imu::temperature_K));
};

template <>
struct Layout<Mag> {
  static constexpr const char* kName = "Mag";
  static constexpr auto kFields = std::make_tuple(field("field_T", &Mag::field_T));
};

template <>
struct Layout<Baro> {
  static constexpr const char* kName = "Baro";
  static constexpr auto kFields = std::make_tuple(field("altitude_m", &Baro::altitude_m),
                                                  field("pressure_Pa", &Baro::pressure_Pa),
                                                  field("temperature_K", &Baro::temperature_K));
};

template <>
struct Layout<DiffPressure> {
  static constexpr const char* kName = "DiffPressure";
  static constexpr auto kFields =
      std::make_tuple(field("airspeed_m_s", &DiffPressure::airspeed_m_s),
                      field("pressure_Pa", &DiffPressure::pressure_Pa),
                      field("temperature_K", &DiffPressure::temperature_K));
};

template <>
struct Layout<Range> {
  static constexpr const char* kName = "Range";
  static constexpr auto kFields =
      std::make_tuple(field("kind", &Range::kind), field("range_m", &Range::range_m),
                      field("max_m", &Range::max_m), field("min_m", &Range::min_m));
};

template <>
struct Layout<RcChannels> {
  static constexpr const char* kName = "RcChannels";
  static constexpr auto kFields = std::make_tuple(
      field("time_boot_ms", &RcChannels::time_boot_ms), field("pulse_us", &RcChannels::pulse_us),
      field("count", &RcChannels::count), field("rssi", &RcChannels::rssi));
};

template <>
struct Layout<OutputRaw> {
  static constexpr const char* kName = "OutputRaw";
  static constexpr auto kFields = std::make_tuple(field("time_boot_ms", &OutputRaw::time_boot_ms),
                                                  field("values", &OutputRaw::values));
};

template <>
struct Layout<Status> {
  static constexpr const char* kName = "Status";
  static constexpr auto kFields = std::make_tuple(
      field("armed", &Status::armed), field("failsafe", &Status::failsafe),
      field("offboard", &Status::offboard), field("rc_override", &Status::rc_override),
      field("error_code", &Status::error_code), field("control_mode", &Status::control_mode),
      field("sensor_errors", &Status::sensor_errors), field("loop_time_us", &Status::loop_time_us));
};

template <>
struct Layout<Version> {
  static constexpr const char* kName = "Version";
  static constexpr auto kFields = std::make_tuple(field("text", &Version::text));
};

template <>
struct Layout<HardError> {
  static constexpr const char* kName = "HardError";
  static constexpr auto kFields = std::make_tuple(
      field("error_code", &HardError::error_code), field("pc", &HardError::pc),
      field("reset_count", &HardError::reset_count), field("rearm", &HardError::rearm));
};

template <>
struct Layout<Gnss> {
  static constexpr const char* kName = "Gnss";
  static constexpr auto kFields = std::make_tuple(
      field("unix_s", &Gnss::unix_s), field("unix_ns", &Gnss::unix_ns), field("fix", &Gnss::fix),
      field("satellites", &Gnss::satellites), field("latitude_deg", &Gnss::latitude_deg),
      field("longitude_deg", &Gnss::longitude_deg), field("height_msl_m", &Gnss::height_msl_m),
      field("velocity_ned_m_s", &Gnss::velocity_ned_m_s),
      field("horizontal_accuracy_m", &Gnss::horizontal_accuracy_m),
      field("vertical_accuracy_m", &Gnss::vertical_accuracy_m),
      field("speed_accuracy_m_s", &Gnss::speed_accuracy_m_s),
      field("time_boot_us", &Gnss::time_boot_us));
};

template <>
struct Layout<BatteryStatus> {
  static constexpr const char* kName = "BatteryStatus";
  static constexpr auto kFields = std::make_tuple(field("voltage_V", &BatteryStatus::voltage_V),
                                                  field("current_A", &BatteryStatus::current_A));
};

template <>
struct Layout<StatusText> {
  static constexpr const char* kName = "StatusText";
  static constexpr auto kFields =
      std::make_tuple(field("severity", &StatusText::severity), field("text", &StatusText::text));
};

template <>
struct Layout<MotorTest> {
  static constexpr const char* kName = "MotorTest";
  static constexpr auto kFields =
      std::make_tuple(field("target_system", &MotorTest::target_system),
                      field("motor", &MotorTest::motor), field("value", &MotorTest::value));
};

template <>
struct Layout<ReportRequest> {
  static constexpr const char* kName = "ReportRequest";
  static constexpr auto kFields = std::make_tuple(
      field("target_system", &ReportRequest::target_system), field("kind", &ReportRequest::kind));
};

template <>
struct Layout<CheckResult> {
  static constexpr const char* kName = "CheckResult";
  static constexpr auto kFields =
      std::make_tuple(field("index", &CheckResult::index), field("count", &CheckResult::count),
                      field("result", &CheckResult::result), field("name", &CheckResult::name),
                      field("reason", &CheckResult::reason));
};

template <>
struct Layout<Counters> {
  static constexpr const char* kName = "Counters";
  static constexpr auto kFields = std::make_tuple(
      field("longest_pass_us", &Counters::longest_pass_us),
      field("pass_budget_us", &Counters::pass_budget_us),
      field("passes_over_budget", &Counters::passes_over_budget),
      field("passes", &Counters::passes), field("frames_dropped", &Counters::frames_dropped),
      field("tx_dropped", &Counters::tx_dropped), field("texts_lost", &Counters::texts_lost),
      field("imu_jitter", &Counters::imu_jitter), field("rejected", &Counters::rejected));
};

template <>
struct Layout<RecordRequest> {
  static constexpr const char* kName = "RecordRequest";
  static constexpr auto kFields =
      std::make_tuple(field("target_system", &RecordRequest::target_system),
                      field("first", &RecordRequest::first), field("count", &RecordRequest::count));
};

template <>
struct Layout<RecordPart> {
  static constexpr const char* kName = "RecordPart";
  static constexpr auto kFields =
      std::make_tuple(field("number", &RecordPart::number), field("oldest", &RecordPart::oldest),
                      field("newest", &RecordPart::newest), field("part", &RecordPart::part),
                      field("bytes", &RecordPart::bytes));
};

// ---- one value on the wire

/// How a value looks in the schema: a type letter, its bytes, how many of them.
struct Shape {
  char letter{};
  std::size_t item_bytes{};
  std::size_t count{1};
  constexpr std::size_t bytes() const { return item_bytes * count; }
};

/// How a value is transmitted. Numbers and enumerations: their bytes, lowest first.
template <typename T>
struct Wire {
  static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
  /// Letter, size and number of the items.
  static constexpr Shape shape() {
    if constexpr (std::is_floating_point_v<T>) {
      return {'f', sizeof(T)};
    } else {
      return {std::is_signed_v<T> ? 'i' : 'u', sizeof(T)};  // is_signed: not an enumeration
    }
  }
  /// Writes shape().bytes() bytes.
  static void put(const T& value, std::uint8_t* to) { std::memcpy(to, &value, sizeof value); }
  /// Reads shape().bytes() bytes.
  static void get(const std::uint8_t* from, T& value) { std::memcpy(&value, from, sizeof value); }
};

/// One byte, true for any but 0.
template <>
struct Wire<bool> {
  static constexpr Shape shape() { return {'b', 1}; }
  static void put(const bool& value, std::uint8_t* to) { *to = value ? 1 : 0; }
  static void get(const std::uint8_t* from, bool& value) { value = *from != 0; }
};

template <>
struct Wire<ParamBits> {
  static constexpr Shape shape() { return {'u', sizeof(std::uint32_t)}; }
  static void put(const ParamBits& value, std::uint8_t* to) {
    std::memcpy(to, &value.bits, sizeof value.bits);
  }
  static void get(const std::uint8_t* from, ParamBits& value) {
    std::memcpy(&value.bits, from, sizeof value.bits);
  }
};

template <typename T, std::size_t kSize>
struct Wire<std::array<T, kSize>> {
  static constexpr Shape shape() { return {Wire<T>::shape().letter, sizeof(T), kSize}; }
  static void put(const std::array<T, kSize>& values, std::uint8_t* to) {
    std::memcpy(to, values.data(), sizeof values);
  }
  static void get(const std::uint8_t* from, std::array<T, kSize>& values) {
    std::memcpy(values.data(), from, sizeof values);
  }
};

/// Nothing follows the first NUL; a name may fill its field, a text always ends with one.
template <std::size_t kSize>
struct Wire<std::array<char, kSize>> {
  static constexpr Shape shape() { return {'c', 1, kSize}; }
  static void copy(const char* from, char* to) {
    if constexpr (kSize == kParamNameLength) {
      copy_text<kSize>(from, to);
    } else {
      copy_terminated<kSize>(from, to);
    }
  }
  static void put(const std::array<char, kSize>& text, std::uint8_t* to) {
    copy(text.data(), reinterpret_cast<char*>(to));
  }
  static void get(const std::uint8_t* from, std::array<char, kSize>& text) {
    copy(reinterpret_cast<const char*>(from), text.data());
  }
};

/// The Wire of a field's type.
template <typename M, typename T>
constexpr Wire<T> wire_of(Field<M, T>) {
  return {};
}

// ---- whole messages

/// Calls f(field) for each field of M in turn.
template <typename M, typename F>
constexpr void each_field(F&& f) {
  std::apply([&f](auto... one) { (f(one), ...); }, Layout<M>::kFields);
}

/// Length of the payload of M.
template <typename M>
constexpr std::size_t payload_bytes() {
  std::size_t bytes = 0;
  each_field<M>([&bytes](auto one) { bytes += decltype(wire_of(one))::shape().bytes(); });
  return bytes;
}

/// Writes payload_bytes<M>() bytes.
template <typename M>
void pack(const M& message, std::uint8_t* to) {
  each_field<M>([&message, &to](auto one) {
    using Value = decltype(wire_of(one));
    Value::put(message.*one.member, to);
    to += Value::shape().bytes();
  });
}

/// Reads payload_bytes<M>() bytes.
template <typename M>
void unpack(const std::uint8_t* from, M& message) {
  each_field<M>([&message, &from](auto one) {
    using Value = decltype(wire_of(one));
    Value::get(from, message.*one.member);
    from += Value::shape().bytes();
  });
}

}  // namespace rosflight::link::lean
