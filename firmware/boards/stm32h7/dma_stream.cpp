// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/dma_stream.hpp"

#include "firmware/boards/stm32h7/clocks.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr std::uint32_t kAllFlags = 0x3Du;
constexpr std::uint32_t kTransferError = 1u << 3u;

}  // namespace

unsigned DmaStream::irq() const {
  constexpr unsigned kIrqs[] = {
      irq::DMA1_STREAM0, irq::DMA1_STREAM1, irq::DMA1_STREAM2, irq::DMA1_STREAM3,
      irq::DMA1_STREAM4, irq::DMA1_STREAM5, irq::DMA1_STREAM6, irq::DMA1_STREAM7,
      irq::DMA2_STREAM0, irq::DMA2_STREAM1, irq::DMA2_STREAM2, irq::DMA2_STREAM3,
      irq::DMA2_STREAM4, irq::DMA2_STREAM5, irq::DMA2_STREAM6, irq::DMA2_STREAM7};
  return kIrqs[number_];
}

void DmaStream::connect(const Setup& setup) {
  open_gate(controller());
  if (runs()) stop();
  reg(DMAMUX1, 4u * number_) = setup.request;
  control_ = dma_stream::CR_DIR(static_cast<std::uint32_t>(setup.direction)) |
             dma_stream::CR_MINC(1) | dma_stream::CR_CIRC(setup.circular) |
             dma_stream::CR_TCIE(setup.interrupt) | dma_stream::CR_TEIE(setup.interrupt) |
             dma_stream::CR_HTIE(setup.half_interrupt) | dma_stream::CR_TRBUFF(setup.for_uart) |
             dma_stream::CR_PSIZE(setup.half_words) | dma_stream::CR_MSIZE(setup.half_words);
}

void DmaStream::start(std::uint32_t register_address, const volatile void* memory,
                      std::size_t count) {
  drop_flags();
  at(dma_stream::CR) = control_;
  at(dma_stream::NDTR) = static_cast<std::uint32_t>(count);
  at(dma_stream::PAR) = register_address;
  at(dma_stream::M0AR) = reinterpret_cast<std::uintptr_t>(memory);
  asm volatile("dmb" ::: "memory");  // the buffer is written before the controller reads it
  at(dma_stream::CR) = control_ | dma_stream::CR_EN(1);
}

void DmaStream::stop() {
  // Nothing else may change while it runs.
  modify(at(dma_stream::CR), dma_stream::CR_EN, 0);
  while (runs()) {
  }
  static_cast<void>(clear_flags());
}

bool DmaStream::clear_flags() {
  const auto& status = memory_at<const volatile std::uint32_t>(status_);
  const std::uint32_t flags = status >> shift_;
  drop_flags();
  const std::uint32_t back = status;
  static_cast<void>(back);  // the write has arrived: the interrupt does not come again
  return (flags & kTransferError) != 0;
}

void DmaStream::drop_flags() {
  memory_at<volatile std::uint32_t>(clear_) = kAllFlags << shift_;
}

}  // namespace rosflight::boards::stm32h7
