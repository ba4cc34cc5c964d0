// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "firmware/boards/parts/flight_record.hpp"
#include "firmware/core/firmware.hpp"

namespace rosflight::boards {

/// Around the codec of an image: texts that are sent enter the flight record, and requests for its entries
/// are answered. The core knows nothing of it. All three must outlive this.
class RecordingCodec final : public link::Codec {
 public:
  RecordingCodec(link::Codec& inner, parts::FlightRecord& record, const hal::Clock& clock)
      : inner_{inner}, record_{record}, clock_{clock} {}

  bool encode(const link::Message& message, link::Frame& frame) override {
    if (const auto* text = std::get_if<link::StatusText>(&message)) {
      record_.add(clock_.now(), text->text.data(), static_cast<std::uint8_t>(text->severity));
    }
    return inner_.encode(message, frame);
  }
  Decoded decode(const std::uint8_t* data, std::size_t size) override {
    const Decoded result = inner_.decode(data, size);
    if (!result.complete) return result;
    const auto* const request = std::get_if<link::RecordRequest>(&inner_.message());
    const bool mine =
        request != nullptr && (request->target_system == 0 || request->target_system == system_id_);
    if (mine) {
      request_ = *request;
      requested_ = true;
    }
    return result;
  }
  const link::Message& message() const override { return inner_.message(); }
  void set_system_id(std::uint8_t id) override {
    system_id_ = id;
    inner_.set_system_id(id);
  }
  const Counters& counters() const override { return inner_.counters(); }
  const SchemaMismatch* mismatch() const override { return inner_.mismatch(); }

  /// Main loop, once per pass: sends one entry if the queue of the port has room for more than that. In
  /// flight the link has other work: a request is then dropped.
  void serve(hal::Serial& port, bool armed) {
    if (!requested_) return;
    if (armed) requested_ = false;
    if (armed || port.writable() < kRoom) return;
    request_.first = std::max(request_.first, record_.oldest());
    if (request_.count == 0) {
      send(port, 0, 0);
    } else if (request_.first <= record_.newest()) {
      send(port, request_.first, 0);
      send(port, request_.first, 1);
      ++request_.first;
      --request_.count;
    } else {
      request_.count = 0;
    }
    requested_ = request_.count > 0;
  }

 private:
  static_assert(2 * link::kRecordPartBytes == parts::FlightRecord::kSlotBytes);
  /// Bytes of the transmit queue that the record may fill: half of it remains for the firmware's messages.
  static constexpr std::size_t kRoom = 2048;

  void send(hal::Serial& port, std::uint32_t number, std::uint8_t part) {
    link::RecordPart half{number, record_.oldest(), record_.newest(), part, {}};
    if (number != 0) {
      const std::uint8_t* const from = record_.bytes(number) + part * half.bytes.size();
      std::copy_n(from, half.bytes.size(), half.bytes.begin());
    }
    link::Frame frame;
    if (inner_.encode(half, frame)) {
      static_cast<void>(port.write(frame.bytes.data(), frame.size, hal::Serial::kOrdinary));
    }
  }

  link::Codec& inner_;
  parts::FlightRecord& record_;
  const hal::Clock& clock_;
  link::RecordRequest request_{};
  std::uint8_t system_id_{1};
  bool requested_{false};
};

/// Decides what enters the flight record of an image: 100 times per second what the firmware measured,
/// estimated and commanded, while it is armed.
///
/// After a restart in flight 10 s more are recorded; then the record is held until the next arming, so that
/// the fault is still in it after the landing. Behind each flight 1 s is recorded for its texts.
class FlightRecorder {
 public:
  static constexpr hal::Time kPeriod = hal::milliseconds(10);
  static constexpr hal::Time kAfterRestart = hal::milliseconds(10'000);
  static constexpr hal::Time kAfterFlight = hal::milliseconds(1000);

  /// @param found  entries that were found at the start.
  FlightRecorder(parts::FlightRecord& record, std::size_t found, hal::Time now)
      : record_{record}, until_{now + kAfterRestart}, restarted_{found > 0} {}

  /// Once per pass, behind it.
  void step(const core::Firmware& firmware, hal::Time now) {
    const bool armed = firmware.state().armed();
    if (armed && !armed_ && stepped_) restarted_ = false;
    if (!armed && armed_ && !restarted_) until_ = now + kAfterFlight;
    armed_ = armed;
    stepped_ = true;
    const bool records = now < until_ || (armed && !restarted_);
    record_.hold(!records);
    if (!records || !armed || !firmware.sensors().measurements().new_imu || now < next_) return;
    next_ += kPeriod;
    if (next_ <= now) next_ = now + kPeriod;
    record_.add(moment_of(firmware));
  }

 private:
  static parts::FlightMoment moment_of(const core::Firmware& firmware) {
    using Moment = parts::FlightMoment;
    Moment moment;
    const hal::ImuSample& imu = firmware.sensors().measurements().imu;
    moment.time = imu.stamp;
    moment.accel_m_s2 = imu.accel_m_s2;
    moment.gyro_rad_s = imu.gyro_rad_s;
    const core::Quaternion& q = firmware.estimator().estimate().q_WB;
    moment.q_WB = {q.w, q.x, q.y, q.z};
    const core::CommandVector& command = firmware.command().combined();
    for (std::size_t k = 0; k < moment.command.size(); ++k) moment.command[k] = command.value[k];
    moment.outputs = firmware.mixer().outputs();
    moment.error_word = firmware.state().errors();
    moment.flags = static_cast<std::uint8_t>(
        (firmware.state().armed() ? Moment::kArmed : 0u) |
        (firmware.state().failsafe() ? Moment::kFailsafe : 0u) |
        (firmware.command().override_word() != 0 ? Moment::kOverride : 0u));
    return moment;
  }

  parts::FlightRecord& record_;
  hal::Time until_;   ///< Until then also without a flight.
  hal::Time next_{};  ///< When the next moment is due.
  bool restarted_;    ///< And since then not armed again.
  bool armed_{false};
  bool stepped_{false};
};

}  // namespace rosflight::boards
