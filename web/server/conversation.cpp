// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/conversation.hpp"

#include <algorithm>
#include <utility>

#include "web/server/foxglove.hpp"

namespace rosflight::web::server {

Conversation::Conversation(const LiveData& live, CommandDesk* desk, const Admission& admission,
                           const std::string& session, std::uint64_t viewer, Right most)
    : live_{live},
      desk_{desk},
      admission_{admission},
      session_{session},
      viewer_{viewer},
      most_{most},
      right_{admission.wants_token() ? Right::kNone : most} {
  if (is_admitted()) greet();
}

Conversation::~Conversation() {
  if (desk_ != nullptr) desk_->forget(viewer_);
}

bool Conversation::on_message(std::string_view message, bool is_text) {
  if (!is_admitted()) {
    right_ = std::min(most_, admission_.right_of(foxglove::parse_token(message)));
    if (is_admitted()) greet();
    return is_admitted();
  }
  return is_text ? on_request(message) : complain("binary messages are not used here");
}

std::optional<Conversation::Frame> Conversation::next() {
  if (!is_admitted()) return std::nullopt;
  if (texts_.empty() && messages_.empty() && answers_.empty()) take_news();
  while (!messages_.empty() && !subscriptions_.at(messages_.front()->channel))
    messages_.pop_front();  // unsubscribed meanwhile
  Frame frame;
  std::deque<std::string>& texts = texts_.empty() && messages_.empty() ? answers_ : texts_;
  if (!texts.empty()) {
    frame = {true, std::move(texts.front()), nullptr};
    texts.pop_front();
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
  const bool commands = desk_ != nullptr && right_ == Right::kCommand;
  texts_.push_back(foxglove::server_info("rosflight", session_, desk_ != nullptr, commands));
}

void Conversation::take_answers() {
  for (const CommandDesk::Answer& answer : desk_->answers(viewer_))
    answers_.push_back(foxglove::command_results(answer));
  if (const CommandDesk::Control control = desk_->control(); control_ != control) {
    control_ = control;
    answers_.push_back(foxglove::control_text(control, viewer_));
  }
  const auto parameters = desk_->parameters();
  if (parameters == nullptr || unsaved_ == parameters->unsaved) return;
  unsaved_ = parameters->unsaved;
  answers_.push_back(foxglove::parameters_unsaved(*unsaved_));
}

void Conversation::take_news() {
  if (desk_ != nullptr) take_answers();
  const std::size_t first = cursor_.channels;
  LiveData::News news = live_.news(cursor_);
  over_ = news.restarted;
  if (over_) return;  // answers are still sent
  if (!news.channels.empty()) texts_.push_back(foxglove::advertise(first, news.channels));
  subscriptions_.resize(cursor_.channels);
  messages_.assign(news.messages.begin(), news.messages.end());
}

bool Conversation::on_request(std::string_view message) {
  const foxglove::Request request = foxglove::parse_request(message);
  if (!request.complaint.empty()) return complain(request.complaint);
  if (request.get_parameters) return on_parameters(*request.get_parameters, request.id);
  if (request.command) return on_command(*request.command, request.id);
  std::string unknown;
  for (const auto& [id, channel] : request.subscribe) {
    if (channel >= subscriptions_.size()) {
      unknown = "subscribe: no channel " + std::to_string(channel + 1);
      continue;
    }
    subscriptions_[channel] = id;
    cursor_.channel_states[channel] = {true, 0, 0};
  }
  for (const std::uint32_t id : request.unsubscribe) {
    for (std::size_t k = 0; k < subscriptions_.size(); ++k) {
      if (subscriptions_[k] != id) continue;
      subscriptions_[k].reset();
      cursor_.channel_states[k].wanted = false;
    }
  }
  return unknown.empty() || complain(unknown);
}

bool Conversation::on_parameters(const std::vector<std::string>& names, const std::string& id) {
  const auto parameters = desk_ != nullptr ? desk_->parameters() : nullptr;
  if (parameters == nullptr) return complain("getParameters: none are known here");
  texts_.push_back(foxglove::parameter_values(*parameters, names, id));
  return texts_.size() <= kMaxUnreadTexts;
}

bool Conversation::on_command(CommandDesk::What what, const std::string& id) {
  if (desk_ == nullptr) return complain("nothing can be commanded here");
  if (right_ != Right::kCommand) {
    return complain(most_ == Right::kCommand ? "this address is one to look, not to command"
                                             : "a page of another origin may look, not command");
  }
  const std::string refusal = desk_->ask({viewer_, id, std::move(what)});
  if (refusal.empty()) return true;
  texts_.push_back(foxglove::command_results({viewer_, id, {{{}, {}, false, refusal}}}));
  return texts_.size() <= kMaxUnreadTexts;
}

bool Conversation::complain(const std::string& what) {
  texts_.push_back(foxglove::status_error(what));
  return texts_.size() <= kMaxUnreadTexts;
}

}  // namespace rosflight::web::server
