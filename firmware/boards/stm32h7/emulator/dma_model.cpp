// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"

#include <cstring>
#include <utility>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kTransferError = 3, kHalf = 4, kComplete = 5;  // bits of a stream's flags
constexpr std::uint32_t kAllFlags = 0x3DU;
constexpr std::uint32_t kMemoryToPeripheral = 1;

/// Where the six flags of a stream lie in its register.
constexpr std::uint32_t shift_of(std::size_t stream) {
  constexpr std::uint32_t kShifts[] = {0, 6, 16, 22};
  return kShifts[stream % 4];
}

bool is_uart(std::uint32_t request) {
  return (request >= request::USART1_RX && request <= request::USART3_TX) ||
         (request >= request::UART4_RX && request <= request::UART5_TX) ||
         request == request::USART6_RX || request == request::USART6_TX ||
         (request >= request::UART7_RX && request <= request::UART8_TX);
}

}  // namespace

DmaMultiplexer::DmaMultiplexer(Core& core)
    : Peripheral{core, "DMAMUX1", "DMAMUX_CHANNEL", DMAMUX1} {
  for (std::uint32_t k = 1; k < kChannels; ++k) describe("DMAMUX_CHANNEL", 4 * k);
}

void DmaMultiplexer::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  if (stream_runs && stream_runs(offset / 4)) {
    complain("channel " + std::to_string(offset / 4) + " is changed while its stream runs");
  }
  word(offset) = value;
}

DmaModel::DmaModel(Core& core, std::string name, const Instance& instance,
                   const DmaMultiplexer& multiplexer, std::size_t first_channel,
                   const std::array<unsigned, kStreams>& irqs)
    : Peripheral{core, std::move(name), "DMA", instance},
      multiplexer_{multiplexer},
      first_channel_{first_channel},
      irqs_{irqs} {
  for (std::size_t k = 0; k < kStreams; ++k) describe("DMA_STREAM", at(k, 0));
}

void DmaModel::reset() {
  Peripheral::reset();
  stopping_.fill(false);
}

std::uint32_t DmaModel::read(std::uint32_t offset, unsigned /*size*/) {
  const std::uint32_t value = word(offset);
  for (std::size_t k = 0; k < kStreams; ++k) {
    if (offset == at(k, dma_stream::CR) && std::exchange(stopping_[k], false))
      word(offset) &= ~dma_stream::CR_EN.mask();
  }
  return value;
}

void DmaModel::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  if (offset == dma::LIFCR || offset == dma::HIFCR) {
    word(offset - dma::LIFCR + dma::LISR) &= ~value;
    const std::size_t first = offset == dma::LIFCR ? 0 : 4;
    for (std::size_t k = first; k < first + 4; ++k) drive_line(k);
    return;
  }
  if (offset < at(0, 0)) return complain("write to a register that can only be read");
  const std::size_t stream = (offset - at(0, 0)) / 0x18U;
  const std::uint32_t which = offset - at(stream, 0);
  if (which == dma_stream::CR) return write_control(stream, value);
  if (runs(stream)) {
    complain(name_of(stream) + "set up while it runs");
    return;
  }
  if (which == dma_stream::FCR && value != 0)
    complain(name_of(stream) + "FIFO mode is not modelled");
  word(offset) = value;
}

void DmaModel::write_control(std::size_t stream, std::uint32_t value) {
  std::uint32_t& control = word(at(stream, dma_stream::CR));
  const bool ran = runs(stream);
  const std::uint32_t enable = dma_stream::CR_EN.mask();
  const std::uint32_t interrupts = dma_stream::CR_TCIE.mask() | dma_stream::CR_HTIE.mask() |
                                   dma_stream::CR_TEIE.mask() | dma_stream::CR_DMEIE.mask();
  if (ran && ((control ^ value) & ~(enable | interrupts)) != 0) {
    complain(name_of(stream) + "set up while it runs");
    value = (value & (enable | interrupts)) | (control & ~(enable | interrupts));
  }
  control = value;
  const bool run = (value & enable) != 0;
  if (run && !ran) start(stream);
  if (!run && ran) {  // stopped by software: reported as complete
    control |= enable;
    stopping_[stream] = true;
    flag(stream, kComplete);
  }
  drive_line(stream);
}

