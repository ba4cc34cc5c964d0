// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "firmware/boards/stm32h7/emulator/peripheral.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Which request each stream serves.
class DmaMultiplexer final : public Peripheral {
 public:
  static constexpr std::size_t kChannels = 16;
  explicit DmaMultiplexer(Core& core);
  std::uint32_t request(std::size_t channel) const {
    return dmamux_channel::CCR_DMAREQ_ID.of(word(static_cast<std::uint32_t>(4 * channel)));
  }
  std::function<bool(std::size_t channel)> stream_runs;

 private:
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
};

/// DMA1 or DMA2: eight streams, direct mode, single and circular. RM0433 ch. 15.
///
/// Complains of: a stream set up while it runs; started with old flags; memory that it cannot reach
/// (it then stops with a transfer error, as the chip does) or that the data cache may hold; UART
/// requests without TRBUFF (erratum of revision V); sizes that are not modelled.
class DmaModel final : public Peripheral {
 public:
  static constexpr std::size_t kStreams = 8;
  DmaModel(Core& core, std::string name, const Instance& instance,
           const DmaMultiplexer& multiplexer, std::size_t first_channel,
           const std::array<unsigned, kStreams>& irqs);

  void reset() override;
  /// EN reads 1, also while a stopped stream ends its access.
  bool runs(std::size_t stream) const {
    return dma_stream::CR_EN.of(word(at(stream, dma_stream::CR))) != 0;
  }
  /// The running stream that serves a request, or kStreams.
  std::size_t stream_of(std::uint32_t request) const;
  /// Moves one element in the direction the stream was set up for.
  /// @returns false if the stream stopped with an error.
  bool move(std::size_t stream, std::uint32_t& element);
  /// Bytes of an element.
  std::uint32_t width(std::size_t stream) const {
    return 1U << dma_stream::CR_PSIZE.of(word(at(stream, dma_stream::CR)));
  }
  std::function<void(std::uint32_t request)> on_start;
  /// Whether the memory at this address has its clock.
  std::function<bool(std::uint32_t address)> memory_is_clocked;

 private:
  static constexpr std::uint32_t at(std::size_t stream, std::uint32_t offset) {
    return 0x10U + 0x18U * static_cast<std::uint32_t>(stream) + offset;
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::size_t stream, std::uint32_t value);
  void start(std::size_t stream);
  bool reachable(std::size_t stream, std::uint32_t address, std::uint32_t bytes);
  void flag(std::size_t stream, std::uint32_t bit);
  std::uint32_t flags(std::size_t stream) const;
  void drive_line(std::size_t stream);
  std::string name_of(std::size_t stream) const {
    return "stream " + std::to_string(stream) + ": ";
  }

  const DmaMultiplexer& multiplexer_;
  std::size_t first_channel_;
  std::array<unsigned, kStreams> irqs_;
  std::array<std::uint32_t, kStreams> count_{}, done_{};  ///< Elements of a round, and moved ones.
  std::array<bool, kStreams> stopping_{};  ///< Stopped by software: EN is 1 until it has been read.
};

/// What a peripheral with DMA requests sees of both controllers.
class DmaRequests {
 public:
  explicit DmaRequests(std::vector<DmaModel*> controllers) : controllers_{std::move(controllers)} {}
  bool served(std::uint32_t request) const;
  /// Bytes of an element of the stream that serves it; 0 if none does.
  std::uint32_t width(std::uint32_t request) const;
  /// @returns false if no stream serves it.
  bool move(std::uint32_t request, std::uint32_t& element) const;

 private:
  std::vector<DmaModel*> controllers_;
};

}  // namespace rosflight::boards::stm32h7::emulator
