// SPDX-License-Identifier: BSD-3-Clause
#include "flight/replay/flight_replay.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "flight/autopilot/in_process_autopilot.hpp"
#include "flight/flight.hpp"
#include "log/mcap_reader.hpp"
#include "messages/board_inputs.hpp"
#include "messages/cdr_reader.hpp"

namespace rosflight::flight {
namespace {

using log::McapReader;
using messages::CdrReader;
using messages::StepInputs;

struct Frame {
  sim::Time time{};
  std::vector<std::uint8_t> bytes;
  bool operator==(const Frame&) const = default;
};

struct StepOutputs {
  sim::Time time{};  ///< At the end of the step.
  hal::OutputValues values{};
};

/// What of a log a replay needs.
struct Recording {
  log::TextMap flight;
  std::vector<StepInputs> inputs;
  std::vector<Frame> sent;  ///< By the firmware.
  std::vector<StepOutputs> outputs;
};

/// Takes a header. @returns its stamp in simulated time.
sim::Time take_stamp(CdrReader& from, std::uint64_t start_ns) {
  std::int32_t sec{};
  std::uint32_t nanosec{};
  std::string frame;
  from.take(sec);
  from.take(nanosec);
  from.take(frame);
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  return sim::Time{(sec * kNanoseconds + nanosec - static_cast<std::int64_t>(start_ns)) / 1000};
}

bool take_inputs(CdrReader from, std::uint64_t start_ns, std::vector<StepInputs>& inputs) {
  const sim::Time start = take_stamp(from, start_ns);
  messages::rosflight_log_msgs::BoardInputs in;
  from.take(in.kind);
  from.take(in.delay_us);
  from.take(in.age_us);
  from.take(in.values);
  from.take(in.doubles);
  from.take(in.bytes);
  return append_to(inputs, start, in);
}

/// Frames of the firmware among those on the link.
bool take_frames(CdrReader from, std::uint64_t start_ns, std::vector<Frame>& sent) {
  const sim::Time start = take_stamp(from, start_ns);
  messages::rosflight_log_msgs::RawFrames in;
  from.take(in.delay_us);
  from.take(in.direction);
  from.take(in.length);
  from.take(in.data);
  if (in.direction.size() != in.delay_us.size() || in.length.size() != in.delay_us.size()) {
    return false;
  }
  std::size_t first = 0;
  for (std::size_t k = 0; k < in.length.size(); ++k) {
    if (in.length[k] > in.data.size() - first) return false;
    const auto from_byte = in.data.begin() + static_cast<std::ptrdiff_t>(first);
    if (in.direction[k] == messages::rosflight_log_msgs::RawFrames::FCU_TO_COMPANION) {
      sent.push_back({start + sim::Time{in.delay_us[k]}, {from_byte, from_byte + in.length[k]}});
    }
    first += in.length[k];
  }
  return true;
}

StepOutputs take_outputs(CdrReader from, std::uint64_t start_ns) {
  StepOutputs out;
  out.time = take_stamp(from, start_ns);
  for (float& value : out.values) from.take(value);
  return out;
}

Recording recording_of(const std::filesystem::path& file) {
  Recording out;
  try {
    McapReader reader(file);
    bool whole = true;
    reader.read([&](const McapReader::Message& message) {
      const CdrReader from(message.data);
      const std::uint64_t start_ns = reader.start_ns();
      if (message.topic == "/board/inputs") {
        whole = take_inputs(from, start_ns, out.inputs) && whole;
      } else if (message.topic == "/link/raw") {
        whole = take_frames(from, start_ns, out.sent) && whole;
      } else if (message.topic == "/sim/truth_vehicle") {
        out.outputs.push_back(take_outputs(from, start_ns));
      }
    });
    out.flight = reader.flight();
    if (!whole) throw std::runtime_error("parts of a message do not fit together");
  } catch (const log::LogError& error) {
    throw InputError(error.what());
  } catch (const std::runtime_error& error) {
    throw InputError(fmt::format("{}: the log is damaged: {}", file.string(), error.what()));
  }
  return out;
}

void check(const Recording& recording, const std::filesystem::path& file) {
  const auto fact = [&recording](const char* name) {
    const auto found = recording.flight.find(name);
    return found == recording.flight.end() ? std::string{} : found->second;
  };
  if (recording.inputs.empty()) {
    throw InputError(
        fmt::format("{}: found no samples of the sensors (/board/inputs); fly with --log full, "
                    "firmware in process",
                    file.string()));
  }
  if (fact("link_protocol").empty()) {
    throw InputError(fmt::format(
        "{}: found no metadata of the flight with link_protocol, allowed a log of `fly`",
        file.string()));
  }
  for (const char* fault : {"crash", "hang"}) {
    if (fact("faults").find(fault) != std::string::npos) {
      throw InputError(
          fmt::format("{}: found the fault {}, which restarts the firmware; allowed a "
                      "flight without",
                      file.string(), fault));
    }
  }
}

/// The firmware, given what another one received. What it sends takes its time on
/// the simulated cable, whose queue it sees.
class ReplayedFirmware final : private LinkTap {
 public:
  explicit ReplayedFirmware(const std::string& protocol)
      : cable_{sim::RandomSource{0}}, autopilot_{cable_, protocol} {
    autopilot_.start(sim::Time{0});
    cable_.set_tap(this);
  }

