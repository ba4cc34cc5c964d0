// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/conversation.hpp"

#include <utility>

#include "web/server/foxglove.hpp"

namespace rosflight::web::server {

Conversation::Conversation(const LiveData& live, const Admission& admission,
                           const std::string& session)
    : live_{live}, admission_{admission}, session_{session}, admitted_{!admission.wants_token()} {
  if (admitted_) greet();
}

bool Conversation::on_message(std::string_view message, bool is_text) {
  if (!admitted_) {
    admitted_ = admission_.is_token(foxglove::parse_token(message));
    if (admitted_) greet();
    return admitted_;
  }
  return is_text ? on_request(message) : complain("binary messages are not used here");
}

std::optional<Conversation::Frame> Conversation::next() {
  if (!admitted_) return std::nullopt;
  if (texts_.empty() && messages_.empty()) take_news();
  while (!messages_.empty() && !subscriptions_.at(messages_.front()->channel))
    messages_.pop_front();  // unsubscribed meanwhile
  Frame frame;
  if (!texts_.empty()) {
    frame = {true, std::move(texts_.front()), nullptr};
    texts_.pop_front();
  } else if (!messages_.empty()) {
    LiveData::Shared message = std::move(messages_.front());
    messages_.pop_front();
    const std::uint32_t id = subscriptions_[message->channel].value_or(0);
    frame = {false, foxglove::message_head(id, message->time_ns), std::move(message)};
  } else {
    return std::nullopt;
  }
  return frame;
}

void Conversation::greet() {
  texts_.push_back(foxglove::server_info("rosflight", session_));
}

void Conversation::take_news() {
  const std::size_t first = cursor_.channels;
  LiveData::News news = live_.news(cursor_);
  if (!news.channels.empty()) texts_.push_back(foxglove::advertise(first, news.channels));
  subscriptions_.resize(cursor_.channels);
  messages_.assign(news.messages.begin(), news.messages.end());
}

bool Conversation::on_request(std::string_view message) {
  const foxglove::Request request = foxglove::parse_request(message);
  if (!request.complaint.empty()) return complain(request.complaint);
  std::string unknown;
  for (const auto& [id, channel] : request.subscribe) {
    if (channel >= subscriptions_.size()) {
      unknown = "subscribe: no channel " + std::to_string(channel + 1);
      continue;
    }
    subscriptions_[channel] = id;
    cursor_.places[channel] = {true, 0, 0};
  }
  for (const std::uint32_t id : request.unsubscribe) {
    for (std::size_t k = 0; k < subscriptions_.size(); ++k) {
      if (subscriptions_[k] != id) continue;
      subscriptions_[k].reset();
      cursor_.places[k].wanted = false;
    }
  }
  return unknown.empty() || complain(unknown);
}

bool Conversation::complain(const std::string& what) {
  texts_.push_back(foxglove::status_error(what));
  return texts_.size() <= kMostUnreadTexts;
}

}  // namespace rosflight::web::server
