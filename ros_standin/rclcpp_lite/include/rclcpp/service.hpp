// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/node.h>
#include <rcl/service.h>

#include <functional>
#include <memory>
#include <rosidl_typesupport_cpp/service_type_support.hpp>
#include <string>
#include <type_traits>

#include "rclcpp/detail/arguments.hpp"
#include "rclcpp/detail/arrivals.hpp"
#include "rclcpp/detail/entity.hpp"
#include "rclcpp/macros.hpp"
#include "rclcpp/qos.hpp"

namespace rclcpp {

class ServiceBase : public detail::Entity {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(ServiceBase)
  ServiceBase(std::shared_ptr<rcl_node_t> node, const std::string& name,
              const rosidl_service_type_support_t& type, const rmw_qos_profile_t& qos);
  ServiceBase(const ServiceBase&) = delete;
  ServiceBase& operator=(const ServiceBase&) = delete;
  ~ServiceBase() override;
  const char* get_service_name() const { return rcl_service_get_service_name(&service_); }

  Kind kind() const override { return Kind::kService; }
  bool has_work() const override { return arrivals_.any(); }
  void set_group(const std::weak_ptr<CallbackGroup>& group) override;

 protected:
  /// False: there was nothing.
  bool take_request(rmw_request_id_t& id, void* request);
  void send(rmw_request_id_t& id, void* response);

 private:
  std::shared_ptr<rcl_node_t> node_;
  rcl_service_t service_;
  detail::Arrivals arrivals_;
};

template <typename ServiceT>
class Service;

namespace detail {
/// Does a service take the callback? One that converts to a form below is enough, but not a mutable lambda.
template <typename CallbackT, typename ServiceT, typename Id = std::shared_ptr<rmw_request_id_t>,
          typename Request = std::shared_ptr<typename ServiceT::Request>,
          typename Response = std::shared_ptr<typename ServiceT::Response>>
inline constexpr bool kServiceTakes =
    kHasConstCall<CallbackT> &&
    (std::is_invocable_v<CallbackT&, Request, Response> ||
     std::is_invocable_v<CallbackT&, Id, Request, Response> ||
     std::is_invocable_v<CallbackT&, Id, Request> ||
     std::is_invocable_v<CallbackT&, std::shared_ptr<Service<ServiceT>>, Id, Request>);
}  // namespace detail

/// Answers requests. The callback is one of
///   void(shared_ptr<Request>, shared_ptr<Response>)
///   void(shared_ptr<rmw_request_id_t>, shared_ptr<Request>, shared_ptr<Response>)
///   void(shared_ptr<rmw_request_id_t>, shared_ptr<Request>)                       answers later
///   void(shared_ptr<Service>, shared_ptr<rmw_request_id_t>, shared_ptr<Request>)  answers later
/// Who answers later calls send_response.
template <typename ServiceT>
class Service : public ServiceBase, public std::enable_shared_from_this<Service<ServiceT>> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Service)
  using Request = typename ServiceT::Request;
  using Response = typename ServiceT::Response;
  using Id = std::shared_ptr<rmw_request_id_t>;

  template <typename CallbackT>
  Service(std::shared_ptr<rcl_node_t> node, const std::string& name, CallbackT&& callback,
          const rmw_qos_profile_t& qos)
      : ServiceBase(std::move(node), name,
                    *rosidl_typesupport_cpp::get_service_type_support_handle<ServiceT>(), qos) {
    using Callback = std::decay_t<CallbackT>;
    using RequestPtr = std::shared_ptr<Request>;
    using ResponsePtr = std::shared_ptr<Response>;
    static_assert(
        detail::kServiceTakes<Callback, ServiceT>,
        "rclcpp takes the four forms above with a const call operator: no mutable lambda");
    if constexpr (std::is_invocable_v<Callback&, RequestPtr, ResponsePtr>) {
      call_ = [this, callback = Callback(std::forward<CallbackT>(callback))](
                  const Id& id, const RequestPtr& request) mutable {
        auto response = std::make_shared<Response>();
        callback(request, response);
        send_response(*id, *response);
      };
    } else if constexpr (std::is_invocable_v<Callback&, Id, RequestPtr, ResponsePtr>) {
      call_ = [this, callback = Callback(std::forward<CallbackT>(callback))](
                  const Id& id, const RequestPtr& request) mutable {
        auto response = std::make_shared<Response>();
        callback(id, request, response);
        send_response(*id, *response);
      };
    } else if constexpr (std::is_invocable_v<Callback&, Id, RequestPtr>) {
      call_ = std::forward<CallbackT>(callback);
    } else {
      call_ = [this, callback = Callback(std::forward<CallbackT>(callback))](
                  const Id& id, const RequestPtr& request) mutable {
        callback(this->shared_from_this(), id, request);
      };
    }
  }

  void send_response(rmw_request_id_t& id, Response& response) { send(id, &response); }

  std::shared_ptr<void> take() override {
    auto arrived = std::make_shared<Arrived>();
    return take_request(*arrived->id, arrived->request.get()) ? arrived : nullptr;
  }
  void execute(std::shared_ptr<void> taken) override {
    const auto& arrived = *static_cast<Arrived*>(taken.get());
    call_(arrived.id, arrived.request);
  }

 private:
  struct Arrived {
    Id id{std::make_shared<rmw_request_id_t>()};
    std::shared_ptr<Request> request{std::make_shared<Request>()};
  };
  std::function<void(const Id&, const std::shared_ptr<Request>&)> call_;
};

}  // namespace rclcpp
