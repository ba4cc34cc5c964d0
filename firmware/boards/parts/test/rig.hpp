// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/models/part.hpp"
#include "firmware/boards/parts/shared_bus.hpp"

/// Drivers and models of parts on simulated buses: time goes from event to event, transfers take the
/// time of their bits, a tick comes once per millisecond.
namespace rosflight::boards::parts {

class Rig final : public hal::Clock {
 public:
  static constexpr Time kTick = hal::milliseconds(1);

  /// A bus that exchanges the bytes of a transfer with a model when it ends.
  class Wires : public BusHardware {
   protected:
    Rig& rig_;

   public:
    explicit Wires(Rig& rig) : rig_{rig} { rig.wires_.push_back(this); }
    virtual ~Wires() = default;
    void abort() override {
      running_ = nullptr;
      ++aborts;
    }
    std::uint32_t mask() override { return 0; }
    void unmask(std::uint32_t /*state*/) override {}

    bool stuck{false};  ///< Transfers do not end.
    bool fault{false};  ///< Transfers end with a bus fault.
    int aborts{0};
    std::uint64_t transfers{0};
    SharedBus bus{*this, rig_};

   protected:
    void begin_for(std::uint8_t device, const Transfer& transfer, Time duration) {
      ++transfers;
      device_ = device;
      running_ = &transfer;
      ends_ = stuck ? models::kNever : rig_.now_ + duration;
    }
    virtual TransferResult exchange(std::uint8_t device, const Transfer& transfer) = 0;

   private:
    friend class Rig;
    void end() {
      const Transfer& transfer = *running_;
      running_ = nullptr;
      bus.complete(fault ? TransferResult::kBusFault : exchange(device_, transfer));
    }
    const Transfer* running_{nullptr};
    std::uint8_t device_{};
    Time ends_{};
  };

  class Spi final : public Wires {
   public:
    Spi(Rig& rig, double hz) : Wires{rig}, hz_{hz} {}
    void connect(std::uint8_t device, models::SpiPart& part) {
      parts_[device] = &part;
      rig_.add(part);
    }
    void begin(std::uint8_t device, const Transfer& t) override {
      const double bits = 8.0 * static_cast<double>(t.out_count + t.in_count);
      begin_for(device, t, Time{static_cast<std::int64_t>(2.0 + bits / hz_ * 1e6)});
    }

   private:
    TransferResult exchange(std::uint8_t device, const Transfer& t) override {
      models::SpiPart& part = *parts_.at(device);
      part.advance(rig_.now_);
      part.select(true);
      for (std::size_t k = 0; k < t.out_count; ++k) part.exchange(t.out[k]);
      for (std::size_t k = 0; k < t.in_count; ++k) t.in[k] = part.exchange(0);
      part.select(false);
      return TransferResult::kDone;
    }
    double hz_;
    std::map<std::uint8_t, models::SpiPart*> parts_;
  };

  class I2c final : public Wires {
   public:
    I2c(Rig& rig, double hz) : Wires{rig}, hz_{hz} {}
    void connect(models::I2cPart& part) {
      parts_[part.address()] = &part;
      rig_.add(part);
    }
    void begin(std::uint8_t device, const Transfer& t) override {
      const double bits = 9.0 * static_cast<double>(t.out_count + t.in_count + 2);
      begin_for(device, t, Time{static_cast<std::int64_t>(bits / hz_ * 1e6)});
    }

   private:
    TransferResult exchange(std::uint8_t device, const Transfer& t) override {
      const auto found = parts_.find(device);
      if (found == parts_.end()) return TransferResult::kNoAnswer;
      models::I2cPart& part = *found->second;
      part.advance(rig_.now_);
      bool answers = t.out_count == 0 || part.begin(false);
      for (std::size_t k = 0; answers && k < t.out_count; ++k) answers = part.write(t.out[k]);
      answers = answers && (t.in_count == 0 || part.begin(true));
      for (std::size_t k = 0; answers && k < t.in_count; ++k) t.in[k] = part.read();
      part.stop();
      return answers ? TransferResult::kDone : TransferResult::kNoAnswer;
    }
    double hz_;
    std::map<std::uint8_t, models::I2cPart*> parts_;
  };

  Time now() const override { return now_; }
  void add(models::Part& part) { parts_.push_back(&part); }
  void add(Driver& driver) {
    ticks.emplace_back([&driver](Time now) { driver.step(now); });
  }
  void run_for(Time duration) { run_until(now_ + duration); }
  void run_until(Time end) {
    while (step(end)) {
    }
  }
  /// Until `done` or for `limit`. @returns how long it took.
  Time run_until(const std::function<bool()>& done, Time limit) {
    const Time begun = now_;
    while (!done() && step(begun + limit)) {
    }
    return now_ - begun;
  }

  std::vector<std::function<void(Time)>> ticks;
  bool ticking{true};

 private:
  /// One event. @returns false if there is none before `end`, to which time then went.
  bool step(Time end) {
    Time next = ticking ? tick_ : models::kNever;
    for (const models::Part* part : parts_) next = std::min(next, part->next_event());
    for (const Wires* wires : wires_) {
      if (wires->running_ != nullptr) next = std::min(next, wires->ends_);
    }
    if (next > end) {
      now_ = end;
      for (models::Part* part : parts_) part->advance(now_);
      return false;
    }
    now_ = std::max(now_, next);
    for (models::Part* part : parts_) part->advance(now_);
    for (Wires* wires : wires_) {
      if (wires->running_ != nullptr && wires->ends_ <= now_) wires->end();
    }
    if (ticking && tick_ <= now_) {
      tick_ += kTick;
      for (Wires* wires : wires_) wires->bus.step();
      for (const auto& tick : ticks) tick(now_);
    }
    return true;
  }

  Time now_{};
  Time tick_{kTick};
  std::vector<models::Part*> parts_;
  std::vector<Wires*> wires_;
};

}  // namespace rosflight::boards::parts
