// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/wait.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "rclcpp/context.hpp"
#include "rclcpp/future_return_code.hpp"
#include "rclcpp/node_interfaces/node_base_interface.hpp"

namespace rclcpp {

class Node;

struct ExecutorOptions {
  Context::SharedPtr context{contexts::get_global_default_context()};
};

/// Waits for the entities of its nodes and calls their callbacks.
///
/// Nodes and entities are held weakly: dropping one ends its callbacks. Who drops an entity of a living node calls
/// trigger_notify_guard_condition() of its callback group, or std::logic_error comes out of spin a second later: rclcpp 28 gives
/// what is ready to the wrong entities until it is called.
///
/// The middleware tells each entity of what comes (Arrivals), and the entity wakes the executor, so what a wait costs does not grow with
/// the services and subscriptions of its nodes: it is for timers and this wake-up alone, by the kernel, without polling.
class Executor {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(Executor)
  explicit Executor(const ExecutorOptions& options = ExecutorOptions());
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  virtual ~Executor();

  /// Until cancel or shutdown. Throws std::runtime_error when it spins already.
  virtual void spin() = 0;

  void add_node(node_interfaces::NodeBaseInterface::SharedPtr node, bool notify = true);
  void add_node(const std::shared_ptr<Node>& node, bool notify = true);
  void remove_node(node_interfaces::NodeBaseInterface::SharedPtr node, bool notify = true);
  void remove_node(const std::shared_ptr<Node>& node, bool notify = true);
  void add_callback_group(CallbackGroup::SharedPtr group,
                          node_interfaces::NodeBaseInterface::SharedPtr node, bool notify = true);
  void remove_callback_group(CallbackGroup::SharedPtr group, bool notify = true);

  void spin_node_some(const std::shared_ptr<Node>& node);
  /// Executes what is ready now, for no longer than `max_duration` (0: no limit), without waiting.
  void spin_some(std::chrono::nanoseconds max_duration = std::chrono::nanoseconds(0));
  /// As spin_some, over and over until nothing is ready.
  void spin_all(std::chrono::nanoseconds max_duration);
  /// Waits (-1: without limit) and executes one callback.
  virtual void spin_once(std::chrono::nanoseconds timeout = std::chrono::nanoseconds(-1));
  void cancel();
  bool is_spinning() const { return spinning_; }

  template <typename FutureT, typename Rep = std::int64_t, typename Period = std::milli>
  FutureReturnCode spin_until_future_complete(
      const FutureT& future,
      std::chrono::duration<Rep, Period> timeout = std::chrono::duration<Rep, Period>(-1)) {
    return spin_until(
        [&future] { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; },
        std::chrono::duration_cast<std::chrono::nanoseconds>(timeout));
  }

 protected:
  /// Something taken and its group, which nobody else enters until finish().
  struct Work {
    std::shared_ptr<detail::Entity> entity;
    CallbackGroup::SharedPtr group;
    std::shared_ptr<void> taken;
  };
  /// The next work, waiting for it (-1: without limit). Nothing: time over, cancelled, or what
  /// woke the executor had nothing to take. Safe from several threads.
  std::optional<Work> next(std::chrono::nanoseconds timeout);
  void execute(Work& work);
  bool may_spin() const { return spinning_ && context_->is_valid(); }
  /// Throws std::runtime_error if another spin is under way.
  void begin_spin();

  Context::SharedPtr context_;
  std::atomic_bool spinning_{false};

 private:
  struct Watched {
    std::weak_ptr<detail::Entity> entity;
    CallbackGroup::SharedPtr group;
  };
  struct Ready {
    std::shared_ptr<detail::Entity> entity;
    CallbackGroup::SharedPtr group;
  };
  FutureReturnCode spin_until(const std::function<bool()>& done, std::chrono::nanoseconds timeout);
  void wait(std::chrono::nanoseconds timeout);
  void rest(std::chrono::nanoseconds timeout);
  bool find_ready();
  void refuse_forgotten(bool any_gone);
  void collect();
  std::optional<Work> take_next();
  bool is_closed(const CallbackGroup& group) const;

  std::shared_ptr<rcl_context_t> rcl_context_;
  std::shared_ptr<detail::WakeUp> wake_up_;
  OnShutdownCallbackHandle on_shutdown_;

  std::mutex members_mutex_;
  std::vector<node_interfaces::NodeBaseInterface::WeakPtr> nodes_;
  std::vector<CallbackGroup::WeakPtr> groups_;

  std::atomic_bool waiting_{false};
  std::mutex wait_mutex_;  ///< Guards all below; held while waiting.
  rcl_wait_set_t wait_set_;
  std::uint64_t known_generation_{0};
  std::vector<Watched> watched_;  ///< In the order of calls: timers, messages, services, clients.
  std::size_t timers_{0};         ///< How many of them are timers.
  std::deque<Ready> ready_;
  std::optional<std::chrono::steady_clock::time_point> gone_since_;  ///< One of watched_.
};

}  // namespace rclcpp
