// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "firmware/boards/stm32h7/emulator/core.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {

/// Time, memory and interrupts without a processor: a model under test is all there is.
class FakeCore final : public Core {
 public:
  static constexpr std::uint32_t kMemory = 0x3004'0000U, kCachedMemory = 0x2400'0000U;

  Ticks now() const override { return now_; }
  void set_due(Timed& timed, Ticks time) override {
    timed.due = time;
    if (std::find(timed_.begin(), timed_.end(), &timed) == timed_.end()) timed_.push_back(&timed);
  }
  void set_line(unsigned irq, bool high) override {
    if (high)
      lines.insert(irq);
    else
      lines.erase(irq);
  }
  std::uint8_t* memory(std::uint32_t address, std::size_t count) override {
    for (const std::uint32_t base : {kMemory, kCachedMemory, 0x2000'0000U}) {
      if (address >= base && address - base + count <= bytes.size())
        return bytes.data() + (address - base);
    }
    return nullptr;
  }
  bool cacheable(std::uint32_t address) const override { return address < uncached_from; }
  void request_reset() override { ++resets; }
  void bus_error() override { ++bus_errors; }
  void complain(const std::string& what) override { complaints.push_back(what); }

  /// Lets time pass, events in their order.
  void run_for(Ticks duration) {
    const Ticks end = now_ + duration;
    for (;;) {
      Timed* first = nullptr;
      for (Timed* const each : timed_) {
        if (each->due <= end && (first == nullptr || each->due < first->due)) first = each;
      }
      if (first == nullptr) break;
      now_ = std::max(now_, first->due);
      first->due = kNever;
      first->event(now_);
    }
    now_ = end;
  }
  /// The only complaint, forgotten then; empty if there is none or more than one.
  std::string only_complaint() {
    const std::vector<std::string> all = std::exchange(complaints, {});
    return all.size() == 1 ? all.front() : "";
  }

  std::array<std::uint8_t, 4096> bytes{};
  std::set<unsigned> lines;
  std::vector<std::string> complaints;
  int resets{0}, bus_errors{0};
  std::uint32_t uncached_from{kMemory};

 private:
  Ticks now_{0};
  std::vector<Timed*> timed_;
};

}  // namespace rosflight::boards::stm32h7::emulator::testing
