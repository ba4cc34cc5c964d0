// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/executor.hpp"

#include <rcl/error_handling.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "rcl_call.hpp"
#include "rclcpp/node.hpp"
#include "rclcpp/timer.hpp"

namespace rclcpp {

using std::chrono::nanoseconds;
using Steady = std::chrono::steady_clock;

Executor::Executor(const ExecutorOptions& options)
    : context_(options.context),
      rcl_context_(context_->get_rcl_context()),
      wake_up_(std::make_shared<detail::WakeUp>(context_)),
      wait_set_(rcl_get_zero_initialized_wait_set()) {
  detail::check(rcl_wait_set_init(&wait_set_, 0, 1, 0, 0, 0, 0, rcl_context_.get(),
                                  rcl_get_default_allocator()),
                "make a wait set");
  on_shutdown_ = context_->add_on_shutdown_callback([wake_up = wake_up_] { wake_up->trigger(); });
}

Executor::~Executor() {
  context_->remove_on_shutdown_callback(on_shutdown_);
  for (const auto& weak : nodes_) {
    if (const auto node = weak.lock()) node->set_wake_up(nullptr);
  }
  for (const auto& weak : groups_) {
    if (const auto group = weak.lock()) group->set_wake_up(nullptr);
  }
  detail::complain(rcl_wait_set_fini(&wait_set_), "end a wait set");
}

void Executor::add_node(node_interfaces::NodeBaseInterface::SharedPtr node, bool) {
  if (node->has_executor()) {
    throw std::runtime_error(std::string("node '") + node->get_fully_qualified_name() +
                             "' is in an executor already");
  }
  {
    const std::lock_guard<std::mutex> lock(members_mutex_);
    nodes_.push_back(node);
  }
  node->set_wake_up(wake_up_);
  wake_up_->set_changed();
}

void Executor::remove_node(node_interfaces::NodeBaseInterface::SharedPtr node, bool) {
  {
    const std::lock_guard<std::mutex> lock(members_mutex_);
    const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                    [&](const auto& ours) { return ours.lock() == node; });
    if (found == nodes_.end()) {
      throw std::runtime_error(std::string("node '") + node->get_fully_qualified_name() +
                               "' is not in this executor");
    }
    nodes_.erase(found);
  }
  node->set_wake_up(nullptr);
  wake_up_->set_changed();
}

void Executor::add_node(const std::shared_ptr<Node>& node, bool notify) {
  add_node(node->get_node_base_interface(), notify);
}
void Executor::remove_node(const std::shared_ptr<Node>& node, bool notify) {
  remove_node(node->get_node_base_interface(), notify);
}

void Executor::add_callback_group(CallbackGroup::SharedPtr group,
                                  node_interfaces::NodeBaseInterface::SharedPtr node, bool) {
  if (group->has_executor()) throw std::runtime_error("the group is in an executor already");
  if (!node->callback_group_in_node(group)) {
    throw std::runtime_error("the callback group is not of this node");
  }
  {
    const std::lock_guard<std::mutex> lock(members_mutex_);
    groups_.push_back(group);
  }
  group->set_wake_up(wake_up_);
  wake_up_->set_changed();
}

void Executor::remove_callback_group(CallbackGroup::SharedPtr group, bool) {
  {
    const std::lock_guard<std::mutex> lock(members_mutex_);
    const auto found = std::find_if(groups_.begin(), groups_.end(),
                                    [&](const auto& ours) { return ours.lock() == group; });
    if (found == groups_.end()) throw std::runtime_error("the group is not in this executor");
    groups_.erase(found);
  }
  group->set_wake_up(nullptr);
  wake_up_->set_changed();
}

// ---- waiting ------------------------------------------------------------------------------------