void DmaModel::start(std::size_t stream) {
  const std::uint32_t control = word(at(stream, dma_stream::CR));
  const std::uint32_t request = multiplexer_.request(first_channel_ + stream);
  if (flags(stream) != 0) complain(name_of(stream) + "started with old flags");
  const std::uint32_t size = 1U << dma_stream::CR_PSIZE.of(control);
  if (dma_stream::CR_MSIZE.of(control) != dma_stream::CR_PSIZE.of(control)) {
    complain(name_of(stream) + "different sizes are not modelled");
  }
  if (is_uart(request) && dma_stream::CR_TRBUFF.of(control) == 0) {
    complain(name_of(stream) + "serves a UART without TRBUFF");
  }
  count_[stream] = word(at(stream, dma_stream::NDTR)) & 0xFFFFU;
  done_[stream] = 0;
  if (count_[stream] == 0) complain(name_of(stream) + "started with nothing to move");
  if (!reachable(stream, word(at(stream, dma_stream::M0AR)), count_[stream] * size)) {
    word(at(stream, dma_stream::CR)) &= ~dma_stream::CR_EN.mask();
    flag(stream, kTransferError);
    return;
  }
  if (on_start) on_start(request);
}

/// DMA1 and DMA2 do not reach the tightly coupled memories.
bool DmaModel::reachable(std::size_t stream, std::uint32_t address, std::uint32_t bytes) {
  const bool coupled =
      address < 0x0001'0000U || (address >= 0x2000'0000U && address < 0x2002'0000U);
  if (coupled || core().memory(address, bytes) == nullptr) {
    complain(name_of(stream) + "cannot reach its memory");
    return false;
  }
  if (memory_is_clocked && !memory_is_clocked(address)) {
    complain(name_of(stream) + "the clock gate of its memory is closed");
  }
  if (core().cacheable(address) || core().cacheable(address + bytes - 1)) {
    complain(name_of(stream) + "buffer lies in memory that the data cache may hold");
  }
  return true;
}

std::size_t DmaModel::stream_of(std::uint32_t request) const {
  for (std::size_t k = 0; k < kStreams; ++k) {
    if (multiplexer_.request(first_channel_ + k) == request && runs(k) && !stopping_[k]) return k;
  }
  return kStreams;
}

bool DmaModel::move(std::size_t stream, std::uint32_t& element) {
  std::uint32_t& control = word(at(stream, dma_stream::CR));
  std::uint32_t& left = word(at(stream, dma_stream::NDTR));
  const std::uint32_t size = 1U << dma_stream::CR_PSIZE.of(control);
  const std::uint32_t step = dma_stream::CR_MINC.of(control) != 0 ? done_[stream] * size : 0;
  std::uint8_t* const place = core().memory(word(at(stream, dma_stream::M0AR)) + step, size);
  if (place == nullptr) {
    control &= ~dma_stream::CR_EN.mask();
    flag(stream, kTransferError);
    return false;
  }
  if (dma_stream::CR_DIR.of(control) == kMemoryToPeripheral) {
    element = 0;
    std::memcpy(&element, place, size);
  } else {
    std::memcpy(place, &element, size);
  }
  ++done_[stream];
  --left;
  if (left == 0) {
    if (dma_stream::CR_CIRC.of(control) != 0) {
      left = count_[stream];
      done_[stream] = 0;
    } else {
      control &= ~dma_stream::CR_EN.mask();
    }
    flag(stream, kComplete);
  } else if (left == count_[stream] / 2) {
    flag(stream, kHalf);
  }
  return true;
}

void DmaModel::flag(std::size_t stream, std::uint32_t bit) {
  word(stream < 4 ? dma::LISR : dma::HISR) |= 1U << (shift_of(stream) + bit);
  drive_line(stream);
}

std::uint32_t DmaModel::flags(std::size_t stream) const {
  return word(stream < 4 ? dma::LISR : dma::HISR) >> shift_of(stream) & kAllFlags;
}

void DmaModel::drive_line(std::size_t stream) {
  const std::uint32_t f = flags(stream), control = word(at(stream, dma_stream::CR));
  const auto asks = [f, control](std::uint32_t bit, const Field& enable) {
    return (f >> bit & 1U) != 0 && enable.of(control) != 0;
  };
  core().set_line(irqs_[stream], asks(kComplete, dma_stream::CR_TCIE) ||
                                     asks(kHalf, dma_stream::CR_HTIE) ||
                                     asks(kTransferError, dma_stream::CR_TEIE));
}

bool DmaRequests::served(std::uint32_t request) const {
  for (const DmaModel* each : controllers_) {
    if (each->stream_of(request) != DmaModel::kStreams) return true;
  }
  return false;
}

std::uint32_t DmaRequests::width(std::uint32_t request) const {
  for (const DmaModel* each : controllers_) {
    const std::size_t stream = each->stream_of(request);
    if (stream != DmaModel::kStreams) return each->width(stream);
  }
  return 0;
}

bool DmaRequests::move(std::uint32_t request, std::uint32_t& element) const {
  for (DmaModel* each : controllers_) {
    const std::size_t stream = each->stream_of(request);
    if (stream != DmaModel::kStreams) return each->move(stream, element);
  }
  return false;
}

}  // namespace rosflight::boards::stm32h7::emulator
