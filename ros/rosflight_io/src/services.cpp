// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/services.hpp"

#include <utility>

#include "companion/load_summary.hpp"
#include "rosflight_common/paths.hpp"
#include "rosflight_io/mixing_matrix.hpp"

namespace rosflight_io {

namespace companion = rosflight::companion;
using rosflight::link::Command;
using rosflight_msgs::srv::ParamFile;
using rosflight_msgs::srv::ParamGet;
using rosflight_msgs::srv::ParamSet;

namespace {

/// Answers a trigger with the outcome of a job.
template <class Result, class Reply>
void reply_when_finished(companion::Job<Result> job, const Reply& reply) {
  job.when_finished([job, reply] {
    std_srvs::srv::Trigger::Response response;
    response.success = job.done();
    response.message = job.text();
    reply(response);
  });
}

}  // namespace

Services::Services(rclcpp::Node& node, companion::Runner& runner)
    : node_{node}, runner_{runner}, mag_{runner.session()} {
  mag_.on_prompt([logger = node.get_logger()](const std::string& line) {
    RCLCPP_INFO(logger, "Magnetometer: %s", line.c_str());
  });
  offer_parameters();
  offer_files();
  offer_command("param_write", Command::kWriteParams);
  offer_command("calibrate_imu", Command::kAccelCalibration);
  offer_command("calibrate_rc_trim", Command::kRcCalibration);
  offer_command("reboot", Command::kReboot);
  offer_command("reboot_to_bootloader", Command::kRebootToBootloader);
  offer<Trigger>("calibrate_mag",
                 [this](Session&, const Trigger::Request&, const Reply<Trigger>& reply) {
                   reply_when_finished(mag_.start(), reply);
                 });
}

void Services::offer_baro() {
  if (!std::exchange(has_baro_, true)) offer_command("calibrate_baro", Command::kBaroCalibration);
}

void Services::offer_airspeed() {
  if (std::exchange(has_airspeed_, true)) return;
  offer_command("calibrate_airspeed", Command::kAirspeedCalibration);
}

template <class Service>
void Services::offer(const std::string& name, Handler<Service> handler) {
  using Server = rclcpp::Service<Service>;
  services_.push_back(node_.create_service<Service>(
      name, [this, handler = std::move(handler)](
                std::shared_ptr<Server> server, std::shared_ptr<rmw_request_id_t> id,
                std::shared_ptr<typename Service::Request> request) {
        const auto reply = [server, id](typename Service::Response response) {
          server->send_response(*id, response);
        };
        runner_.post(
            [handler, request, reply](Session& session) { handler(session, *request, reply); });
      }));
}

void Services::offer_command(const std::string& name, Command command) {
  offer<Trigger>(name,
                 [command](Session& session, const Trigger::Request&, const Reply<Trigger>& reply) {
                   reply_when_finished(session.commands().start(command), reply);
                 });
}

void Services::offer_parameters() {
  offer<ParamGet>("param_get", [](Session& session, const ParamGet::Request& request,
                                  const Reply<ParamGet>& reply) {
    ParamGet::Response response;
    const auto value = session.parameters().get(request.name);
    response.exists = value.has_value();
    response.value = value ? value->number() : 0.0;
    reply(response);
  });
  offer<ParamSet>("param_set", [logger = node_.get_logger()](Session& session,
                                                             const ParamSet::Request& request,
                                                             const Reply<ParamSet>& reply) {
    companion::Job<companion::ParameterResult> job =
        session.parameters().set(request.name, request.value);
    job.when_finished([job, reply, logger] {
      using Outcome = companion::ParameterOutcome;
      const companion::ParameterResult& result = job.result();
      if (!result.ok()) RCLCPP_ERROR(logger, "%s", result.text.c_str());
      // The type has one flag: true is "the firmware has it and this value is in force".
      ParamSet::Response response;
      response.exists = result.outcome == Outcome::kSet || result.outcome == Outcome::kUnchanged;
      reply(response);
    });
  });
  offer<Trigger>("all_params_received",
                 [](Session& session, const Trigger::Request&, const Reply<Trigger>& reply) {
                   const companion::ParameterTable& table = session.parameters().table();
                   Trigger::Response response;
                   response.success = table.complete();
                   response.message = response.success ? "All parameters received"
                                                       : std::to_string(table.known()) + " of " +
                                                             std::to_string(table.count()) +
                                                             " parameters received";
                   reply(response);
                 });
  offer<Trigger>("print_mixing_matrix",
                 [logger = node_.get_logger()](Session& session, const Trigger::Request&,
                                               const Reply<Trigger>& reply) {
                   Trigger::Response response;
                   response.success = session.parameters().complete();
                   response.message = response.success ? mixing_matrix_text(session.parameters())
                                                       : "parameters are not complete yet";
                   RCLCPP_INFO(logger, "%s", response.message.c_str());
                   reply(response);
                 });
}

void Services::offer_files() {
  offer<ParamFile>("param_load_from_file", [logger = node_.get_logger()](
                                               Session& session, const ParamFile::Request& request,
                                               const Reply<ParamFile>& reply) {
    companion::Job<companion::LoadReport> job =
        session.parameters().load_file(rosflight_common::user_path(request.filename));
    job.when_finished([job, reply, logger] {
      for (const companion::ParameterResult& entry : job.result().entries) {
        if (entry.ok()) {
          RCLCPP_DEBUG(logger, "%s", entry.text.c_str());
        } else {
          RCLCPP_ERROR(logger, "%s", entry.text.c_str());
        }
      }
      const std::string text =
          job.result().entries.empty() ? job.text() : companion::count_text(job.result());
      if (job.done()) {
        RCLCPP_INFO(logger, "%s", text.c_str());
      } else {
        RCLCPP_ERROR(logger, "%s", text.c_str());
      }
      ParamFile::Response response;
      response.success = job.done();
      reply(response);
    });
  });
  offer<ParamFile>("param_save_to_file", [logger = node_.get_logger()](
                                             Session& session, const ParamFile::Request& request,
                                             const Reply<ParamFile>& reply) {
    auto job = session.parameters().save_file(rosflight_common::user_path(request.filename));
    job.when_finished([job, reply, logger] {
      if (job.done()) {
        RCLCPP_INFO(logger, "%s", job.text().c_str());
      } else {
        RCLCPP_ERROR(logger, "%s", job.text().c_str());
      }
      ParamFile::Response response;
      response.success = job.done();
      reply(response);
    });
  });
}

}  // namespace rosflight_io
