// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <mutex>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <utility>

#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/fine_ticks.hpp"
#include "rosflight_sim/time_parameters.hpp"
#include "rosflight_sim/waited_topics.hpp"

namespace rosflight_sim {
namespace {

using namespace rosflight_common;

using std::chrono::steady_clock;

/// Simulated time on `/clock`, scaled, paused, stepped: one for all vehicles, in whatever namespace it runs.
///
/// The world moves in steps of default_pub_rate_us. `/clock` has them and, for nodes that would otherwise ask for the time
/// twice within one, the ticks between them; `/clock_steps` has the steps alone, for nodes that need no more: the launch files
/// of the simulator let theirs follow it, because a message to each of twenty nodes every 0.1 ms takes more than a processor.
///
/// Every step moves time on by default_pub_rate_us; the wall time between two is that divided by the factor. The timer asks the
/// steady clock how many are due, so a late step is made up and time keeps its pace; what is more than kMaxDelay behind is lost,
/// and said. Where somebody follows the ticks, what is late is made up at kCatchUp times the pace, ticks and all: a node that has just been
/// late would find the same time twice if the clock then went on by whole steps.
class TimeManager : public rclcpp::Node {
 public:
  explicit TimeManager(const rclcpp::NodeOptions& options)
      : Node("time_manager", with_clock_of_its_own(options)) {
    step_us_ = declare_step_us(*this);
    tick_us_ = declare_number(
        *this, "clock_tick_us", 100.0, 50.0, 10'000.0,
        "simulated time between two messages of /clock; a step or more: steps only [us]", true);
    factor_ = declare_factor(*this);
    single_us_ = declare_number(*this, "single_step_us", 2500.0, 50.0, 1'000'000.0,
                                "simulated time of one take_step [us]");
    lead_us_ = declare_number(*this, "max_lead_us", 2500.0, 0.0, 1'000'000.0,
                              "maximum time ahead of sim/truth_state; 0: never waits [us]", true);
    lag_us_ = declare_number(*this, "max_lag_us", 5000.0, 0.0, 1'000'000.0,
                             "maximum time after a message of wait_for was due [us]", true);
    waited_.emplace(*this,
                    declare_text(*this, "wait_for", "",
                                 "stamped topics that time waits for, separated by spaces"),
                    [this] { message_came(); });
    const bool paused =
        declare_switch(*this, "start_paused", false, "starts paused, until toggle_pause is called");
    const auto newest_only = rclcpp::QoS(rclcpp::KeepLast(1)).best_effort();
    steps_ = create_publisher<rosgraph_msgs::msg::Clock>(kSteps, newest_only);
    clock_ = create_publisher<rosgraph_msgs::msg::Clock>(kClock, newest_only);
    fine_.emplace([this](std::int64_t time_ns) { publish(time_ns); });
    pause_ = create_service<std_srvs::srv::Trigger>(
        "time_manager/toggle_pause",
        [this](const std::shared_ptr<std_srvs::srv::Trigger::Request>,
               std::shared_ptr<std_srvs::srv::Trigger::Response> response) {
          set_paused(!paused_);
          response->success = true;
          response->message = paused_ ? "paused" : "running";
        });
    take_step_ = create_service<std_srvs::srv::Trigger>(
        "time_manager/take_step",
        [this](const std::shared_ptr<std_srvs::srv::Trigger::Request>,
               std::shared_ptr<std_srvs::srv::Trigger::Response> response) {
          single_step(*response);
        });
    truth_ = create_subscription<rosflight_msgs::msg::SimState>(
        "sim/truth_state", newest(), [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) {
          world_follows(nanoseconds(message->header.stamp));
        });
    changes_ = on_change(*this, [this](const rclcpp::Parameter& p) {
      if (p.get_name() == "max_lead_us") lead_us_ = p.as_double();
      if (p.get_name() == "max_lag_us") lag_us_ = p.as_double();
      if (p.get_name() == kStepParameter) step_us_ = p.as_double();
      if (p.get_name() == "clock_tick_us") tick_us_ = p.as_double();
      if (p.get_name() == kFactorParameter) factor_ = p.as_double();
      start();
    });
    paused_ = paused;
    start();
  }

