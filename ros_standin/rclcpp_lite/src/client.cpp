// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/client.hpp"

#include <rcl/error_handling.h>
#include <rcl/graph.h>
#include <rcl/wait.h>

#include <algorithm>

#include "rcl_call.hpp"
#include "rclcpp/detail/wake_up.hpp"

namespace rclcpp {

ClientBase::ClientBase(std::shared_ptr<rcl_node_t> node, Context::SharedPtr context,
                       const std::string& name, const rosidl_service_type_support_t& type,
                       const rmw_qos_profile_t& qos)
    : node_(std::move(node)),
      context_(std::move(context)),
      client_(rcl_get_zero_initialized_client()) {
  auto options = rcl_client_get_default_options();
  options.qos = qos;
  detail::check(rcl_client_init(&client_, node_.get(), &type, name.c_str(), &options),
                "make a client of service '" + name + "'");
}

ClientBase::~ClientBase() {
  detail::complain(rcl_client_set_on_new_response_callback(&client_, nullptr, nullptr),
                   "leave a client alone");
  detail::complain(rcl_client_fini(&client_, node_.get()), "end a client");
}

void ClientBase::set_group(const std::weak_ptr<CallbackGroup>& group) {
  arrivals_.set_group(group);
  detail::check(
      rcl_client_set_on_new_response_callback(&client_, &detail::Arrivals::come, &arrivals_),
      "be told of responses");
}

bool ClientBase::service_is_ready() const {
  bool ready = false;
  const auto code = rcl_service_server_is_available(node_.get(), &client_, &ready);
  if (code == RCL_RET_NODE_INVALID) {  // after shutdown there is nobody
    rcl_reset_error();
    return false;
  }
  detail::check(code, "look for a service");
  return ready;
}

namespace {
/// Waits for one change of the graph or a call of the wake-up, at most so long.
class GraphWatch {
 public:
  GraphWatch(const rcl_node_t& node, rcl_context_t* context) : node_(node) {
    detail::check(rcl_wait_set_init(&set_, 0, 2, 0, 0, 0, 0, context, rcl_get_default_allocator()),
                  "make a wait set");
  }
  GraphWatch(const GraphWatch&) = delete;
  GraphWatch& operator=(const GraphWatch&) = delete;
  ~GraphWatch() { detail::complain(rcl_wait_set_fini(&set_), "end a wait set"); }

  void wait(const detail::WakeUp& wake_up, std::chrono::nanoseconds at_most) {
    detail::check(rcl_wait_set_clear(&set_), "clear a wait set");
    const auto* const graph = rcl_node_get_graph_guard_condition(&node_);
    detail::check(rcl_wait_set_add_guard_condition(&set_, graph, nullptr), "watch the graph");
    detail::check(rcl_wait_set_add_guard_condition(&set_, wake_up.handle(), nullptr), "wait");
    const auto code = rcl_wait(&set_, at_most.count());
    if (code == RCL_RET_TIMEOUT) {
      rcl_reset_error();
    } else {
      detail::check(code, "wait for the graph");
    }
  }

 private:
  const rcl_node_t& node_;
  rcl_wait_set_t set_ = rcl_get_zero_initialized_wait_set();
};
}  // namespace

bool ClientBase::wait_for_service_ns(std::chrono::nanoseconds timeout) {
  if (service_is_ready()) return true;
  if (timeout.count() == 0) return false;
  try {
    return wait_while_valid(timeout);
  } catch (const exceptions::RCLError&) {  // a signal can end the context between any two calls
    if (context_->is_valid()) throw;
    return false;
  }
}

bool ClientBase::wait_while_valid(std::chrono::nanoseconds timeout) {
  using Clock = std::chrono::steady_clock;
  // The graph's condition is shared with others who may take its signal away, so look at times.
  constexpr std::chrono::nanoseconds kLookAgain = std::chrono::milliseconds(100);
  const auto start = Clock::now();
  const auto wake_up = std::make_shared<detail::WakeUp>(context_);
  GraphWatch watch(*node_, context_->get_rcl_context().get());
  const auto at_shutdown = context_->add_on_shutdown_callback([wake_up] { wake_up->trigger(); });
  bool ready = service_is_ready();
  while (!ready && context_->is_valid()) {
    auto span = kLookAgain;
    if (timeout.count() > 0) {
      const std::chrono::nanoseconds left = timeout - (Clock::now() - start);
      if (left.count() <= 0) break;
      span = std::min(span, left);
    }
    watch.wait(*wake_up, span);
    ready = service_is_ready();
  }
  context_->remove_on_shutdown_callback(at_shutdown);
  return ready;
}

std::int64_t ClientBase::send(const void* request) {
  std::int64_t sequence = 0;
  detail::check(rcl_send_request(&client_, request, &sequence),
                std::string("send a request to service '") + get_service_name() + "'");
  return sequence;
}

bool ClientBase::take_response(rmw_request_id_t& id, void* response) {
  return arrivals_.take([&] {
    return detail::taken(rcl_take_response(&client_, &id, response), RCL_RET_CLIENT_TAKE_FAILED,
                         "take a response");
  });
}

}  // namespace rclcpp
