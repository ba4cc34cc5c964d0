// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/types.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace rclcpp::exceptions {

/// A call to rcl failed; what() has the call and rcl's own words.
class RCLError : public std::runtime_error {
 public:
  RCLError(rcl_ret_t code, const std::string& text) : std::runtime_error(text), ret(code) {}
  rcl_ret_t ret;
};

/// Throws RCLError with rcl's error text, which is cleared. `doing` completes "could not ...".
[[noreturn]] void throw_from_rcl_error(rcl_ret_t code, const std::string& doing);

class NameValidationError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};
class InvalidNodeNameError : public NameValidationError {
 public:
  using NameValidationError::NameValidationError;
};
class InvalidNamespaceError : public NameValidationError {
 public:
  using NameValidationError::NameValidationError;
};
class InvalidTopicNameError : public NameValidationError {
 public:
  using NameValidationError::NameValidationError;
};
class InvalidServiceNameError : public NameValidationError {
 public:
  using NameValidationError::NameValidationError;
};

/// Words after --ros-args that mean nothing.
class UnknownROSArgsError : public std::runtime_error {
 public:
  explicit UnknownROSArgsError(std::vector<std::string>&& words);
  const std::vector<std::string> unknown_ros_args;
};

class InvalidParametersException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class InvalidParameterValueException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class InvalidParameterTypeException : public std::runtime_error {
 public:
  InvalidParameterTypeException(const std::string& name, const std::string& message)
      : std::runtime_error("parameter '" + name + "' has invalid type: " + message) {}
};
class ParameterAlreadyDeclaredException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class ParameterNotDeclaredException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class ParameterImmutableException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class ParameterModifiedInCallbackException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class ParameterUninitializedException : public std::runtime_error {
 public:
  explicit ParameterUninitializedException(const std::string& name)
      : std::runtime_error("parameter '" + name + "' has no value") {}
};

}  // namespace rclcpp::exceptions
