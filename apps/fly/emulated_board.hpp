// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

#include "apps/fly/cable_ends.hpp"
#include "apps/fly/flight_board.hpp"
#include "firmware/boards/qemu_m7/host/emulator.hpp"

namespace rosflight::apps {

/// The image of the emulated Cortex-M7 in the build tree.
std::filesystem::path emulated_image(const std::string& link_protocol = "mavlink");

/// The board module of the simulation: the firmware's image on an emulated Cortex-M7, in lock-step.
///
/// One exchange of the block per step. The board makes the same passes as FirmwareBoard, with the
/// same samples, bytes and clock; the frames it sends are pushed into the cable when it answers, in
/// their order, at the step's time. So both fly the same flight as far as they compute the same.
class EmulatedBoard final : public FlightBoard {
 public:
  using Emulator = boards::m7::Emulator;

  /// @param cable, clock, end  the wire to the companion, the world's time, and the board's plug;
  /// they must outlive this. @throws boards::m7::EmulatorError.
  EmulatedBoard(sim::SerialCable& cable, BoardEnd& end, const Emulator::Options& options);

  void start(sim::Time t) override;
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  void restart(sim::Time t, bool in_flight_fault) override;
  void break_down(sim::Time t, Breakdown kind) override;
  bool armed() const override { return emulator_.from_board().firmware.armed != 0; }
  sim::Time boot_time() const override { return boot_; }
  FirmwareView view() const override;
  std::optional<ProcessorFigures> figures() const override { return figures_; }

  /// The next step meets it.
  void make_trouble(boards::m7::Trouble trouble) { trouble_ = trouble; }
  Emulator& emulator() { return emulator_; }

 private:
  void boot(sim::Time t);
  void fill_link(sim::Time t);
  void take_answer();

  sim::SerialCable& cable_;
  BoardEnd& end_;
  Emulator emulator_;
  boards::m7::Trouble trouble_{boards::m7::Trouble::kNone};
  hal::OutputValues outputs_{};
  ProcessorFigures figures_;
  sim::Time boot_{};
};

/// Copies samples into a block, their stamps less `origin`.
void fill_samples(boards::m7::ToBoard& block, const sim::SensorSamples& samples,
                  const hal::RcFrame* rc, sim::Time origin);
FirmwareView view_of(const boards::m7::FirmwareGlance& glance);

}  // namespace rosflight::apps
