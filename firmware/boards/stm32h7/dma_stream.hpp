// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>

#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {

/// One stream of DMA1 (0 to 7) or DMA2 (8 to 15), moving bytes or half words between one register and a
/// buffer. Any
/// stream serves any request. RM0433 ch. 15 and 17.
///
/// Buffers lie in memory that the controller reaches and the data cache does not hold: section .dma.
class DmaStream {
 public:
  enum class Direction : std::uint8_t { kToMemory = 0, kToRegister = 1 };
  struct Setup {
    std::uint32_t request{};
    Direction direction{Direction::kToMemory};
    bool circular{false};
    bool interrupt{false};  ///< At the end.
    bool half_interrupt{false};
    bool for_uart{false};    ///< Sets TRBUFF: else transfers may lock up (erratum of revision V).
    bool half_words{false};  ///< 16 bits at a time.
  };

  explicit constexpr DmaStream(unsigned number)
      : number_{number},
        registers_{controller().base + 0x10u + 0x18u * stream()},
        status_{controller().base + (stream() >= 4 ? dma::HISR : dma::LISR)},
        clear_{controller().base + (stream() >= 4 ? dma::HIFCR : dma::LIFCR)},
        shift_{kShifts[stream() % 4u]} {}

  unsigned irq() const;
  /// Opens the gate, stops the stream and connects the request.
  void connect(const Setup& setup);
  /// Starts a transfer. The stream must not run; its old flags are cleared.
  void start(std::uint32_t register_address, const volatile void* memory, std::size_t count);
  /// Stops and waits until the stream has stopped.
  void stop();
  bool runs() const { return dma_stream::CR_EN.of(at(dma_stream::CR)) != 0; }
  /// Elements that are still to come.
  std::size_t left() const { return at(dma_stream::NDTR) & 0xFFFFu; }
  /// Clears all flags, as the interrupt has to. @returns whether a transfer error was among them.
  bool clear_flags();

 private:
  void drop_flags();
  static constexpr std::uint8_t kShifts[] = {
      0, 6, 16, 22};  ///< Where the flags of a stream begin in their register.
  static constexpr unsigned kPerController = 8;
  constexpr const Instance& controller() const { return number_ < kPerController ? DMA1 : DMA2; }
  constexpr unsigned stream() const { return number_ % kPerController; }
  volatile std::uint32_t& at(std::uint32_t offset) const {
    return memory_at<volatile std::uint32_t>(registers_ + offset);
  }

  unsigned number_;
  std::uint32_t registers_;
  std::uint32_t status_, clear_;  ///< Addresses of the registers of flags.
  std::uint32_t shift_;
  std::uint32_t control_{0};
};

}  // namespace rosflight::boards::stm32h7
