// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/command_desk.hpp"

#include <algorithm>

namespace rosflight::web::server {

std::size_t CommandDesk::size(const Command& command) {
  const auto* set = std::get_if<SetParameters>(&command.what);
  return 1 + (set != nullptr ? set->values.size() : 0);
}

std::string CommandDesk::ask(Command command) {
  const std::scoped_lock lock(mutex_);
  if (!closed_.empty()) return closed_;
  std::size_t waiting = size(command);
  for (const Command& other : commands_) waiting += size(other);
  if (waiting > kMaxWaiting) return "too many commands wait";
  commands_.push_back(std::move(command));
  return {};
}

std::vector<CommandDesk::Answer> CommandDesk::answers(std::uint64_t viewer) {
  const std::scoped_lock lock(mutex_);
  const auto mine = std::stable_partition(answers_.begin(), answers_.end(),
                                          [viewer](const Answer& a) { return a.viewer != viewer; });
  std::vector<Answer> taken(std::make_move_iterator(mine), std::make_move_iterator(answers_.end()));
  answers_.erase(mine, answers_.end());
  return taken;
}

void CommandDesk::forget(std::uint64_t viewer) {
  static_cast<void>(answers(viewer));
  const std::scoped_lock lock(mutex_);
  if (closed_.empty()) commands_.push_back({viewer, {}, Gone{}});
}

CommandDesk::Control CommandDesk::control() const {
  const std::scoped_lock lock(mutex_);
  return control_;
}

void CommandDesk::set_control(const Control& control) {
  const std::scoped_lock lock(mutex_);
  control_ = control;
}

std::shared_ptr<const CommandDesk::Parameters> CommandDesk::parameters() const {
  const std::scoped_lock lock(mutex_);
  return parameters_;
}

std::vector<CommandDesk::Command> CommandDesk::commands() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(commands_, {});
}

void CommandDesk::answer(Answer answer) {
  const std::scoped_lock lock(mutex_);
  // The oldest are of viewers that are gone: all others take theirs many times a second.
  if (answers_.size() == kMaxWaiting) answers_.erase(answers_.begin());
  answers_.push_back(std::move(answer));
}

void CommandDesk::set_parameters(Parameters parameters) {
  auto shared = std::make_shared<const Parameters>(std::move(parameters));
  const std::scoped_lock lock(mutex_);
  parameters_ = std::move(shared);
}

void CommandDesk::close(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  closed_ = why;
  for (Command& command : std::exchange(commands_, {}))
    answers_.push_back({command.viewer, std::move(command.id), {{{}, {}, false, why}}});
}

}  // namespace rosflight::web::server
