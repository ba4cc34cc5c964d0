// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/client.h>
#include <rcl/node.h>

#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <rosidl_typesupport_cpp/service_type_support.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rclcpp/context.hpp"
#include "rclcpp/detail/arguments.hpp"
#include "rclcpp/detail/arrivals.hpp"
#include "rclcpp/detail/entity.hpp"
#include "rclcpp/macros.hpp"
#include "rclcpp/qos.hpp"

namespace rclcpp {

namespace detail {
/// A future that knows which request it belongs to.
template <typename FutureT>
struct FutureAndRequestId {
  FutureT future;
  std::int64_t request_id;
  FutureAndRequestId(FutureT awaited, std::int64_t id)
      : future(std::move(awaited)), request_id(id) {}
  FutureAndRequestId(FutureAndRequestId&&) noexcept = default;
  FutureAndRequestId& operator=(FutureAndRequestId&&) noexcept = default;
  FutureAndRequestId(const FutureAndRequestId&) = delete;  // as with rclcpp
  FutureAndRequestId& operator=(const FutureAndRequestId&) = delete;
  ~FutureAndRequestId() = default;
  operator FutureT&() { return future; }  // NOLINT: implicit in rclcpp too
  auto get() { return future.get(); }
  bool valid() const noexcept { return future.valid(); }
  void wait() const { future.wait(); }
  template <typename Rep, typename Period>
  std::future_status wait_for(const std::chrono::duration<Rep, Period>& span) const {
    return future.wait_for(span);
  }
  template <typename ClockT, typename Span>
  std::future_status wait_until(const std::chrono::time_point<ClockT, Span>& until) const {
    return future.wait_until(until);
  }
};
}  // namespace detail

class ClientBase : public detail::Entity {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(ClientBase)
  ClientBase(std::shared_ptr<rcl_node_t> node, Context::SharedPtr context, const std::string& name,
             const rosidl_service_type_support_t& type, const rmw_qos_profile_t& qos);
  ClientBase(const ClientBase&) = delete;
  ClientBase& operator=(const ClientBase&) = delete;
  ~ClientBase() override;

  const char* get_service_name() const { return rcl_client_get_service_name(&client_); }
  bool service_is_ready() const;
  /// False: not there when the time was over (-1: no limit) or the context was shut down.
  template <typename Rep = std::int64_t, typename Period = std::milli>
  bool wait_for_service(
      std::chrono::duration<Rep, Period> timeout = std::chrono::duration<Rep, Period>(-1)) {
    return wait_for_service_ns(std::chrono::duration_cast<std::chrono::nanoseconds>(timeout));
  }

  Kind kind() const override { return Kind::kClient; }
  bool has_work() const override { return arrivals_.any(); }
  void set_group(const std::weak_ptr<CallbackGroup>& group) override;

 protected:
  std::int64_t send(const void* request);
  /// False: there was nothing.
  bool take_response(rmw_request_id_t& id, void* response);

