// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "companion/session.hpp"
#include "ground/sensor_calibration.hpp"
#include "web/server/command_desk.hpp"

namespace rosflight::viewer {

/// Does what viewers of the page command (CommandDesk): to the vehicle over the companion's session, and to
/// the simulation if there is one.
///
/// Control belongs to one viewer at a time, who takes it, also from another. All commands need it but the
/// request for the checks before arming, which changes nothing. The log has each command, and each that was
/// refused with the reason.
class ViewerCommands {
 public:
  using What = web::server::CommandDesk::What;
  /// Takes a line for the log: a viewer and what it does.
  using Log = std::function<void(std::uint64_t viewer, const std::string& text)>;
  /// Understands a change of the simulation; the result does it. @throws config::Error
  using ParseChange = std::function<std::function<void()>(const std::string& text)>;

  /// @param desk  must outlive this. @param parse_change  none: a real vehicle.
  explicit ViewerCommands(web::server::CommandDesk& desk, ParseChange parse_change = {});

  /// Starts what was commanded, and answers what has ended. Call it in each step, in the thread of the
  /// session.
  void step(companion::Session& session, const Log& log);
  /// Its first half, for a simulation that stands still.
  void take(companion::Session& session, const Log& log);
  /// Nothing is done any more, for this reason.
  void end(const std::string& why);

  /// Starts one command, as if it came from the desk.
  void start(const web::server::CommandDesk::Command& command, companion::Session& session,
             const Log& log);

  // Calibrations that a person does. The owner of the link runs them, one at a time.
  /// Their names; none at first.
  void set_procedures(std::vector<std::string> names) { procedures_ = std::move(names); }
  /// The name of one that was commanded since the last call.
  std::optional<std::string> begin_procedure();
  /// Its viewer stopped it, or no longer has control.
  bool procedure_stopped() const;
  /// Writes a line for the person to the log.
  void log_line(const std::string& line, const Log& log) const;
  void end_procedure(bool good, std::string text);

  /// 0: nobody.
  std::uint64_t in_control() const { return in_control_; }
  /// Without a line for a log. @param viewer  0: nobody.
  void give_control(std::uint64_t viewer) { in_control_ = viewer; }

 private:
  using Desk = web::server::CommandDesk;
  using Load = companion::Job<companion::LoadReport>;
  using Plain = companion::Job<companion::CommandResult>;
  /// Who is to get the answer, and what it waits for.
  struct Waiting {
    Desk::Answer answer;  ///< With results that are known already.
    Load load;
    std::optional<Plain> plain;
    std::unique_ptr<ground::SensorCalibration> calibration;

    bool pending();
  };
  struct Procedure {
    Desk::Answer answer;  ///< Without results.
    std::string name;
    bool begun{false};
    bool stopped{false};
  };

  /// @returns why a viewer may not; empty: it may.
  std::string refusal(const Desk::Command& command) const;
  std::string refusal_of_calibration(const std::string& name) const;
  void refuse(const Desk::Command& command, std::string why, const Log& log);
  void start_on_vehicle(const Desk::Command& command, companion::Session& session);
  /// @returns whether it runs by itself: the others wait for a person, or stop what runs.
  bool start_calibration(const Desk::Command& command, const std::string& name,
                         companion::Session& session, Waiting& waiting);
  void start_load(const Desk::SetParameters& set, companion::Session& session, Waiting& waiting);
  void answer(const Desk::Command& command, bool good, std::string text);
  void publish_parameters(const companion::ParameterClient& client);

  Desk& desk_;
  ParseChange parse_change_;
  std::uint64_t in_control_{0};
  std::vector<Waiting> waiting_;
  std::vector<std::string> procedures_;
  std::optional<Procedure> procedure_;
  std::optional<std::pair<std::uint64_t, bool>> published_;  ///< Revision, unsaved.
};

/// What a command is in the log, and back. @returns nothing for a text that is none.
std::string text_of(const ViewerCommands::What& what);
std::optional<ViewerCommands::What> parse_command(std::string_view text);
/// Whether it is what the log has of a command that was refused: "is refused: COMMAND: REASON".
bool is_refusal(std::string_view text);

}  // namespace rosflight::viewer
