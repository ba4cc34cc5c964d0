// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <stdexcept>
#include <string>

namespace rosflight::python {

/// One thread at a time: calls compute without the interpreter's lock, so a second thread may come. It is
/// rejected, not held up: it would wait with that lock.
class Exclusive {
 public:
  class Use {
   public:
    /// @throws std::runtime_error  another thread uses it.
    Use(Exclusive& of, const char* what) : of_{of} {
      if (of_.taken_.exchange(true))
        throw std::runtime_error(std::string(what) + ": another thread is using it");
    }
    ~Use() { of_.taken_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    Exclusive& of_;
  };

 private:
  std::atomic<bool> taken_{false};
};

}  // namespace rosflight::python
