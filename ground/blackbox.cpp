// SPDX-License-Identifier: BSD-3-Clause
#include "ground/blackbox.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <ostream>

#include "base/atomic_file.hpp"
#include "log/flight_log.hpp"

namespace rosflight::ground {
namespace {

using boards::parts::FlightMoment;
using Kind = boards::parts::FlightRecord::Kind;
using companion::RecordReader;
using log::Direction;
using log::FlightLog;

hal::Time since_start(double time_s) {
  return hal::Time{std::llround(time_s * 1e6)};
}

template <class Values>
void append(std::string& row, const Values& values) {
  for (const float value : values) fmt::format_to(std::back_inserter(row), ",{:.9g}", value);
}

template <std::size_t N>
std::string numbered(const char* name) {
  std::string columns;
  for (std::size_t k = 0; k < N; ++k) columns += fmt::format(",{}{}", name, k);
  return columns;
}

std::string moments_csv(const std::vector<RecordedEntry>& record) {
  std::string text =
      "time_s,board_time_us,armed,failsafe,override,errors,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,"
      "gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,q_w,q_x,q_y,q_z";
  text += numbered<FlightMoment::kCommands>("command_") + numbered<hal::kOutputs>("output_") + "\n";
  for (const auto& [time_s, entry] : record) {
    if (entry.kind != Kind::kMoment) continue;
    const FlightMoment& m = entry.moment;
    const auto flag = [&m](unsigned bit) { return (m.flags & bit) != 0 ? 1 : 0; };
    text += fmt::format("{:.6f},{},{},{},{},{}", time_s, m.time.count(), flag(FlightMoment::kArmed),
                        flag(FlightMoment::kFailsafe), flag(FlightMoment::kOverride), m.error_word);
    append(text, m.accel_m_s2);
    append(text, m.gyro_rad_s);
    append(text, m.q_WB);
    append(text, m.command);
    append(text, m.outputs);
    text += '\n';
  }
  return text;
}

/// In quotes, because texts have commas.
std::string texts_csv(const std::vector<RecordedEntry>& record) {
  std::string rows = "time_s,board_time_us,severity,text\n";
  for (const auto& [time_s, entry] : record) {
    if (entry.kind == Kind::kMoment) continue;
    std::string text = entry.kind == Kind::kStart ? "(start of the board)" : entry.text.data();
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2)
      text.insert(at, 1, '"');
    rows += fmt::format("{:.6f},{},{},\"{}\"\n", time_s, entry.moment.time.count(), entry.severity,
                        text);
  }
  return rows;
}

/// A moment as the messages that the board would have sent.
void write_moment(FlightLog& log, hal::Time time, const FlightMoment& m) {
  const auto put = [&log, time](const link::Message& message,
                                Direction direction = Direction::kFcuToCompanion) {
    log.write_link(direction, time, message, {});
  };
  const auto time_us = static_cast<std::uint64_t>(m.time.count());
  const auto time_ms = static_cast<std::uint32_t>(time_us / 1000);
  put(link::Attitude{time_ms, m.q_WB, m.gyro_rad_s});
  put(link::Imu{time_us, m.accel_m_s2, m.gyro_rad_s, 0.0F});
  put(link::OutputRaw{time_ms, m.outputs});
  put(link::OffboardControl{0, 0, m.command}, Direction::kCompanionToFcu);
}

link::Status status_of(const FlightMoment& m) {
  link::Status status;
  status.armed = (m.flags & FlightMoment::kArmed) != 0;
  status.failsafe = (m.flags & FlightMoment::kFailsafe) != 0;
  status.rc_override = static_cast<std::uint16_t>((m.flags & FlightMoment::kOverride) != 0 ? 1 : 0);
  status.error_code = static_cast<std::uint8_t>(m.error_word);
  return status;
}

void write_log(const std::vector<RecordedEntry>& record, const std::filesystem::path& file) {
  FlightLog log(file, {}, {{"source", "flight record of the board"}});
  int last_state = -1;
  for (const auto& [time_s, entry] : record) {
    const hal::Time time = since_start(time_s);
    log.set_fcu_boot(time - entry.moment.time);
    if (entry.kind == Kind::kStart) {
      log.write_event(time, link::Severity::kInfo, "blackbox", "start of the board");
    } else if (entry.kind == Kind::kText) {
      link::StatusText line{static_cast<link::Severity>(entry.severity), {}};
      std::copy_n(entry.text.begin(), line.text.size() - 1, line.text.begin());
      log.write_link(Direction::kFcuToCompanion, time, line, {});
    } else {
      write_moment(log, time, entry.moment);
      const int state = entry.moment.flags << 16 | entry.moment.error_word;
      if (state != last_state)
        log.write_link(Direction::kFcuToCompanion, time, status_of(entry.moment), {});
      last_state = state;
    }
  }
  log.close();
}

}  // namespace

std::vector<RecordedEntry> decode_record(
    const std::map<std::uint32_t, RecordReader::Bytes>& entries) {
  std::vector<RecordedEntry> record;
  hal::Time offset{};
  hal::Time last{};
  for (const auto& [number, bytes] : entries) {
    RecordedEntry one;
    if (!boards::parts::FlightRecord::decode(bytes.data(), one.entry)) continue;
    const hal::Time time = one.entry.moment.time;
    if (record.empty() || one.entry.kind == Kind::kStart) offset = last - time;
    // A text is stamped when it is sent, a moment when it was sampled: order is that of the record.
    last = std::max(last, offset + time);
    one.time_s = static_cast<double>(last.count()) * 1e-6;
    record.push_back(one);
  }
  return record;
}

void write_record(const std::vector<RecordedEntry>& record, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_log(record, folder / "flight.mcap");
  base::write_file(folder / "record.csv", moments_csv(record));
  base::write_file(folder / "texts.csv", texts_csv(record));
}

int read_blackbox(GroundLink& link, const std::filesystem::path& folder, std::ostream& out) {
  using State = RecordReader::State;
  if (link.streams().status.value.armed) {
    out << "the vehicle is armed: the flight record can be read when it is disarmed\n";
    return 1;
  }
  RecordReader reader(link.session());
  link.run_until(
      [&reader] {
        reader.step();
        return reader.state() != State::kReading;
      },
      companion::kNever);
  if (reader.state() == State::kNoRecord) {
    out << "the vehicle has no flight record: no answer to the request\n";
    return 1;
  }
  const std::vector<RecordedEntry> record = decode_record(reader.entries());
  write_record(record, folder);
  std::size_t moments = 0;
  for (const auto& [time_s, entry] : record) {
    if (entry.kind == Kind::kMoment) ++moments;
    if (entry.kind == Kind::kText) out << fmt::format("{:8.3f} s  {}\n", time_s, entry.text.data());
    if (entry.kind == Kind::kStart) out << fmt::format("{:8.3f} s  (start of the board)\n", time_s);
  }
  out << fmt::format("{}: {} moments, {} entries of {}, {:.1f} s\n", folder.string(), moments,
                     record.size(), reader.expected(), record.empty() ? 0.0 : record.back().time_s);
  const bool whole = reader.state() == State::kComplete;
  if (!whole) out << "the vehicle stopped answering: the rest of the record is missing\n";
  return whole ? 0 : 1;
}

}  // namespace rosflight::ground
