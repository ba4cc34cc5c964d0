// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rosflight::web::server {

/// What viewers command, on its way to the thread that has the vehicle, and the answers on their way
/// back.
///
/// The thread of the vehicle takes commands when it likes and waits for nobody. It also leaves its
/// parameters here, for viewers that ask.
class CommandDesk {
 public:
  /// Commands and values on their way, of all viewers together.
  static constexpr std::size_t kMaxWaiting = 1024;

  struct SetParameters {
    std::vector<std::pair<std::string, double>> values;
  };
  struct WriteParameters {};  ///< To the memory that survives power-off.
  struct ReportChecks {};     ///< The checks before arming, each as a message of the log.
  struct TakeControl {};      ///< What belongs to one viewer at a time is this one's.
  struct Steer {
    std::string text;  ///< A change of the simulation (flight/steering.hpp).
  };
  /// One motor turns for 0.3 s, by the firmware's own rule; a viewer repeats it while a button is held.
  struct TestMotor {
    std::uint8_t motor{};  ///< Output, from 0.
    double value{};        ///< 0 to 1; the firmware has a limit of its own.
  };
  struct Calibrate {
    std::string
        sensor;  ///< gyro, accel, baro, airspeed; of a vehicle on a link also mag, rc, esc_props_off, stop.
  };
  struct Gone {};  ///< The viewer is no longer connected; nobody waits for the answer.
  using What = std::variant<SetParameters, WriteParameters, ReportChecks, TakeControl, Steer,
                            TestMotor, Calibrate, Gone>;
  struct Command {
    std::uint64_t viewer{};
    std::string id;  ///< The viewer's own, for the answer.
    What what;
  };
  struct Result {
    std::string name;             ///< Name of the parameter; empty if the command has none.
    std::optional<double> value;  ///< In force at the end, if it is known.
    bool good{};
    std::string text;  ///< One line with the outcome and its reason.
  };
  struct Answer {
    std::uint64_t viewer{};
    std::string id;
    std::vector<Result> results;
  };
  struct Parameter {
    std::string name;
    double value{};
    bool is_float{};
  };
  /// Who steers, and how the simulation goes on.
  struct Control {
    std::uint64_t viewer{};  ///< 0: nobody.
    bool simulated{};        ///< There is a simulation to steer.
    bool paused{};
    double speed{1.0};  ///< Times real time.
    bool operator==(const Control&) const = default;
  };
  struct Parameters {
    std::vector<Parameter> all;
    bool unsaved{};  ///< Some are not in the memory that survives power-off.
  };

  // For the server.
  /// @returns why it is refused at once; empty: an answer will come.
  std::string ask(Command command);
  /// Those for this viewer since the last call.
  std::vector<Answer> answers(std::uint64_t viewer);
  /// It is gone.
  void forget(std::uint64_t viewer);
  /// nullptr: not known yet.
  std::shared_ptr<const Parameters> parameters() const;
  Control control() const;

  // For the thread of the vehicle.
  /// Those since the last call.
  std::vector<Command> commands();
  void answer(Answer answer);
  void set_parameters(Parameters parameters);
  void set_control(const Control& control);
  /// From now on commands are refused with this reason, also those that still wait.
  void close(const std::string& why);

 private:
  static std::size_t size(const Command& command);

  mutable std::mutex mutex_;
  std::vector<Command> commands_;
  std::vector<Answer> answers_;
  std::shared_ptr<const Parameters> parameters_;
  Control control_;
  std::string closed_;
};

}  // namespace rosflight::web::server
