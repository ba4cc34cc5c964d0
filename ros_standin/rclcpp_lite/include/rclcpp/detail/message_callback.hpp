// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <type_traits>

#include "rclcpp/detail/arguments.hpp"
#include "rclcpp/message_info.hpp"
#include "rclcpp/serialized_message.hpp"

namespace rclcpp::detail {

/// Is T one of the forms in which rclcpp hands a message over, alone or with MessageInfo behind?
template <typename CallbackT, typename T, typename... Info>
inline constexpr bool kTakesForm =
    kDeclares<CallbackT, const T&, Info...> || kDeclares<CallbackT, std::unique_ptr<T>, Info...> ||
    kDeclares<CallbackT, std::shared_ptr<T>, Info...> ||
    kDeclares<CallbackT, std::shared_ptr<const T>, Info...> ||
    kDeclares<CallbackT, const std::shared_ptr<const T>&, Info...>;
template <typename CallbackT, typename T>
inline constexpr bool kTakes =
    kTakesForm<CallbackT, T> || kTakesForm<CallbackT, T, const MessageInfo&>;

/// A subscription's callback in any of the forms rclcpp takes: a message by const reference, unique
/// or shared pointer, or its bytes; with or without MessageInfo behind.
template <typename MessageT>
class MessageCallback {
 public:
  using Message = std::shared_ptr<MessageT>;
  using Bytes = std::shared_ptr<SerializedMessage>;

  template <typename CallbackT>
  explicit MessageCallback(CallbackT&& callback) {
    using Callback = std::decay_t<CallbackT>;
    static_assert(kTakes<Callback, MessageT> || kTakes<Callback, SerializedMessage>,
                  "rclcpp takes messages as const reference, unique or shared pointer");
    wants_its_own_ = !std::is_invocable_v<Callback&, SharedArgument<MessageT>> &&
                     !std::is_invocable_v<Callback&, SharedArgument<MessageT>, const MessageInfo&>;
    if constexpr (std::is_invocable_v<Callback&, Argument<MessageT>>) {
      call_ = [callback = Callback(std::forward<CallbackT>(callback))](
                  const Message& message, const Bytes&, const MessageInfo&) mutable {
        callback(Argument<MessageT>{message});
      };
    } else if constexpr (std::is_invocable_v<Callback&, Argument<MessageT>, const MessageInfo&>) {
      call_ = [callback = Callback(std::forward<CallbackT>(callback))](
                  const Message& message, const Bytes&, const MessageInfo& info) mutable {
        callback(Argument<MessageT>{message}, info);
      };
    } else {
      take_bytes(std::forward<CallbackT>(callback));
    }
  }

  bool wants_bytes() const { return wants_bytes_; }
  /// May it change the message, or keep it for itself?
  bool wants_its_own() const { return wants_its_own_; }
  void operator()(const Message& message, const Bytes& bytes, const MessageInfo& info) {
    call_(message, bytes, info);
  }

 private:
  /// Turns into whatever form the callback declares. A callback takes exactly one of them, so which
  /// conversion is used is never ambiguous; with a generic lambda it would be, as with rclcpp.
  template <typename T>
  struct Argument {
    const std::shared_ptr<T>& value;
    template <typename U, typename = std::enable_if_t<std::is_same_v<U, T>>>
    operator const U&() const {  // NOLINT: implicit on purpose
      return *value;
    }
    operator std::shared_ptr<T>() const { return value; }        // NOLINT: implicit on purpose
    operator std::shared_ptr<const T>() const { return value; }  // NOLINT: implicit on purpose
    operator std::unique_ptr<T>() const {                        // NOLINT: implicit on purpose
      return std::make_unique<T>(std::move(*value));
    }
  };

  /// The forms that leave the message to others, too.
  template <typename T>
  struct SharedArgument {
    template <typename U, typename = std::enable_if_t<std::is_same_v<U, T>>>
    operator const U&() const;                  // NOLINT: implicit on purpose
    operator std::shared_ptr<const T>() const;  // NOLINT: implicit on purpose
  };

  template <typename CallbackT>
  void take_bytes(CallbackT&& callback) {
    using Callback = std::decay_t<CallbackT>;
    wants_bytes_ = true;
    if constexpr (std::is_invocable_v<Callback&, Argument<SerializedMessage>>) {
      call_ = [callback = Callback(std::forward<CallbackT>(callback))](
                  const Message&, const Bytes& bytes, const MessageInfo&) mutable {
        callback(Argument<SerializedMessage>{bytes});
      };
    } else {
      static_assert(std::is_invocable_v<Callback&, Argument<SerializedMessage>, const MessageInfo&>,
                    "the callback takes neither the message nor its bytes");
      call_ = [callback = Callback(std::forward<CallbackT>(callback))](
                  const Message&, const Bytes& bytes, const MessageInfo& info) mutable {
        callback(Argument<SerializedMessage>{bytes}, info);
      };
    }
  }

  std::function<void(const Message&, const Bytes&, const MessageInfo&)> call_;
  bool wants_bytes_{false};
  bool wants_its_own_{false};
};

}  // namespace rclcpp::detail
