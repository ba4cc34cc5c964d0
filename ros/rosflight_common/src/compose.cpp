// SPDX-License-Identifier: BSD-3-Clause
// Several nodes in one process, for machines without ROS's component_container:
//
//     compose PACKAGE/NODE[:NAME]... [--ros-args ...]
//
// NODE is the name of the node's program, NAME what it is called here. Arguments of ROS go to all nodes; with
// `-p NAME:parameter:=value` to one. Ends as a node does: on SIGINT with 0, with one line and 2 if a node cannot be made.
#include <dlfcn.h>

#include <cstdio>
#include <exception>
#include <future>
#include <list>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/paths.hpp"

namespace rosflight_common {
namespace {

using MakeNode = void (*)(const rclcpp::NodeOptions&, std::shared_ptr<rclcpp::Node>&);

struct Component {
  std::string package;
  std::string node;
  std::string name;  ///< Empty: the node's own.
};

Component parse(const std::string& word) {
  const std::size_t slash = word.find('/');
  const std::size_t colon = word.find(':');
  if (slash == std::string::npos || slash == 0 || colon < slash) {
    throw std::runtime_error("component: found '" + word +
                             "', allowed PACKAGE/NODE or PACKAGE/NODE:NAME");
  }
  Component component;
  component.package = word.substr(0, slash);
  component.node = word.substr(slash + 1, colon - slash - 1);
  if (colon != std::string::npos) component.name = word.substr(colon + 1);
  return component;
}

std::string library_of(const Component& component) {
  const auto file = installed("lib/lib" + component.package + "_" + component.node + ".so");
  if (file) return *file;
  throw std::runtime_error("component: found " + component.package + "/" + component.node +
                           ", allowed a node of an installed package");
}

struct Loaded {
  std::shared_ptr<rclcpp::Node> node;
  bool waits;  ///< In callbacks of its default group.
};

Loaded make(const Component& component) {
  // Never unloaded: what the node leaves in ROS calls into the library until the process ends.
  void* const library = ::dlopen(library_of(component).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(::dlerror());
  const auto make_node = reinterpret_cast<MakeNode>(::dlsym(library, "rosflight_make_node"));
  if (make_node == nullptr) throw std::runtime_error(component.node + " is no component");
  const bool waits = ::dlsym(library, "rosflight_waits_in_callbacks") != nullptr;
  rclcpp::NodeOptions options;
  options.use_clock_thread(waits);  // a thread for each node's clock costs more than the nodes
  options.use_intra_process_comms(true);
  if (!component.name.empty()) options.arguments({"--ros-args", "-r", "__node:=" + component.name});
  std::shared_ptr<rclcpp::Node> node;
  make_node(options, node);
  return {node, waits};
}

/// One thread for all callbacks that return at once: a message between two of them takes no change of threads, and there are
/// thousands in a second. A thread for each node that waits.
class Threads {
 public:
  void add(const Loaded& loaded) {
    if (!loaded.waits) return shared_.add_node(loaded.node);
    const auto base = loaded.node->get_node_base_interface();
    auto& own = own_.emplace_back();
    loaded.node->for_each_callback_group([&](const rclcpp::CallbackGroup::SharedPtr& group) {
      if (!group->automatically_add_to_executor_with_node()) return;
      const bool may_wait = group == base->get_default_callback_group();
      (may_wait ? own : shared_).add_callback_group(group, base);
    });
  }

  /// Until the end of ROS, or the first exception of a callback.
  void spin() {
    std::vector<std::future<void>> ends;
    for (auto& executor : own_) {
      ends.push_back(std::async(std::launch::async, [this, &executor] { spin(executor); }));
    }
    spin(shared_);
    for (std::future<void>& end : ends) end.get();
  }

 private:
  void spin(rclcpp::Executor& executor) {
    try {
      executor.spin();
    } catch (...) {
      // Ends the others, those too that do not spin yet: they would miss a cancel(). False: ROS had ended before, and the
      // callback threw because of that.
      if (rclcpp::shutdown()) throw;
    }
  }

  rclcpp::executors::SingleThreadedExecutor shared_;
  std::list<rclcpp::executors::SingleThreadedExecutor> own_;
};

/// Waits for the end. `spins` becomes true when the nodes are made.
void run(int argc, char** argv, bool& spins) {
  std::vector<Loaded> nodes;
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--ros-args"; ++i) {
    // One argument may name several: `ros2 launch` passes on the value of a variable as one, spaces and all.
    std::istringstream words(argv[i]);
    for (std::string word; words >> word;) nodes.push_back(make(parse(word)));
  }
  if (nodes.empty())
    throw std::runtime_error("component: found none, allowed PACKAGE/NODE[:NAME]...");
  Threads threads;
  for (const Loaded& loaded : nodes) threads.add(loaded);
  rclcpp::Node& first = *nodes.front().node;
  const auto watch = warn_without_clock(first);
  RCLCPP_INFO(first.get_logger(), "ready: %zu nodes in one process", nodes.size());
  spins = true;
  threads.spin();
}

}  // namespace
}  // namespace rosflight_common

int main(int argc, char** argv) {
  bool started = false;
  bool spins = false;
  try {
    rclcpp::init(argc, argv);
    started = true;
    rosflight_common::run(argc, argv, spins);
  } catch (const std::exception& why) {
    if (started && !spins && !rclcpp::ok()) return 0;  // SIGINT while the nodes are being made
    std::fprintf(stderr, "compose: %s\n", rosflight_common::one_line(why.what()).c_str());
    rclcpp::shutdown();
    return 2;
  }
  rclcpp::shutdown();
  return 0;
}
