// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "rclcpp/serialized_message.hpp"
#include "rclcpp/subscription.hpp"

namespace rclcpp {

/// A subscription to a type that is known by its name only: the callback gets the bytes.
class GenericSubscription : public SubscriptionBase {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(GenericSubscription)
  // Not const inside: rclcpp 16 hands out that, and what takes const takes it too.
  using Callback = std::function<void(std::shared_ptr<SerializedMessage>)>;

  /// @param type  "package/msg/Name". Throws std::runtime_error if this machine has no such type.
  GenericSubscription(std::shared_ptr<rcl_node_t> node, const std::string& topic,
                      const std::string& type, const QoS& qos, Callback callback,
                      bool ignore_local_publications);

  std::shared_ptr<void> take() override;
  void execute(std::shared_ptr<void> taken) override;

 private:
  Callback callback_;
};

}  // namespace rclcpp
