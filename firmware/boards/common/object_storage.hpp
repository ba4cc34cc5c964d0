// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <new>

namespace rosflight::boards {

/// Memory for one object of an image, built when its time has come and never destroyed. Static, so that
/// interrupt handlers find it; without a constructor of its own, so that it is zero from the start.
template <class T>
class ObjectStorage {
 public:
  template <class... Arguments>
  T& make(Arguments&&... arguments) {
    object_ = new (memory_) T(static_cast<Arguments&&>(arguments)...);
    return *object_;
  }
  T* get() { return object_; }

 private:
  alignas(T) unsigned char memory_[sizeof(T)];
  T* object_;
};

}  // namespace rosflight::boards