/// Lists what the nodes have now and makes room for it.
void Executor::collect() {
  known_generation_ = wake_up_->generation();
  using Kind = detail::Entity::Kind;
  constexpr std::array kOrder{Kind::kTimer, Kind::kSubscription, Kind::kService, Kind::kClient};
  std::array<std::vector<Watched>, kOrder.size()> of_kind;
  const auto of = [&](Kind kind) -> std::vector<Watched>& {
    return of_kind[static_cast<std::size_t>(kind)];
  };
  const auto take_group = [&](const CallbackGroup::SharedPtr& group) {
    for (const auto& weak : group->entities())
      if (const auto entity = weak.lock()) of(entity->kind()).push_back({weak, group});
  };
  {
    const std::lock_guard<std::mutex> lock(members_mutex_);
    for (const auto& weak : nodes_) {
      const auto node = weak.lock();
      if (!node) continue;
      for (const auto& weak_group : node->callback_groups()) {
        const auto group = weak_group.lock();
        if (group && group->automatically_add_to_executor_with_node()) take_group(group);
      }
    }
    for (const auto& weak_group : groups_) {
      if (const auto group = weak_group.lock()) take_group(group);
    }
  }
  gone_since_.reset();
  watched_.clear();
  for (const Kind kind : kOrder) watched_.insert(watched_.end(), of(kind).begin(), of(kind).end());
  timers_ = of(Kind::kTimer).size();
  detail::check(rcl_wait_set_resize(&wait_set_, 0, 1, timers_, 0, 0, 0), "resize a wait set");
}

/// A mutually exclusive group at work takes nothing new.
bool Executor::is_closed(const CallbackGroup& group) const {
  return group.type() == CallbackGroupType::MutuallyExclusive &&
         !const_cast<CallbackGroup&>(group).can_be_taken_from();
}

/// False: there is nothing to do.
bool Executor::find_ready() {
  bool any_gone = false;
  for (const Watched& watched : watched_) {
    auto entity = watched.entity.lock();
    any_gone = any_gone || !entity;
    if (entity && entity->has_work() && !is_closed(*watched.group))
      ready_.push_back({std::move(entity), watched.group});
  }
  refuse_forgotten(any_gone);
  return !ready_.empty();
}

/// The thread that drops an entity may be about to tell.
void Executor::refuse_forgotten(bool any_gone) {
  constexpr std::chrono::seconds kAtTheLatest{1};
  if (!any_gone) return;
  const auto now = Steady::now();
  if (!gone_since_) gone_since_ = now;
  if (now - *gone_since_ > kAtTheLatest && known_generation_ == wake_up_->generation())
    throw std::logic_error(
        "a subscription, timer, service or client was destroyed and "
        "trigger_notify_guard_condition() of its "
        "callback group was not called: rclcpp 28 gives what is ready to the wrong ones");
}

/// Until somebody wakes this executor, a timer is due or time is over.
void Executor::rest(nanoseconds timeout) {
  detail::check(rcl_wait_set_clear(&wait_set_), "clear a wait set");
  detail::check(rcl_wait_set_add_guard_condition(&wait_set_, wake_up_->handle(), nullptr), "wait");
  std::vector<std::shared_ptr<detail::Entity>> in_set;  // kept while the set has them
  for (std::size_t i = 0; i < timers_; ++i) {
    auto timer = watched_[i].entity.lock();
    if (!timer || is_closed(*watched_[i].group)) continue;
    static_cast<const TimerBase&>(*timer).add_to(wait_set_);
    in_set.push_back(std::move(timer));
  }
  const auto code = rcl_wait(&wait_set_, timeout.count());
  if (code == RCL_RET_TIMEOUT) {
    rcl_reset_error();
  } else {
    detail::check(code, "wait");
  }
}

void Executor::wait(nanoseconds timeout) {
  if (known_generation_ != wake_up_->generation()) collect();
  wake_up_->set_waiting(true);  // before it looks: what comes after that wakes it
  const bool found = find_ready();
  if (!found && timeout.count() != 0) rest(timeout);
  wake_up_->set_waiting(false);
  if (!found) find_ready();
}

