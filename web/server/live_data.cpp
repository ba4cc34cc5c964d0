// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/live_data.hpp"

#include <algorithm>
#include <utility>

namespace rosflight::web::server {

void LiveData::restart() {
  const std::scoped_lock lock(mutex_);
  ++run_;
  channels_.clear();
  newest_.clear();
  events_.clear();
  event_bytes_ = 0;
}

std::size_t LiveData::add_channel(Channel channel) {
  const std::scoped_lock lock(mutex_);
  channels_.push_back(std::move(channel));
  newest_.emplace_back();
  return channels_.size() - 1;
}

void LiveData::put(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> cdr) {
  auto message = std::make_shared<const Message>(
      Message{channel, time_ns, std::vector<std::uint8_t>(cdr.begin(), cdr.end())});
  const std::scoped_lock lock(mutex_);
  const Kind kind = channels_.at(channel).kind;
  if (kind != Kind::kEvent) {
    Newest& newest = newest_[channel];
    ++newest.version;
    newest.kept.push_back(std::move(message));
    if (newest.kept.size() > (kind == Kind::kState ? 1 : kKeptOfExchange)) newest.kept.pop_front();
  } else if (event_bytes_ + cdr.size() > kMaxEventBytes) {
    ++lost_;
  } else {
    event_bytes_ += cdr.size();
    events_.push_back(std::move(message));
  }
}

LiveData::News LiveData::news(Cursor& cursor) const {
  News news;
  const std::scoped_lock lock(mutex_);
  if (cursor.run == 0) cursor.run = run_;
  news.restarted = cursor.run != run_;
  if (news.restarted) return news;
  for (; cursor.channels < channels_.size(); ++cursor.channels)
    news.channels.push_back(channels_[cursor.channels]);
  cursor.channel_states.resize(channels_.size());
  add_events(cursor, news);
  for (std::size_t k = 0; k < newest_.size(); ++k) {
    Cursor::ChannelState& state = cursor.channel_states[k];
    if (!state.wanted) continue;
    const auto& [version, kept] = newest_[k];
    const auto missed = std::min<std::uint64_t>(version - state.version, kept.size());
    state.version = version;
    news.messages.insert(news.messages.end(), kept.end() - static_cast<std::ptrdiff_t>(missed),
                         kept.end());
  }
  return news;
}

void LiveData::add_events(Cursor& cursor, News& news) const {
  std::size_t first = events_.size();
  for (const Cursor::ChannelState& state : cursor.channel_states) {
    if (state.wanted) first = std::min(first, state.next_event);
  }
  for (std::size_t k = first; k < events_.size(); ++k) {
    const Cursor::ChannelState& state = cursor.channel_states[events_[k]->channel];
    if (state.wanted && k >= state.next_event) news.messages.push_back(events_[k]);
  }
  for (Cursor::ChannelState& state : cursor.channel_states) {
    if (state.wanted) state.next_event = events_.size();
  }
}

std::uint64_t LiveData::events_lost() const {
  const std::scoped_lock lock(mutex_);
  return lost_;
}

}  // namespace rosflight::web::server
