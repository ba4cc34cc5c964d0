// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameters.hpp"

#include <algorithm>
#include <set>

#include "parameter_services.hpp"
#include "rclcpp/exceptions.hpp"

namespace rclcpp::detail {

using rcl_interfaces::msg::ParameterEvent;
using Lock = std::lock_guard<std::recursive_mutex>;

/// Callbacks may read, but not change parameters.
class NodeParameters::InCallback {
 public:
  explicit InCallback(bool& flag) : flag_(flag) { flag_ = true; }
  ~InCallback() { flag_ = false; }
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;

 private:
  bool& flag_;
};

namespace {
NodeParameters::Result refused(const std::string& reason) {
  NodeParameters::Result result;
  result.successful = false;
  result.reason = reason;
  return result;
}
NodeParameters::Result accepted() {
  NodeParameters::Result result;
  result.successful = true;
  return result;
}
}  // namespace

NodeParameters::NodeParameters(node_interfaces::NodeBaseInterface::SharedPtr base,
                               Clock::SharedPtr clock, const NodeOptions& options)
    : base_(std::move(base)),
      clock_(std::move(clock)),
      allow_undeclared_(options.allow_undeclared_parameters()) {
  overrides_ = parameter_overrides(*base_->get_rcl_node_handle(),
                                   *base_->get_context()->get_rcl_context(), options);
  if (options.start_parameter_event_publisher()) {
    events_ = std::make_shared<Publisher<ParameterEvent>>(base_->get_shared_rcl_node_handle(),
                                                          "/parameter_events",
                                                          options.parameter_event_qos(), nullptr);
  }
  if (options.start_parameter_services()) {
    services_ = std::make_unique<ParameterServices>(*base_, *this);
  }
  if (options.automatically_declare_parameters_from_overrides()) {
    Descriptor descriptor;
    descriptor.dynamic_typing = true;
    for (const auto& [name, value] : overrides_) {
      declare(name, value, value.get_type(), descriptor, true);
    }
  }
}

NodeParameters::~NodeParameters() = default;

void NodeParameters::must_not_be_in_callback() const {
  if (in_callback_) {
    throw exceptions::ParameterModifiedInCallbackException(
        "a callback that decides on parameters cannot change any");
  }
}

const ParameterValue& NodeParameters::declare(const std::string& name, const ParameterValue& value,
                                              ParameterType type, Descriptor descriptor,
                                              bool ignore_override) {
  const Lock lock(mutex_);
  must_not_be_in_callback();
  if (name.empty()) throw exceptions::InvalidParametersException("a parameter needs a name");
  if (declared_.count(name) != 0) {
    throw exceptions::ParameterAlreadyDeclaredException("parameter '" + name +
                                                        "' is declared already");
  }
  if (type == PARAMETER_NOT_SET && !descriptor.dynamic_typing) {
    throw exceptions::InvalidParameterTypeException(
        name, "one without value and type must be declared with dynamic_typing");
  }
  const auto given = overrides_.find(name);
  const bool overridden = !ignore_override && given != overrides_.end();
  const auto& initial = overridden ? given->second : value;
  if (initial.get_type() != PARAMETER_NOT_SET) {
    if (!descriptor.dynamic_typing && initial.get_type() != type) {
      throw exceptions::InvalidParameterTypeException(
          name, "declared as [" + to_string(type) + "], given [" + to_string(initial.get_type()) +
                    "] " + to_string(initial));
    }
    const Parameter parameter(name, initial);
    auto reason = out_of_range(parameter, descriptor);
    if (reason.empty()) {
      const auto result = ask_callbacks({parameter});
      if (!result.successful) reason = "parameter '" + name + "' refused: " + result.reason;
    }
    if (!reason.empty()) throw exceptions::InvalidParameterValueException(reason);
  }
  descriptor.name = name;
  descriptor.type = type;
  auto& declared = declared_[name];
  declared = {initial, std::move(descriptor)};
  if (initial.get_type() != PARAMETER_NOT_SET) {
    ParameterEvent event;
    event.new_parameters.push_back(Parameter(name, initial).to_parameter_msg());
    publish(event);
  }
  return declared.value;
}

void NodeParameters::undeclare(const std::string& name) {
  const Lock lock(mutex_);
  must_not_be_in_callback();
  const auto found = declared_.find(name);
  if (found == declared_.end()) {
    throw exceptions::ParameterNotDeclaredException("parameter '" + name + "' is not declared");
  }
  if (found->second.descriptor.read_only) {
    throw exceptions::ParameterImmutableException("parameter '" + name + "' is read-only");
  }
  if (!found->second.descriptor.dynamic_typing) {
    throw exceptions::InvalidParameterTypeException(name,
                                                    "one with a fixed type cannot be undeclared");
  }
  declared_.erase(found);
}

bool NodeParameters::has(const std::string& name) const {
  const Lock lock(mutex_);
  return declared_.count(name) != 0;
}

NodeParameters::Result NodeParameters::acceptable(const Parameter& parameter) const {
  const auto& name = parameter.get_name();
  const auto found = declared_.find(name);
  if (found == declared_.end()) return accepted();  // undeclared ones are allowed
  const auto& descriptor = found->second.descriptor;
  if (descriptor.read_only) return refused("parameter '" + name + "' is read-only");
  if (!descriptor.dynamic_typing && parameter.get_type() != descriptor.type) {
    return refused("parameter '" + name + "' is of type [" +
                   to_string(static_cast<ParameterType>(descriptor.type)) + "], not [" +
                   parameter.get_type_name() + "]");
  }
  const auto reason = out_of_range(parameter, descriptor);
  return reason.empty() ? accepted() : refused(reason);
}

NodeParameters::Result NodeParameters::ask_callbacks(const std::vector<Parameter>& parameters) {
  const InCallback guard(in_callback_);
  callbacks_.remove_if([](const auto& callback) { return callback.expired(); });
  for (const auto& weak : callbacks_) {
    const auto callback = weak.lock();
    if (!callback) continue;
    auto result = callback->callback(parameters);
    if (!result.successful) return result;
  }
  return accepted();
}

NodeParameters::Result NodeParameters::set(const std::vector<Parameter>& parameters) {
  std::vector<Parameter> changed;
  {
    const Lock lock(mutex_);
    must_not_be_in_callback();
    for (const auto& parameter : parameters) {
      const auto& name = parameter.get_name();
      if (name.empty()) throw exceptions::InvalidParametersException("a parameter needs a name");
      if (!allow_undeclared_ && declared_.count(name) == 0) {
        throw exceptions::ParameterNotDeclaredException("parameter '" + name + "' is not declared");
      }
    }
    for (const auto& parameter : parameters) {
      const auto result = acceptable(parameter);
      if (!result.successful) return result;
    }
    const auto result = ask_callbacks(parameters);
    if (!result.successful) return result;

    ParameterEvent event;
    for (const auto& parameter : parameters) {
      const auto found = declared_.find(parameter.get_name());
      const bool is_new =
          found == declared_.end() || found->second.value.get_type() == PARAMETER_NOT_SET;
      if (parameter.get_type() == PARAMETER_NOT_SET) {
        if (found != declared_.end()) {
          event.deleted_parameters.push_back(
              Parameter(parameter.get_name(), found->second.value).to_parameter_msg());
          declared_.erase(found);
        }
        continue;
      }
      auto& declared = declared_[parameter.get_name()];
      if (found == declared_.end()) {
        declared.descriptor.name = parameter.get_name();
        declared.descriptor.type = parameter.get_type();
        declared.descriptor.dynamic_typing = true;
      }
      declared.value = parameter.get_parameter_value();
      (is_new ? event.new_parameters : event.changed_parameters)
          .push_back(parameter.to_parameter_msg());
      changed.push_back(parameter);
    }
    publish(event);
  }
  if (watcher_) std::for_each(changed.begin(), changed.end(), watcher_);
  return accepted();
}

void NodeParameters::publish(ParameterEvent& event) {
  if (!events_) return;
  event.node = base_->get_fully_qualified_name();
  event.stamp = clock_->now();
  events_->publish(event);
}

bool NodeParameters::find(const std::string& name, Parameter& parameter) const {
  const Lock lock(mutex_);
  const auto found = declared_.find(name);
  if (found == declared_.end() || found->second.value.get_type() == PARAMETER_NOT_SET) return false;
  parameter = Parameter(name, found->second.value);
  return true;
}

Parameter NodeParameters::get(const std::string& name) const {
  const Lock lock(mutex_);
  Parameter parameter(name);
  if (find(name, parameter) || allow_undeclared_) return parameter;
  const auto found = declared_.find(name);
  if (found == declared_.end()) {
    throw exceptions::ParameterNotDeclaredException("parameter '" + name + "' is not declared");
  }
  if (found->second.descriptor.dynamic_typing) return parameter;
  throw exceptions::ParameterUninitializedException(name);
}

NodeParameters::Descriptor NodeParameters::describe(const std::string& name) const {
  const Lock lock(mutex_);
  const auto found = declared_.find(name);
  if (found != declared_.end()) return found->second.descriptor;
  if (!allow_undeclared_) {
    throw exceptions::ParameterNotDeclaredException("parameter '" + name + "' is not declared");
  }
  Descriptor descriptor;
  descriptor.name = name;
  return descriptor;
}

rcl_interfaces::msg::ListParametersResult NodeParameters::list(
    const std::vector<std::string>& prefixes, std::uint64_t depth) const {
  const Lock lock(mutex_);
  const auto is_within = [depth](const std::string& name) {
    const auto levels = static_cast<std::uint64_t>(std::count(name.begin(), name.end(), '.'));
    return depth == 0 || levels < depth;  // 0 is DEPTH_RECURSIVE
  };
  const auto is_below = [&](const std::string& name, const std::string& prefix) {
    return name == prefix ||
           (name.rfind(prefix + ".", 0) == 0 && is_within(name.substr(prefix.size() + 1)));
  };
  rcl_interfaces::msg::ListParametersResult result;
  std::set<std::string> found_prefixes;
  for (const auto& [name, declared] : declared_) {
    const bool wanted =
        prefixes.empty()
            ? is_within(name)
            : std::any_of(prefixes.begin(), prefixes.end(),
                          [&, &key = name](const auto& prefix) { return is_below(key, prefix); });
    if (!wanted) continue;
    result.names.push_back(name);
    const auto last = name.rfind('.');
    if (last != std::string::npos) found_prefixes.insert(name.substr(0, last));
  }
  result.prefixes.assign(found_prefixes.begin(), found_prefixes.end());
  return result;
}

NodeParameters::Handle::SharedPtr NodeParameters::add_callback(
    Handle::OnSetParametersCallbackType callback) {
  const Lock lock(mutex_);
  must_not_be_in_callback();
  auto handle = std::make_shared<Handle>();
  handle->callback = std::move(callback);
  callbacks_.push_front(handle);
  return handle;
}

void NodeParameters::remove_callback(const Handle* handle) {
  const Lock lock(mutex_);
  must_not_be_in_callback();
  const auto before = callbacks_.size();
  callbacks_.remove_if([&](const auto& ours) { return ours.lock().get() == handle; });
  if (callbacks_.size() == before) throw std::runtime_error("this callback was not there");
}

}  // namespace rclcpp::detail
