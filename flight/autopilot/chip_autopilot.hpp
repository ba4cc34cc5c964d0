// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "firmware/boards/stm32h7/host/chip_process.hpp"
#include "flight/autopilot/autopilot.hpp"
#include "flight/autopilot/cable_link.hpp"
#include "link/detect/detecting_codec.hpp"

namespace rosflight::flight {

/// The program of the emulated STM32H7, and the image of a board in the build tree.
boards::stm32h7::ChipProcess::Options emulated_chip(const std::string& board);

/// The companion's end of the UART or USB of the emulated chip. Bytes take their time there, so none is added
/// here; what a step sent is received at its end.
class ChipTransport final : public companion::Transport {
 public:
  /// Most bytes that wait for the chip; more are dropped, whole frames at a time.
  static constexpr std::size_t kCapacity = 4096;

  /// @param link  gives the time, the tap, and whether the cable is cut.
  explicit ChipTransport(CableLink& link) : link_{link} {}

  bool connected() override { return true; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;

  /// Bytes for the chip, at most `capacity` of them. @returns the number.
  std::size_t take(std::uint8_t* data, std::size_t capacity);
  /// Bytes from the chip.
  void put(const std::uint8_t* data, std::size_t size);

 private:
  void show(const std::uint8_t* data, std::size_t size);
  bool cut() { return link_.cable().to_board.cut(); }

  CableLink& link_;
  std::vector<std::uint8_t> to_chip_, from_chip_;
  link::DetectingCodec cutter_;  ///< Cuts what arrives into frames, for the tap.
  std::vector<std::uint8_t> frame_;
};

/// What is connected to a board.
struct ChipCables {
  bool usb{false};   ///< The link; otherwise on the UART.
  bool crsf{false};  ///< The receiver; otherwise S.Bus.
};

/// The unchanged image of a board on the emulated STM32H7, in lock-step.
///
/// One exchange per kChipStep: the chip runs up to the time of the step, while the models of its sensors
/// are exposed to what the world was since the last one, between two samples of it. The pulses that are on
/// the pins then act on the vehicle from then on, so the loop has the delay that it has on silicon, to half
/// a step. What the companion sends enters the wire one step late. Repeatable to the bit. Every function may
/// throw boards::EmulatorError, also because a model complained of the firmware.
class ChipAutopilot final : public Autopilot {
 public:
  using Process = boards::stm32h7::ChipProcess;

  /// @param link  must outlive this. A cut of the link pulls the cable.
  ChipAutopilot(CableLink& link, const Process::Options& options, ChipCables cables = {});

  unsigned substeps() const override;
  void start(sim::Time t) override;
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  void break_down(sim::Time t, Breakdown kind) override;
  sim::Time boot_time() const override { return boot_; }
  FirmwareView view() const override;
  companion::Transport& link() override { return transport_; }
  void set_link_tap(LinkTap* tap) override { link_.set_tap(tap); }
  std::optional<ProcessorFigures> figures() const override { return figures_; }

  Process& process() { return process_; }
  /// Rate of the companion's UART from the next step on; 921 600, the default of BAUD_RATE, before.
  void set_link_baud(std::uint32_t baud) { link_baud_ = baud; }
  /// Injects a fault in the next step, or with the power that break_down() gives back.
  void inject(boards::stm32h7::HardwareFault fault,
              boards::stm32h7::FaultyPart part = boards::stm32h7::FaultyPart::kImu) {
    fault_ = fault;
    faulty_part_ = part;
  }
  /// Makes this word of the first sector of parameters unreadable, and the one of the last call readable.
  void tear_flash(std::uint16_t word) {
    fault_ = boards::stm32h7::HardwareFault::kTornWord;
    torn_word_ = word;
  }

 private:
  void exchange(sim::Time t);
  void order_fault();
  void note_timing(const boards::stm32h7::FromChip& answer);
  void note_load(const boards::stm32h7::FromChip& answer);

  CableLink& link_;
  ChipCables cables_;
  Process process_;
  ChipTransport transport_;
  boards::stm32h7::HardwareFault fault_{
      boards::stm32h7::HardwareFault::kNone};  ///< Fault of the next step.
  boards::stm32h7::FaultyPart faulty_part_{};
  std::uint16_t torn_word_{0};
  hal::OutputValues outputs_{};
  ProcessorFigures figures_;
  std::uint32_t link_baud_{921'600};
  std::uint64_t timed_{0};          ///< Steps in the mean of imu_to_output_mean_us.
  std::vector<std::uint8_t> sent_;  ///< By the companion, before the step that begins.
  sim::Time boot_{};
  struct {
    std::int64_t time_us{};
    std::uint64_t busy_us{};
  } counted_;  ///< At the end of the last step.
  bool was_armed_{false};
};

}  // namespace rosflight::flight
