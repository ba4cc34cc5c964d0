// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/live_log.hpp"

#include <string>

#include "log/topic_kinds.hpp"

namespace rosflight::viewer {

using web::server::LiveData;

void LiveLog::on_logged(log::Topic topic, std::uint64_t time_ns, log::Bytes cdr) {
  const log::TopicKind topic_kind = log::kind_of(topic);
  if (topic_kind == log::TopicKind::kBulk) return;
  auto& channel = channels_.at(static_cast<std::size_t>(topic));
  if (!channel) {
    const log::TopicType& type = log::kTopics.at(static_cast<std::size_t>(topic));
    const auto kind =
        topic_kind == log::TopicKind::kEvent ? LiveData::Kind::kEvent : LiveData::Kind::kState;
    channel = data_.add_channel(
        {std::string(type.name), std::string(type.type), std::string(type.schema()), kind});
  }
  data_.put(*channel, time_ns, cdr);
}

void LiveLog::restart() {
  data_.restart();
  channels_.fill(std::nullopt);
}

}  // namespace rosflight::viewer
