// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
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
/// service_result_timeout_ms is waited for no longer. No callback waits, so one thread does all.
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
    client_ = create_client<Trigger>("sil_board/run");
    by_hand_ = create_client<Trigger>("sil_board/run");
    service_ = create_service<Trigger>(
        "rosflight_sil/take_sim_step",
        [this](std::shared_ptr<rclcpp::Service<Trigger>>, std::shared_ptr<rmw_request_id_t> caller,
               std::shared_ptr<Trigger::Request>) {
          asked_by_hand_.push_back({std::move(caller), steady_clock::now(), std::nullopt});
          look_after_steps_by_hand();
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
    timer_ = rclcpp::create_timer(this, get_clock(), period, [this] { tick(); });
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

  /// A caller of take_sim_step, who gets the answer of the board.
  struct StepByHand {
    std::shared_ptr<rmw_request_id_t> caller;
    steady_clock::time_point since;          ///< When it was asked for, then when the board was.
    std::optional<std::int64_t> request_id;  ///< What the board was asked, once it was.
  };

  /// One after the other: asks the board as soon as it is there, gives up what takes too long, looks again while there are any.
  void look_after_steps_by_hand() {
    constexpr milliseconds kLookAgain{10};
    const auto now = steady_clock::now();
    while (!asked_by_hand_.empty()) {
      const StepByHand& first = asked_by_hand_.front();
      if (!first.request_id && by_hand_->service_is_ready()) {
        ask_by_hand(now);
        break;
      }
      const milliseconds limit(first.request_id ? result_ms_ : exists_ms_);
      if (now - first.since <= limit) break;
      if (first.request_id) by_hand_->remove_pending_request(*first.request_id);
      Trigger::Response failed;
      failed.success = false;
      failed.message = first.request_id
                           ? "found no answer of sil_board/run in time"
                           : "found no service sil_board/run, allowed with the board running";
      answer_by_hand(failed);
    }
    if (asked_by_hand_.empty()) {
      if (!look_again_) return;
      look_again_.reset();
      tell_executor(*this);
    } else if (!look_again_) {
      look_again_ = create_wall_timer(kLookAgain, [this] { look_after_steps_by_hand(); });
    }
  }

  void ask_by_hand(steady_clock::time_point now) {
    asked_by_hand_.front().since = now;
    asked_by_hand_.front().request_id =
        by_hand_
            ->async_send_request(std::make_shared<Trigger::Request>(),
                                 [this](rclcpp::Client<Trigger>::SharedFuture answer) {
                                   answer_by_hand(*answer.get());
                                   look_after_steps_by_hand();
                                 })
            .request_id;
  }

  void answer_by_hand(Trigger::Response answer) {
    service_->send_response(*asked_by_hand_.front().caller, answer);
    asked_by_hand_.pop_front();
  }

  double frequency_Hz_{};
  std::int64_t exists_ms_{};
  std::int64_t result_ms_{};
  bool busy_{false};           ///< A step has been asked for and not been answered.
  bool due_{false};            ///< A tick came while busy.
  bool board_answers_{false};  ///< Then it is not looked for: that walks through all topics of ROS.
  steady_clock::time_point asked_;
  std::uint64_t number_{0};
  std::uint64_t ticks_{0};
  std::uint64_t skipped_{0};
  steady_clock::time_point report_from_;
  rclcpp::Client<Trigger>::SharedPtr client_;
  rclcpp::Client<Trigger>::SharedPtr by_hand_;
  rclcpp::Service<Trigger>::SharedPtr service_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::deque<StepByHand> asked_by_hand_;
  rclcpp::TimerBase::SharedPtr look_again_;  ///< While there are any.
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::SilManager, SingleThreadedExecutor)
