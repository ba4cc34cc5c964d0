// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "firmware/boards/stm32h7/emulator/core.hpp"
#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// A window of registers that store what is written. Models derive from it and add behaviour.
class Peripheral : public Timed {
 public:
  /// @param block  of registers.csv: what registers there are and which bits they have.
  Peripheral(Core& core, std::string name, std::string_view block, const Instance& instance);
  Peripheral(const Peripheral&) = delete;
  Peripheral& operator=(const Peripheral&) = delete;

  /// An access of the processor; complains of registers and bits that do not exist, and if the
  /// peripheral stands still because its clock gate is closed.
  virtual std::uint32_t bus_read(std::uint32_t offset, unsigned size);
  virtual void bus_write(std::uint32_t offset, std::uint32_t value, unsigned size);

  virtual void reset();
  void event(Ticks now) override { static_cast<void>(now); }

  const std::string& name() const { return name_; }
  const Instance& instance() const { return instance_; }
  virtual std::uint32_t size() const { return static_cast<std::uint32_t>(words_.size() * 4); }
  /// What a register holds, without the effects of an access.
  std::uint32_t word(std::uint32_t offset) const { return words_[offset / 4]; }

  /// Injects a fault: the bus answers the next write with an error.
  void fail_next_write() { fails_ = true; }

 protected:
  virtual std::uint32_t read(std::uint32_t offset, unsigned size);
  virtual void write(std::uint32_t offset, std::uint32_t value, unsigned size);

  std::uint32_t& word(std::uint32_t offset) { return words_[offset / 4]; }
  /// Adds the registers of a block from `offset` on.
  void describe(std::string_view block, std::uint32_t offset);
  void complain(const std::string& what) const;
  Core& core() const { return core_; }

 private:
  Core& core_;
  std::string name_;
  Instance instance_;
  std::vector<std::uint32_t> words_;
  std::vector<std::uint32_t> defined_;  ///< Bits that exist; 0 for an offset without a register.
  bool fails_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