 private:
  static constexpr const char* kClock = "/clock";  // where all nodes with use_sim_time look
  static constexpr const char* kSteps = "/clock_steps";
  static constexpr int kCatchUp = 4;  ///< Maximum pace where ticks are followed, of the factor.
  static constexpr auto kMaxDelay = std::chrono::milliseconds(50);
  static constexpr auto kJudged = std::chrono::seconds(2);
  /// A pace that nobody holds must not keep services and parameters waiting.
  static constexpr auto kMaxTick = std::chrono::milliseconds(2);
  static constexpr auto kSayAgain = std::chrono::milliseconds(20);
  /// Between two looks at what time waits for, at most: it may have been given up, or its message lost.
  static constexpr auto kLook = std::chrono::milliseconds(2);
  static constexpr double kHeld = 0.98;  ///< Fraction of the factor that counts as held.

  /// In a process whose nodes follow another clock (-r /clock:=...), this one still publishes /clock.
  static rclcpp::NodeOptions with_clock_of_its_own(rclcpp::NodeOptions options) {
    std::vector<std::string> words = options.arguments();
    for (const char* word : {"--ros-args", "-r", "/clock:=/clock"}) words.emplace_back(word);
    return options.arguments(words);
  }

  std::chrono::nanoseconds wall_period() const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(step_us_ * 1e3 / factor_));
  }

  /// Goes on from now at the present pace.
  void start() {
    fine_->stop();
    next_ = steady_clock::now() + wall_period();
    judge_from_ = steady_clock::now();
    judge_time_ns_ = time_ns_;
    timer_.reset();
    look_.reset();
    if (paused_) {  // for nodes that come now, and if a message was lost
      look_ = create_wall_timer(kSayAgain, [this] { advance(0.0); });
      return;
    }
    ticks_are_followed_ = pace().tick_ns > 0;
    timer_ = create_wall_timer(ticks_are_followed_ ? wall_period() / kCatchUp : wall_period(),
                               [this] { tick(); });
    look_ = create_wall_timer(kLook, [this] { tick(); });
  }

  /// What time waits for calls tick() when it comes: until then a timer of 25 us, at 100 times real time, would only keep a
  /// processor busy. Not where ticks are followed: how long they stand is seen by looking. Not where the timer is slow: begun again,
  /// it would make its steps at other times.
  void rest() {
    const bool rests = waiting_ && !ticks_are_followed_ && wall_period() < kLook;
    if (rests == timer_->is_canceled()) return;
    if (rests) {
      timer_->cancel();
    } else {
      timer_->reset();
    }
  }

  void set_paused(bool paused) {
    paused_ = paused;
    start();
  }

  void single_step(std_srvs::srv::Trigger::Response& response) {
    if (!paused_) {
      response.success = false;
      response.message = "found time running, allowed while it is paused";
      return;
    }
    for (double left_us = single_us_; left_us > 0.0; left_us -= step_us_)
      advance(std::min(left_us, step_us_));
    response.success = true;
    response.message = "time is " + std::to_string(time_ns_) + " ns";
  }

  void advance(double by_us) {
    time_ns_ += static_cast<std::int64_t>(by_us * 1e3);
    rosgraph_msgs::msg::Clock message;
    message.clock = stamp_of(time_ns_);
    steps_->publish(message);
    publish(time_ns_);
  }

  /// On /clock, in this thread and in that of the ticks. Never a time before one that has been published.
  void publish(std::int64_t time_ns) {
    const std::lock_guard lock{publishing_};
    published_ns_ = std::max(published_ns_, time_ns);
    rosgraph_msgs::msg::Clock message;
    message.clock = stamp_of(published_ns_);
    clock_->publish(message);
  }

  /// The ticks between the last step and the next one.
  void publish_ticks() {
    const WaitedTopics::Pace how = pace();
    if (how.tick_ns == 0) return fine_->stop();
    ticks_end_ns_ = waited_->ticks_end_ns(how);
    fine_->follow({time_ns_, how.step_ns, how.tick_ns, stepped_,
                   std::max(next_ - stepped_, wall_period() / kCatchUp), ticks_end_ns_});
  }

  void message_came() {
    if (paused_) return;
    if (waiting_ || ticks_end_ns_ != WaitedTopics::kNoEnd) tick();
  }

  /// Everything up to here has happened in the world. A truth that is sent again, because its step was, says nothing of a newer step.
  void world_follows(std::int64_t truth_ns) {
    if (std::exchange(truth_ns_, truth_ns) == truth_ns) return;
    followed_ns_ = time_ns_;
    follows_ = true;
    if (!paused_ && waiting_) tick();
  }

  std::int64_t told_ns() {
    const std::lock_guard lock{publishing_};
    return published_ns_;
  }

