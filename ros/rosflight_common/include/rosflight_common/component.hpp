// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "rosflight_common/node_tools.hpp"

#if __has_include(<rclcpp_components/register_node_macro.hpp>)
#include <rclcpp_components/register_node_macro.hpp>
#define ROSFLIGHT_REGISTER_COMPONENT(Class) RCLCPP_COMPONENTS_REGISTER_NODE(Class)
#else
#define ROSFLIGHT_REGISTER_COMPONENT(Class)
#endif

/// Once in the source of a node, outside all namespaces: the node becomes a component.
///
/// Its library offers rosflight_make_node() to `compose`, registers the class with class_loader for ROS's component
/// containers where the package rclcpp_components is there, and, with ROSFLIGHT_NODE, has what the program of the node calls
/// (rosflight_add_node in cmake/rosflight_common-extras.cmake makes both).
#define ROSFLIGHT_COMPONENT(Class)                                           \
  extern "C" void rosflight_make_node(const rclcpp::NodeOptions& options,    \
                                      std::shared_ptr<rclcpp::Node>& node) { \
    node = std::make_shared<Class>(options);                                 \
  }                                                                          \
  ROSFLIGHT_REGISTER_COMPONENT(Class)

/// Beside it, in a node whose default callback group waits for another node or for the board: `compose` gives that group a thread
/// of its own, so that what it waits for goes on. Callbacks of its other groups return at once.
#define ROSFLIGHT_WAITS_IN_CALLBACKS extern "C" const bool rosflight_waits_in_callbacks = true;

/// A component whose program does nothing else, in an executor of rclcpp::executors.
#define ROSFLIGHT_NODE(Class, Executor)                                                \
  extern "C" int rosflight_node_main(int argc, char** argv) {                          \
    return rosflight_common::run_node<Class, rclcpp::executors::Executor>(argc, argv); \
  }                                                                                    \
  ROSFLIGHT_COMPONENT(Class)
