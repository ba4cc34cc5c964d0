// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <typeindex>
#include <unordered_map>
#include <utility>

namespace ignition::common {

class Event {
 public:
  virtual ~Event() = default;
};

/// An event of one signature; the tag tells two of them apart.
template <typename T, typename N>
class EventT : public Event {
 public:
  using CallbackT = std::function<T>;
  void Connect(const CallbackT& subscriber) { subscriber_ = subscriber; }
  template <typename... Args>
  void Signal(Args&&... args) const {
    if (subscriber_) subscriber_(std::forward<Args>(args)...);
  }

 private:
  CallbackT subscriber_;
};

}  // namespace ignition::common

namespace ignition::gazebo {
inline namespace v6 {

/// At most one subscriber of an event: the server.
class EventManager {
 public:
  template <typename E>
  void Connect(const typename E::CallbackT& subscriber) {
    event<E>().Connect(subscriber);
  }
  template <typename E, typename... Args>
  void Emit(Args&&... args) {
    event<E>().Signal(std::forward<Args>(args)...);
  }

 private:
  template <typename E>
  E& event() {
    auto& at = events_[typeid(E)];
    if (!at) at = std::make_unique<E>();
    return static_cast<E&>(*at);
  }
  std::unordered_map<std::type_index, std::unique_ptr<common::Event>> events_;
};

}  // namespace v6
}  // namespace ignition::gazebo
