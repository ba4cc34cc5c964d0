// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <std_srvs/srv/trigger.hpp>

#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"

namespace rosflight_sim {
namespace {

using namespace rosflight_common;

using Trigger = std_srvs::srv::Trigger;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Asks the board for one step at every tick of node time, or on request.
///
/// One step at a time. A tick that comes before the step has been answered is made up for as soon
/// as it is; more than one are skipped, counted and said. An answer that does not come within
/// service_result_timeout_ms is waited for no longer.
class SilManager : public rclcpp::Node {
 public:
  explicit SilManager(const rclcpp::NodeOptions& options) : Node("rosflight_sil_manager", options) {
    frequency_Hz_ = declare_number(*this, "simulation_loop_frequency", 400.0, 10.0, 2000.0,
                                   "steps of the board per second of node time [Hz]", true);
    const bool use_timer = declare_switch(
        *this, "use_timer", true, "steps by a timer; false: only by rosflight_sil/take_sim_step");
    exists_ms_ =
        declare_integer(*this, "service_exists_timeout_ms", 500, 1, 10'000,
                        "maximum time that take_sim_step waits for the service sil_board/run [ms]");
    result_ms_ = declare_integer(*this, "service_result_timeout_ms", 500, 1, 10'000,
                                 "maximum duration of a step [ms]");
    steps_ = create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
    client_ = client_in_group<Trigger>(*this, "sil_board/run", steps_);
    by_hand_ = client_in_group<Trigger>(*this, "sil_board/run", steps_);
    service_ = create_service<Trigger>(
        "rosflight_sil/take_sim_step",
        [this](const std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> answer) {
          take_step(*answer);
        });
    changes_ = on_change(*this, [this](const rclcpp::Parameter& p) {
      if (p.get_name() != "simulation_loop_frequency") return;
      frequency_Hz_ = p.as_double();
      if (timer_ != nullptr) start();
    });
    report_from_ = steady_clock::now();
    if (use_timer) start();
  }

 private:
  void start() {
    const rclcpp::Duration period(
        std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / frequency_Hz_)));
    timer_ = rclcpp::create_timer(this, get_clock(), period, [this] { tick(); }, steps_);
  }

  void tick() {
    ++ticks_;
    const auto now = steady_clock::now();
    if (busy_ && now - asked_ > milliseconds(result_ms_)) {
      client_->prune_pending_requests();
      busy_ = false;
      board_answers_ = false;
    }
    if (!board_answers_ && !client_->service_is_ready()) {
      ++skipped_;
    } else if (!busy_) {
      ask();
    } else {
      skipped_ += due_ ? 1 : 0;
      due_ = true;
    }
    report(now);
  }

  void ask() {
    busy_ = true;
    due_ = false;
    asked_ = steady_clock::now();
    const std::uint64_t number = ++number_;
    client_->async_send_request(std::make_shared<Trigger::Request>(),
                                [this, number](rclcpp::Client<Trigger>::SharedFuture) {
                                  if (number != number_) return;
                                  busy_ = false;
                                  board_answers_ = true;
                                  if (due_) ask();
                                });
  }

  void report(steady_clock::time_point now) {
    constexpr auto kInterval = std::chrono::seconds(5);
    if (now - report_from_ < kInterval) return;
    constexpr std::uint64_t kWorthSaying = 100;  // one in this many
    if (skipped_ * kWorthSaying > ticks_) {
      RCLCPP_WARN(get_logger(), "%lu of %lu steps skipped in %ld s: the board did not answer",
                  skipped_, ticks_, static_cast<long>(kInterval.count()));
    }
    report_from_ = now;
    ticks_ = skipped_ = 0;
  }

  /// A caller waits for the end of the step, in a thread of its own.
  void take_step(Trigger::Response& answer) {
    answer.success = false;
    if (!by_hand_->wait_for_service(milliseconds(exists_ms_))) {
      answer.message = "found no service sil_board/run, allowed with the board running";
      return;
    }
    auto future = by_hand_->async_send_request(std::make_shared<Trigger::Request>());
    if (future.wait_for(milliseconds(result_ms_)) != std::future_status::ready) {
      by_hand_->remove_pending_request(future);
      answer.message = "found no answer of sil_board/run in time";
      return;
    }
    answer = *future.get();
  }

  double frequency_Hz_{};
  std::int64_t exists_ms_{};
  std::int64_t result_ms_{};
  bool busy_{false};  ///< With the members below: of the group of steps, one callback at a time.
  bool due_{false};   ///< A tick came while busy.
  bool board_answers_{false};  ///< Then it is not looked for: that walks through all topics of ROS.
  steady_clock::time_point asked_;
  std::uint64_t number_{0};
  std::uint64_t ticks_{0};
  std::uint64_t skipped_{0};
  steady_clock::time_point report_from_;
  rclcpp::CallbackGroup::SharedPtr steps_;
  rclcpp::Client<Trigger>::SharedPtr client_;
  rclcpp::Client<Trigger>::SharedPtr by_hand_;
  rclcpp::Service<Trigger>::SharedPtr service_;
  rclcpp::TimerBase::SharedPtr timer_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_WAITS_IN_CALLBACKS
ROSFLIGHT_NODE(rosflight_sim::SilManager, MultiThreadedExecutor)