 private:
  bool wait_for_service_ns(std::chrono::nanoseconds timeout);
  bool wait_while_valid(std::chrono::nanoseconds timeout);
  std::shared_ptr<rcl_node_t> node_;
  Context::SharedPtr context_;
  rcl_client_t client_;
  detail::Arrivals arrivals_;
};

/// Sends requests. Safe to use from several threads.
template <typename ServiceT>
class Client : public ClientBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Client)
  using Request = typename ServiceT::Request;
  using Response = typename ServiceT::Response;
  using SharedRequest = std::shared_ptr<Request>;
  using SharedResponse = std::shared_ptr<Response>;
  using Promise = std::promise<SharedResponse>;
  using PromiseWithRequest = std::promise<std::pair<SharedRequest, SharedResponse>>;
  using Future = std::future<SharedResponse>;
  using SharedFuture = std::shared_future<SharedResponse>;
  using SharedFutureWithRequest = std::shared_future<std::pair<SharedRequest, SharedResponse>>;
  using CallbackType = std::function<void(SharedFuture)>;
  using CallbackWithRequestType = std::function<void(SharedFutureWithRequest)>;

  struct FutureAndRequestId : detail::FutureAndRequestId<Future> {
    using detail::FutureAndRequestId<Future>::FutureAndRequestId;
    SharedFuture share() noexcept { return this->future.share(); }
  };
  struct SharedFutureAndRequestId : detail::FutureAndRequestId<SharedFuture> {
    using detail::FutureAndRequestId<SharedFuture>::FutureAndRequestId;
  };
  struct SharedFutureWithRequestAndRequestId : detail::FutureAndRequestId<SharedFutureWithRequest> {
    using detail::FutureAndRequestId<SharedFutureWithRequest>::FutureAndRequestId;
  };

  Client(std::shared_ptr<rcl_node_t> node, Context::SharedPtr context, const std::string& name,
         const rmw_qos_profile_t& qos)
      : ClientBase(std::move(node), std::move(context), name,
                   *rosidl_typesupport_cpp::get_service_type_support_handle<ServiceT>(), qos) {}

  /// The future is ready when an executor has taken the response.
  FutureAndRequestId async_send_request(SharedRequest request) {
    Promise promise;
    auto future = promise.get_future();
    const auto id = expect(*request, [promise = share(std::move(promise))](SharedResponse answer) {
      promise->set_value(std::move(answer));
    });
    return {std::move(future), id};
  }

  template <typename CallbackT,
            std::enable_if_t<detail::kDeclares<CallbackT, SharedFuture> &&
                             std::is_invocable_v<CallbackT&, SharedFuture>>* = nullptr>
  SharedFutureAndRequestId async_send_request(SharedRequest request, CallbackT&& callback) {
    Promise promise;
    SharedFuture future(promise.get_future());
    const auto id =
        expect(*request,
               [promise = share(std::move(promise)), future,
                callback = CallbackType(std::forward<CallbackT>(callback))](SharedResponse answer) {
                 promise->set_value(std::move(answer));
                 callback(future);
               });
    return {std::move(future), id};
  }

  template <typename CallbackT,
            std::enable_if_t<detail::kDeclares<CallbackT, SharedFutureWithRequest> &&
                             std::is_invocable_v<CallbackT&, SharedFutureWithRequest> &&
                             !std::is_invocable_v<CallbackT&, SharedFuture>>* = nullptr>
  SharedFutureWithRequestAndRequestId async_send_request(SharedRequest request,
                                                         CallbackT&& callback) {
    PromiseWithRequest promise;
    SharedFutureWithRequest future(promise.get_future());
    const auto id =
        expect(*request, [promise = share(std::move(promise)), future, request,
                          callback = CallbackWithRequestType(std::forward<CallbackT>(callback))](
                             SharedResponse answer) {
          promise->set_value({request, std::move(answer)});
          callback(future);
        });
    return {std::move(future), id};
  }

  /// Forgets a request: a late response is dropped. False: it is answered or unknown.
  bool remove_pending_request(std::int64_t request_id) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return pending_.erase(request_id) != 0;
  }
  template <typename FutureT>
  bool remove_pending_request(const detail::FutureAndRequestId<FutureT>& future) {
    return remove_pending_request(future.request_id);
  }
  std::size_t prune_pending_requests() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto count = pending_.size();
    pending_.clear();
    return count;
  }

  std::shared_ptr<void> take() override {
    auto arrived = std::make_shared<Arrived>();
    return take_response(arrived->id, arrived->response.get()) ? arrived : nullptr;
  }
  void execute(std::shared_ptr<void> taken) override {
    const auto& arrived = *static_cast<Arrived*>(taken.get());
    Answer answer;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto found = pending_.find(arrived.id.sequence_number);
      if (found == pending_.end()) return;
      answer = std::move(found->second);
      pending_.erase(found);
    }
    answer(arrived.response);
  }

 private:
  using Answer = std::function<void(SharedResponse)>;
  struct Arrived {
    rmw_request_id_t id{};
    SharedResponse response{std::make_shared<Response>()};
  };
  template <typename PromiseT>
  static std::shared_ptr<PromiseT> share(PromiseT&& promise) {
    return std::make_shared<PromiseT>(std::move(promise));
  }
  /// Sent under the lock, so that no response can come before it is expected.
  std::int64_t expect(const Request& request, Answer answer) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto id = send(&request);
    pending_.emplace(id, std::move(answer));
    return id;
  }
  std::mutex mutex_;
  std::map<std::int64_t, Answer> pending_;
};

}  // namespace rclcpp
