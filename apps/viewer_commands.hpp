// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "flight/commander.hpp"
#include "web/server/command_desk.hpp"

namespace rosflight::apps {

/// Does what viewers of the page command (CommandDesk) over the companion's session.
class ViewerCommands final : public flight::Commander {
 public:
  /// @param desk  must outlive this.
  explicit ViewerCommands(web::server::CommandDesk& desk) : desk_{desk} {}

  void step(companion::Session& session, sim::Time now,
            const flight::MissionRunner::Notify& note) override;
  void end() override;

 private:
  using Desk = web::server::CommandDesk;
  using Load = companion::Job<companion::LoadReport>;
  using Plain = companion::Job<companion::CommandResult>;
  /// Who is to get the answer, and what it waits for.
  struct Waiting {
    Desk::Answer answer;  ///< With results that are known already.
    Load load;
    std::optional<Plain> plain;
  };

  void start(const Desk::Command& command, companion::Session& session, sim::Time now,
             const flight::MissionRunner::Notify& note);
  void start_load(const Desk::SetParameters& set, companion::Session& session, Waiting& waiting);
  void publish_parameters(const companion::ParameterClient& client);

  Desk& desk_;
  std::vector<Waiting> waiting_;
  std::optional<std::pair<std::uint64_t, bool>> published_;  ///< Revision, unsaved.
};

}  // namespace rosflight::apps
