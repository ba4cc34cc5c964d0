// SPDX-License-Identifier: BSD-3-Clause
#include "log/log_extract.hpp"

#include <algorithm>
#include <utility>

#include "log/topic_kinds.hpp"

namespace rosflight::log {

namespace {

/// Made for ROS tools of what /sim/truth_state, /autonomy/estimate and /gnss have.
bool is_drawn(Topic topic) {
  return topic == Topic::kTf || topic == Topic::kPose || topic == Topic::kOdometry ||
         topic == Topic::kEstimateOdometry || topic == Topic::kFix;
}

McapWriter::Options unpacked() {
  McapWriter::Options options;
  options.compression = Compression::kNone;
  return options;
}

}  // namespace

LogExtract::LogExtract(std::filesystem::path path, const TextMap& flight)
    : writer_(std::move(path), unpacked()) {
  static_assert(kTopics.size() <= kMaxTopics);
  writer_.add_metadata("flight", flight);
}

void LogExtract::on_logged(Topic topic, std::uint64_t time_ns, Bytes cdr) {
  constexpr std::uint64_t kInterval_ns = std::uint64_t{kInterval_ms} * 1'000'000U;
  const TopicKind kind = kind_of(topic);
  if (kind == TopicKind::kBulk || is_drawn(topic)) return;
  if (kind == TopicKind::kState) {
    std::uint64_t& next_ns = next_due_ns_.at(static_cast<std::size_t>(topic));
    if (time_ns < next_ns) return;
    next_ns = (time_ns / kInterval_ns + 1) * kInterval_ns;
  }
  Kept& kept = kept_.at(static_cast<std::size_t>(topic));
  kept.bytes.insert(kept.bytes.end(), cdr.begin(), cdr.end());
  kept.messages.push_back({time_ns, kept.bytes.size()});
  kept_bytes_ += cdr.size();
  if (kept_bytes_ > kMaxKept_bytes) write_kept();
}

LogSummary LogExtract::close() {
  write_kept();
  return writer_.close();
}

std::string LogExtract::without_indexes(Bytes mcap) {
  constexpr std::size_t kMagic = 8;
  constexpr std::size_t kHead = 9;  // opcode and length of a record
  constexpr std::uint8_t kFooter = 2;
  constexpr std::uint8_t kMessageIndex = 7;
  constexpr std::uint8_t kDataEnd = 15;
  constexpr std::size_t kFooterBytes = 20;  // no summary: all 0
  std::string out(mcap.begin(), mcap.begin() + kMagic);
  for (std::size_t at = kMagic; at + kHead <= mcap.size();) {
    std::size_t end = at + kHead;
    for (std::size_t k = 0; k < 8; ++k) end += std::size_t{mcap[at + 1 + k]} << (8 * k);
    if (mcap[at] != kMessageIndex) {
      for (const std::uint8_t byte : mcap.subspan(at, end - at)) out += static_cast<char>(byte);
    }
    if (mcap[at] == kDataEnd) break;
    at = end;
  }
  out += {kFooter, kFooterBytes, 0, 0, 0, 0, 0, 0, 0};
  out.append(kFooterBytes, '\0');
  return out.append(mcap.begin(), mcap.begin() + kMagic);
}

void LogExtract::write_kept() {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (!kept_[k].messages.empty()) order.push_back(k);
  }
  const auto first_ns = [this](std::size_t k) { return kept_[k].messages.front().time_ns; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return first_ns(a) < first_ns(b); });
  for (const std::size_t k : order) {
    const Bytes bytes = kept_[k].bytes;
    std::size_t start = 0;
    for (const MessageEnd& each : kept_[k].messages) {
      writer_.write(channel(k), each.time_ns, each.time_ns, bytes.subspan(start, each.end - start));
      start = each.end;
    }
    kept_[k] = {};
  }
  kept_bytes_ = 0;
}

McapWriter::ChannelId LogExtract::channel(std::size_t index) {
  if (channels_.at(index) == 0) {
    const TopicType& type = kTopics.at(index);
    channels_[index] = writer_.add_channel(
        type.name, writer_.add_schema(type.type, "ros2msg", type.schema()), "cdr");
  }
  return channels_[index];
}

}  // namespace rosflight::log