  WaitedTopics::Pace pace() const {
    const bool fine = tick_us_ < step_us_ && clock_->get_subscription_count() > 0;
    return {static_cast<std::int64_t>(lag_us_ * 1e3), static_cast<std::int64_t>(step_us_ * 1e3),
            fine ? static_cast<std::int64_t>(tick_us_ * 1e3) : 0};
  }

  bool must_wait(steady_clock::time_point now) {
    const bool for_world =
        follows_ && lead_us_ > 0.0 &&
        static_cast<double>(time_ns_ - followed_ns_) + step_us_ * 0.5e3 > lead_us_ * 1e3;
    const bool for_topics = waited_->behind(time_ns_, told_ns(), pace(), now);
    waiting_ = for_world || for_topics;
    if (waiting_ && now - said_ > kSayAgain) {  // best effort: it may have been lost
      advance(0.0);
      said_ = now;
    }
    if (!for_world) overdue_.none();
    if (for_world && overdue_.give_up(now)) {
      follows_ = false;
      waiting_ = for_topics;
      next_ = now;
      RCLCPP_WARN(get_logger(), "no sim/truth_state for %ld s: time goes on without it",
                  static_cast<long>(Overdue::kGiveUp.count()));
    }
    return waiting_;
  }

  void tick() {
    if (paused_)
      return;  // a timer that start() has ended may still be under way in a container with several threads
    const auto now = steady_clock::now();
    if (now - next_ > kMaxDelay) next_ = now;
    bool moved = false;
    // Ticks that stop for a node need no time of their own.
    const bool free_ticks = ticks_are_followed_ && ticks_end_ns_ == WaitedTopics::kNoEnd;
    const auto earliest = free_ticks ? stepped_ + wall_period() / kCatchUp : now;
    while (next_ <= now && earliest <= now && !must_wait(now) &&
           steady_clock::now() - now < kMaxTick) {
      advance(step_us_);
      said_ = now;
      stepped_ = now;
      next_ += wall_period();
      moved = true;
      if (ticks_are_followed_) break;
      if (!follows_) break;  // the world's first answer may be waiting for this thread
    }
    if (moved || ticks_end_ns_ != WaitedTopics::kNoEnd) publish_ticks();
    judge(now);
    rest();
  }

  void judge(steady_clock::time_point now) {
    if (now - judge_from_ < kJudged) return;
    if (count_publishers(kClock) > 1)
      RCLCPP_ERROR(get_logger(),
                   "found %zu publishers of /clock, allowed one: start other vehicles with "
                   "time_manager:=false",
                   count_publishers(kClock));
    const std::chrono::duration<double> wall = now - judge_from_;
    const double reached = static_cast<double>(time_ns_ - judge_time_ns_) * 1e-9 / wall.count();
    if (reached < kHeld * factor_) {
      RCLCPP_WARN(get_logger(),
                  "this machine cannot hold real_time_multiplier %.2f: time runs at %.2f", factor_,
                  reached);
    }
    judge_from_ = now;
    judge_time_ns_ = time_ns_;
    if (ticks_are_followed_ != (pace().tick_ns > 0)) start();
  }

  double step_us_{};
  double tick_us_{};
  double factor_{};
  double single_us_{};
  bool paused_{false};
  double lead_us_{};
  double lag_us_{};
  std::optional<WaitedTopics> waited_;
  bool follows_{false};  ///< There is a world that answers.
  bool waiting_{false};  ///< For it, or for a topic.
  std::int64_t followed_ns_{0};
  std::int64_t truth_ns_{-1};
  std::int64_t time_ns_{0};
  std::int64_t ticks_end_ns_{WaitedTopics::kNoEnd};
  steady_clock::time_point next_;
  steady_clock::time_point stepped_;  ///< When the last step was made.
  bool ticks_are_followed_{false};    ///< At the last look, which is every two seconds.
  Overdue overdue_;                   ///< The world.
  steady_clock::time_point said_;
  steady_clock::time_point judge_from_;
  std::int64_t judge_time_ns_{0};
  std::mutex publishing_;
  std::int64_t published_ns_{0};
  rclcpp::Publisher<rosgraph_msgs::msg::Clock>::SharedPtr clock_, steps_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr pause_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr take_step_;
  rclcpp::Subscription<rosflight_msgs::msg::SimState>::SharedPtr truth_;
  rclcpp::TimerBase::SharedPtr timer_;  ///< Makes the steps.
  rclcpp::TimerBase::SharedPtr look_;   ///< Slower, also while time waits or is paused.
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
  std::optional<FineTicks> fine_;  ///< The last member: its thread uses the others.
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::TimeManager, SingleThreadedExecutor)
