// SPDX-License-Identifier: BSD-3-Clause
// Faults that tests inject into the hardware.
#include "firmware/boards/stm32h7/emulator/common_hardware.hpp"

namespace rosflight::boards::stm32h7::emulator {

void CommonHardware::inject(const ToChip& world) {
  switch (world.fault) {
    case HardwareFault::kNone:
      break;
    case HardwareFault::kBusError:
      (chip_.*wiring_.imu_bus).fail_next_write();
      break;
    case HardwareFault::kStuckInterrupt:
      chip_.interrupts.stick(wiring_.imu_ready.number);
      break;
    case HardwareFault::kDamagedFlash:
    case HardwareFault::kTornWord:
      inject_into_flash(world);
      break;
    case HardwareFault::kMute:
      mute_[static_cast<std::size_t>(world.faulty_part)] = true;
      break;
    case HardwareFault::kStuckBus:
      i2c_is_stuck_ = true;
      break;
    case HardwareFault::kSpeaksNmea:
      gnss_.nmea_only = true;
      break;
    case HardwareFault::kRepaired:
      repair();
      break;
    case HardwareFault::kLostEdges: {
      constexpr Ticks kDuration = 30'000 * kTicksPerMicrosecond;
      edges_lost_until_ = chip_.processor.now() + kDuration;
      break;
    }
    case HardwareFault::kOverrun:
      inject_overrun(world.faulty_part);
      break;
    case HardwareFault::kWrongIdentity:
    case HardwareFault::kBrownOut:
    case HardwareFault::kFlippedBit:
      inject_into_part(world);
      break;
  }
}

void CommonHardware::inject_into_flash(const ToChip& world) {
  parts::models::FlashModel& sectors = chip_.flash.sectors;
  if (world.fault == HardwareFault::kTornWord) {
    sectors.repair(0, torn_word_);
    torn_word_ = world.torn_word;
    if (!sectors.used(0, torn_word_)) chip_.processor.complain("the word to be torn is erased");
    sectors.damage(0, torn_word_);
    return;
  }
  for (const std::size_t sector : {0U, 1U}) {
    sectors.damage(sector, 0);  // one of two marks
    sectors.damage(sector, 2);  // the first block
  }
}

void CommonHardware::inject_overrun(FaultyPart part) {
  if (part == FaultyPart::kImu) return (chip_.*wiring_.imu_bus).lose_byte();
  const SerialPins& pins = part == FaultyPart::kGnss ? wiring_.gnss : wiring_.link;
  constexpr unsigned kWithinAFrame = 5;
  (chip_.*pins.uart).lose_byte(kWithinAFrame);
}

void CommonHardware::inject_into_part(const ToChip& world) {
  if (world.faulty_part == FaultyPart::kGnss) return gnss_on_wire_.flip_bit();
  const Breakable part = breakable(world.faulty_part);
  if (world.fault == HardwareFault::kWrongIdentity) return part.set_identity(true);
  if (world.fault == HardwareFault::kFlippedBit) return part.on_spi->flip_bit();
  for (parts::models::Part* const each : part.supplied) {
    browned_out_.push_back(each);
    each->set_power(false);
    each->set_power(true);
  }
}

std::function<void(bool)> CommonHardware::identity_of(parts::models::RegisterFile& registers,
                                                      std::uint8_t reg) {
  constexpr std::uint8_t kOfAnotherPart = 0x5A;
  return [&registers, reg](bool wrong) {
    registers.faults.answers.erase(reg);
    if (wrong) registers.faults.answers[reg] = kOfAnotherPart;
  };
}

void CommonHardware::repair() {
  mute_.fill(false);
  i2c_is_stuck_ = gnss_.nmea_only = false;
  for (const FaultyPart each : {FaultyPart::kImu, FaultyPart::kBaro, FaultyPart::kMag})
    breakable(each).set_identity(false);
}

}  // namespace rosflight::boards::stm32h7::emulator