  const hal::OutputValues& step(sim::Time t, const StepInputs& inputs) {
    cable_.set_time(t);
    cable_.cable().to_board.receive(inputs.bytes.data(), inputs.bytes.size());
    const auto& outputs =
        autopilot_.step(t, inputs.samples, inputs.receiver ? &*inputs.receiver : nullptr);
    std::array<std::uint8_t, 1024> taken{};  // the companion's part, so that its queue stays empty
    while (cable_.companion_end().read(taken.data(), taken.size()) > 0) continue;
    return outputs;
  }
  const std::vector<Frame>& sent() const { return sent_; }

 private:
  void on_frame(Direction direction, hal::Time t, const std::uint8_t* data, std::size_t size,
                bool /*taken*/) override {
    if (direction == Direction::kToCompanion) sent_.push_back({t, {data, data + size}});
  }

  CableLink cable_;
  InProcessAutopilot autopilot_;
  std::vector<Frame> sent_;
};

bool same_bits(const hal::OutputValues& a, const hal::OutputValues& b) {
  return std::memcmp(a.data(), b.data(), sizeof a) == 0;
}

/// Between two inputs; sensors deliver every few milliseconds. A damaged stamp must not run for years.
constexpr sim::Time kMaxGap = std::chrono::seconds(60);

/// Feeds all inputs. @returns the number of steps whose outputs were compared, and the time of the
/// first that differ.
std::pair<std::size_t, std::optional<sim::Time>> run(const Recording& recording,
                                                     ReplayedFirmware& board,
                                                     const std::filesystem::path& file) {
  std::size_t compared = 0;
  std::optional<sim::Time> differ;
  auto expected = recording.outputs.begin();
  auto inputs = recording.inputs.begin();
  for (sim::Time t{0}; inputs != recording.inputs.end(); t += Flight::kStep) {
    if (inputs->time < t || inputs->time - t > kMaxGap) {
      throw InputError(fmt::format(
          "{}: found inputs at {} us after {} us, allowed multiples of {} us in rising order, "
          "{} s apart at most",
          file.string(), inputs->time.count(), t.count(), Flight::kStep.count(),
          sim::to_seconds(kMaxGap)));
    }
    const hal::OutputValues& outputs = board.step(t, inputs->time == t ? *inputs++ : StepInputs{});
    const sim::Time end = t + Flight::kStep;
    while (expected != recording.outputs.end() && expected->time < end) ++expected;
    if (expected == recording.outputs.end() || expected->time != end) continue;
    ++compared;
    if (!differ && !same_bits(outputs, expected->values)) differ = end;
  }
  return {compared, differ};
}

}  // namespace

int replay_flight(const std::filesystem::path& log, std::ostream& out) {
  const std::filesystem::path file = std::filesystem::is_directory(log) ? log / "flight.mcap" : log;
  const Recording recording = recording_of(file);
  check(recording, file);
  const auto board = std::make_unique<ReplayedFirmware>(recording.flight.at("link_protocol"));
  const auto [steps, outputs_differ] = run(recording, *board, file);
  const auto& sent = board->sent();
  const auto [ours, theirs] =
      std::mismatch(sent.begin(), sent.end(), recording.sent.begin(), recording.sent.end());
  const bool same_frames = ours == sent.end() && theirs == recording.sent.end();
  const auto seconds = [](sim::Time t) { return sim::to_seconds(t); };
  if (same_frames) {
    fmt::print(out, "frames sent: {} equal\n", sent.size());
  } else {
    const auto at = theirs == recording.sent.end() ? ours->time : theirs->time;
    fmt::print(
        out,
        "frames sent: {} recorded, {} replayed, the first difference is frame {} at {:.4f} s\n",
        recording.sent.size(), sent.size(), ours - sent.begin() + 1, seconds(at));
  }
  if (outputs_differ) {
    fmt::print(out, "outputs: {} steps, the first difference is at {:.4f} s\n", steps,
               seconds(*outputs_differ));
  } else {
    fmt::print(out, "outputs: {} steps equal\n", steps);
  }
  const bool same = same_frames && !outputs_differ && steps > 0;
  fmt::print(out, "{}\n", same ? "same" : "DIFFERENT");
  return same ? 0 : 1;
}

}  // namespace rosflight::flight
