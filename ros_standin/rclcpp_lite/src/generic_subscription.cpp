// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/generic_subscription.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace rclcpp {
namespace {

/// The library stays loaded: rcl keeps pointers into it.
void* load(const std::string& file) {
  if (void* const library = ::dlopen(file.c_str(), RTLD_LAZY)) return library;
  const char* const prefixes = std::getenv("AMENT_PREFIX_PATH");
  std::istringstream each(prefixes == nullptr ? "" : prefixes);
  for (std::string prefix; std::getline(each, prefix, ':');) {
    if (void* const library = ::dlopen((prefix + "/lib/" + file).c_str(), RTLD_LAZY))
      return library;
  }
  return nullptr;
}

const rosidl_message_type_support_t& type_support(const std::string& type) {
  const std::size_t first = type.find('/');
  const std::size_t last = type.rfind('/');
  if (first == std::string::npos || first == 0 || last + 1 == type.size()) {
    throw std::runtime_error("message type '" + type + "' is not of the form package/type");
  }
  const std::string package = type.substr(0, first);
  const std::string middle = last > first ? type.substr(first + 1, last - first - 1) : "msg";
  using Handle = const rosidl_message_type_support_t* (*)();
  void* const library = load("lib" + package + "__rosidl_typesupport_cpp.so");
  const std::string name = "rosidl_typesupport_cpp__get_message_type_support_handle__" + package +
                           "__" + middle + "__" + type.substr(last + 1);
  void* const symbol = library == nullptr ? nullptr : ::dlsym(library, name.c_str());
  if (symbol == nullptr) throw std::runtime_error("message type '" + type + "' is not installed");
  return *reinterpret_cast<Handle>(symbol)();
}

struct Sample {
  std::shared_ptr<SerializedMessage> bytes{std::make_shared<SerializedMessage>()};
  MessageInfo info;
};

}  // namespace

GenericSubscription::GenericSubscription(std::shared_ptr<rcl_node_t> node, const std::string& topic,
                                         const std::string& type, const QoS& qos, Callback callback,
                                         bool ignore_local_publications)
    : SubscriptionBase(std::move(node), topic, type_support(type), qos, ignore_local_publications),
      callback_(std::move(callback)) {}

std::shared_ptr<void> GenericSubscription::take() {
  auto sample = std::make_shared<Sample>();
  return take_bytes(sample->bytes->get_rcl_serialized_message(), sample->info) ? sample : nullptr;
}

void GenericSubscription::execute(std::shared_ptr<void> taken) {
  callback_(static_cast<Sample*>(taken.get())->bytes);
}

}  // namespace rclcpp
