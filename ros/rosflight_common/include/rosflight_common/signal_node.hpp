// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/signal.hpp"

namespace rosflight_common {

/// Node signal_generator of both stacks: a waveform on top of a setpoint, for tuning.
///
/// It stands at its lower end until it is started; a pause keeps where it is, a reset goes back. A
/// step knows only toggle and reset. All parameters can be changed while it runs; the derived class
/// publishes a setpoint in publish(), publish_rate_hz times a second of node time.
class SignalNode : public rclcpp::Node {
 protected:
  /// @param services  prefix of their names.
  SignalNode(const std::string& services, const rclcpp::NodeOptions& options)
      : Node("signal_generator", options) {
    const std::string type =
        declare_parameter<std::string>("signal_type", "step", described(kWaveformNames, false));
    const auto form = waveform_named(type);
    if (!form) throw std::invalid_argument("parameter " + refusal(type));
    form_ = *form;
    magnitude_ = declare_number(*this, "signal_magnitude", 1.0, -1000.0, 1000.0,
                                "difference between the upper and the lower end", true);
    frequency_Hz_ = declare_number(*this, "frequency_hz", 0.2, 0.001, 100.0,
                                   "frequency of the signal [Hz]", true);
    rate_Hz_ =
        declare_number(*this, "publish_rate_hz", 100.0, 1.0, 1000.0, "setpoints per second [Hz]");
    changes_ = on_change_or_refuse(
        *this, [this](const std::vector<rclcpp::Parameter>& given) { return change(given); });
    serve(services);
    last_ = now();
    timer_ = rclcpp::create_timer(this, get_clock(), rclcpp::Duration::from_seconds(1.0 / rate_Hz_),
                                  [this] { tick(); });
  }

  virtual void publish() = 0;
  /// The signal with its lower end at `base`.
  double signal(double base) const { return sample(form_, base, magnitude_, periods_, up_); }

 private:
  using Trigger = std_srvs::srv::Trigger;
  enum class Run : std::uint8_t { kStopped, kOnce, kOn };

  static std::string refusal(const std::string& type) {
    return "signal_type: found '" + type + "', allowed " + kWaveformNames;
  }

  std::string change(const std::vector<rclcpp::Parameter>& given) {
    for (const auto& p : given) {
      if (p.get_name() == "signal_type" && !waveform_named(p.as_string()))
        return refusal(p.as_string());
    }
    for (const auto& p : given) {
      if (p.get_name() == "signal_type") {
        form_ = *waveform_named(p.as_string());
        stop();
      }
      if (p.get_name() == "signal_magnitude") magnitude_ = p.as_double();
      if (p.get_name() == "frequency_hz") frequency_Hz_ = p.as_double();
    }
    return "";
  }

  void stop() {
    run_ = Run::kStopped;
    periods_ = 0.0;
    up_ = false;
  }

  template <class Act>
  void serve_one(const std::string& name, bool step, bool waves, Act act) {
    services_.push_back(create_service<Trigger>(
        name, [this, name, step, waves, act](const std::shared_ptr<Trigger::Request>,
                                             std::shared_ptr<Trigger::Response> response) {
          response->success = form_ == Waveform::kStep ? step : waves;
          if (!response->success) {
            response->message =
                std::string("found signal_type ") +
                (form_ == Waveform::kStep ? "step, allowed the others" : "no step, allowed step");
            return;
          }
          act();
          response->message = "done";
        }));
  }

  void serve(const std::string& prefix) {
    serve_one(prefix + "toggle_step_signal", true, false, [this] { up_ = !up_; });
    serve_one(prefix + "reset_signal", true, true, [this] { stop(); });
    serve_one(prefix + "pause_signal", false, true, [this] { run_ = Run::kStopped; });
    serve_one(prefix + "start_continuous_signal", false, true, [this] { run_ = Run::kOn; });
    serve_one(prefix + "start_single_period_signal", false, true, [this] {
      stop();
      run_ = Run::kOnce;
    });
  }

  void tick() {
    const rclcpp::Time time = now();
    const double dt_s = (time - last_).seconds();
    last_ = time;
    if (run_ != Run::kStopped && dt_s > 0.0) periods_ += dt_s * frequency_Hz_;
    if (run_ == Run::kOnce && periods_ >= 1.0) stop();
    publish();
  }

  Waveform form_{Waveform::kStep};
  double magnitude_{};
  double frequency_Hz_{};
  double rate_Hz_{};
  double periods_{};
  Run run_{Run::kStopped};
  bool up_{false};
  rclcpp::Time last_;
  std::vector<rclcpp::Service<Trigger>::SharedPtr> services_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace rosflight_common