std::optional<Executor::Work> Executor::take_next() {
  for (auto candidate = ready_.begin(); candidate != ready_.end();) {
    if (is_closed(*candidate->group)) {
      ++candidate;
      continue;
    }
    Work work{std::move(candidate->entity), std::move(candidate->group), nullptr};
    candidate = ready_.erase(candidate);
    work.taken = work.entity->take();
    if (!work.taken) continue;
    if (work.group->type() == CallbackGroupType::MutuallyExclusive) {
      work.group->can_be_taken_from() = false;
    }
    return work;
  }
  return std::nullopt;
}

std::optional<Executor::Work> Executor::next(nanoseconds timeout) {
  const std::lock_guard<std::mutex> lock(wait_mutex_);
  // Cancelled while another thread had the lock: its wait has used up the wake-up.
  if (!may_spin()) return std::nullopt;
  if (auto work = take_next()) return work;
  // What stayed belongs to groups at work; the wait will find it again when they are free.
  ready_.clear();
  waiting_ = true;
  wait(timeout);
  waiting_ = false;
  // What the callback that cancelled has made possible is not begun.
  return may_spin() ? take_next() : std::nullopt;
}

void Executor::execute(Work& work) {
  // Whatever the callback throws, the group is free again.
  struct Opener {
    Executor& executor;
    CallbackGroup& group;
    ~Opener() {
      // Another thread may be waiting without this group.
      if (!group.can_be_taken_from().exchange(true) && executor.waiting_) {
        executor.wake_up_->trigger();
      }
    }
  } opener{*this, *work.group};
  work.entity->execute(std::move(work.taken));
}

// ---- spinning -----------------------------------------------------------------------------------

void Executor::begin_spin() {
  if (spinning_.exchange(true)) throw std::runtime_error("the executor spins already");
}

void Executor::cancel() {
  spinning_ = false;
  wake_up_->trigger();
}

namespace {
struct EndSpin {
  std::atomic_bool& spinning;
  ~EndSpin() { spinning = false; }
};
}  // namespace

void Executor::spin_once(nanoseconds timeout) {
  begin_spin();
  const EndSpin end{spinning_};
  if (auto work = next(timeout)) execute(*work);
}

void Executor::spin_some(nanoseconds max_duration) {
  begin_spin();
  const EndSpin end{spinning_};
  const auto start = Steady::now();
  const auto has_time = [&] {
    return max_duration.count() == 0 || Steady::now() - start < max_duration;
  };
  auto work = next(nanoseconds(0));
  while (work && may_spin()) {
    execute(*work);
    if (!has_time()) return;
    const std::lock_guard<std::mutex> lock(wait_mutex_);
    work = take_next();
  }
}

void Executor::spin_all(nanoseconds max_duration) {
  if (max_duration.count() < 0) throw std::invalid_argument("spin_all for a negative time");
  begin_spin();
  const EndSpin end{spinning_};
  const auto start = Steady::now();
  while (may_spin() && (max_duration.count() == 0 || Steady::now() - start < max_duration)) {
    auto work = next(nanoseconds(0));
    if (!work) return;
    execute(*work);
  }
}

void Executor::spin_node_some(const std::shared_ptr<Node>& node) {
  add_node(node);
  spin_some();
  remove_node(node);
}

FutureReturnCode Executor::spin_until(const std::function<bool()>& done, nanoseconds timeout) {
  if (done()) return FutureReturnCode::SUCCESS;
  begin_spin();
  const EndSpin end{spinning_};
  const auto start = Steady::now();
  auto left = timeout;
  while (may_spin()) {
    if (auto work = next(left)) execute(*work);
    if (done()) return FutureReturnCode::SUCCESS;
    if (timeout.count() < 0) continue;
    left = timeout - (Steady::now() - start);
    if (left.count() <= 0) return FutureReturnCode::TIMEOUT;
  }
  return FutureReturnCode::INTERRUPTED;
}

}  // namespace rclcpp
