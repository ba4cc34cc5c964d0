// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <utility>

namespace ignition::gazebo {
inline namespace v6 {
namespace components {

class BaseComponent {
 public:
  virtual ~BaseComponent() = default;
};

/// Explicit, as Gazebo's: a value alone is no component.
template <typename DataType, typename Identifier>
class Component : public BaseComponent {
 public:
  using Type = DataType;
  Component() = default;
  explicit Component(DataType data) : data_{std::move(data)} {}
  DataType& Data() { return data_; }
  const DataType& Data() const { return data_; }

 private:
  DataType data_{};
};

}  // namespace components
}  // namespace v6
}  // namespace ignition::gazebo
