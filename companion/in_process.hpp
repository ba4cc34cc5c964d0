// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "companion/transport.hpp"

namespace rosflight::companion {

/// A cable inside one process: two byte queues and a plug. Bytes written at one end can be read at
/// the other at once. Frames that do not fit are dropped whole and counted. One thread only.
class InProcessLink {
 public:
  /// @param capacity_bytes  size of each queue; what a fast FCU sends between two steps must fit.
  explicit InProcessLink(std::size_t capacity_bytes = 16384);
  InProcessLink(const InProcessLink&) = delete;
  InProcessLink& operator=(const InProcessLink&) = delete;

  Transport& companion_end() { return companion_; }
  Transport& fcu_end() { return fcu_; }

  /// Pulls (false) or puts back (true) the plug. Pulling loses what is in the queues.
  void plug(bool connected);

  std::size_t dropped_frames() const { return to_fcu_.dropped + to_companion_.dropped; }

 private:
  struct Queue {
    std::vector<std::uint8_t> bytes;
    std::size_t head{0};
    std::size_t used{0};
    std::size_t dropped{0};

    bool push(const std::uint8_t* data, std::size_t size);
    std::size_t pop(std::uint8_t* data, std::size_t capacity);
  };

  class End final : public Transport {
   public:
    End(InProcessLink& link, Queue& in, Queue& out) : link_(link), in_(in), out_(out) {}
    bool connected() override { return link_.plugged_; }
    std::size_t read(std::uint8_t* data, std::size_t capacity) override;
    bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;

   private:
    InProcessLink& link_;
    Queue& in_;
    Queue& out_;
  };

  bool plugged_{true};
  Queue to_fcu_;
  Queue to_companion_;
  End companion_{*this, to_companion_, to_fcu_};
  End fcu_{*this, to_fcu_, to_companion_};
};

}  // namespace rosflight::companion
