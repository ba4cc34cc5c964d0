// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/shared_bus.hpp"
#include "firmware/boards/stm32h7/dma_stream.hpp"
#include "firmware/boards/stm32h7/pins.hpp"

namespace rosflight::boards::stm32h7 {

/// Where the bytes of one SPI transfer lie for the DMA; an object of section .dma, one per bus.
struct SpiBuffers {
  alignas(32) std::array<std::uint8_t, parts::kMaxTransferBytes> out;
  alignas(32) std::array<std::uint8_t, parts::kMaxTransferBytes> in;
};

/// An SPI as master, mode 3, with software chip selects; transfers go by DMA. RM0433 ch. 50.
///
/// Everything is set up while the SPI is disabled; it is enabled for each transfer alone. The order for
/// DMA is that of the manual: receive request, both streams, transmit request, enable, start.
/// The image forwards the interrupt of the receive stream to on_interrupt().
class SpiBus final : public parts::BusHardware {
 public:
  struct Pins {
    Instance spi;
    Pin clock, in, out;
    unsigned function;  ///< Alternate function of the pins.
    unsigned receive_stream, transmit_stream;
    std::uint32_t receive_request;  ///< The transmit request is the next number.
    unsigned out_function{0};       ///< Function of the pin `out`, if it is another one.
  };
  struct Device {
    Pin select;
    std::uint32_t max_Hz;
  };

  /// `devices`, `count` of them, and `buffers` must outlive this.
  SpiBus(const Pins& pins, const Device* devices, std::size_t count, SpiBuffers& buffers)
      : pins_{pins},
        devices_{devices},
        device_count_{count},
        buffers_{buffers},
        receive_{pins.receive_stream},
        transmit_{pins.transmit_stream} {}

  /// Pins, streams, interrupt. Call it once, before the first transfer.
  void open(parts::SharedBus& bus);
  void on_interrupt();

  void begin(std::uint8_t device, const parts::Transfer& transfer) override;
  void abort() override;
  std::uint32_t mask() override;
  void unmask(std::uint32_t state) override;

 private:
  void end(bool failed);
  std::uint32_t divider_for(std::uint32_t max_Hz) const;

  Pins pins_;
  const Device* devices_;
  std::size_t device_count_;
  SpiBuffers& buffers_;
  DmaStream receive_;
  DmaStream transmit_;
  parts::SharedBus* bus_{nullptr};
  const parts::Transfer* transfer_{nullptr};
  std::uint8_t device_{0};
  std::uint32_t deselected_us_{0};
};

}  // namespace rosflight::boards::stm32h7
