// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/live_log.hpp"

#include <string>

#include "log/topic_kinds.hpp"

namespace rosflight::viewer {

using web::server::LiveData;

namespace {

LiveData::Kind kind_of_channel(log::TopicKind kind) {
  if (kind == log::TopicKind::kEvent) return LiveData::Kind::kEvent;
  return kind == log::TopicKind::kExchange ? LiveData::Kind::kExchange : LiveData::Kind::kState;
}

}  // namespace

void LiveLog::on_logged(log::Topic topic, std::uint64_t time_ns, log::Bytes cdr) {
  const log::TopicKind topic_kind = log::kind_of(topic);
  if (topic_kind == log::TopicKind::kBulk) return;
  auto& channel = channels_.at(static_cast<std::size_t>(topic));
  if (!channel) {
    const log::TopicType& type = log::kTopics.at(static_cast<std::size_t>(topic));
    channel = data_.add_channel({std::string(type.name), std::string(type.type),
                                 std::string(type.schema()), kind_of_channel(topic_kind)});
  }
  data_.put(*channel, time_ns, cdr);
}

void LiveLog::restart() {
  data_.restart();
  channels_.fill(std::nullopt);
}

}  // namespace rosflight::viewer
