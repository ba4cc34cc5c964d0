// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <utility>

#include "apps/fly/flight_board.hpp"
#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/firmware.hpp"
#include "link/codec.hpp"

namespace rosflight::apps {

/// A serial port that can say whether a pass of the main loop would find bytes.
class BoardSerial : public hal::Serial {
 public:
  virtual bool waiting() = 0;

 protected:
  ~BoardSerial() = default;
};

/// The board module of the simulation: the real firmware in this process, on the board of memory.
///
/// A real main loop spins many times between two IMU samples. Here one pass runs with what came by
/// radio and link, if anything did, and one with the sensors' samples: what a real one would have
/// done, less the idle passes. A reboot that the firmware asks for happens at the end of the step:
/// its clock starts at zero again, storage and backup memory stay.
class FirmwareBoard final : public FlightBoard {
 public:
  /// @param serial  the wire to the companion; must outlive this.
  /// @param protocol  what it speaks there: "mavlink" or "lean".
  explicit FirmwareBoard(BoardSerial& serial, std::string protocol = "mavlink");

  void start(sim::Time t) override;
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  bool armed() const override { return image_->firmware.state().armed(); }

  /// Power fails and returns: a reboot that backup memory does not survive. `in_flight_fault`
  /// leaves a crash record instead, as a fault handler would, and keeps backup memory.
  void restart(sim::Time t, bool in_flight_fault) override;
  /// A process cannot hang and be saved: either kind leaves a record and starts again at once.
  void break_down(sim::Time t, Breakdown /*kind*/) override { restart(t, true); }

  const core::Firmware& firmware() const { return image_->firmware; }
  boards::SimulatedBoard& board() { return board_; }
  sim::Time boot_time() const override { return boot_; }
  FirmwareView view() const override;

 private:
  struct Image {
    Image(const hal::Board& board, std::shared_ptr<link::Codec> link)
        : codec{std::move(link)}, firmware{board, *codec} {}
    std::shared_ptr<link::Codec> codec;
    core::Firmware firmware;
  };

  void boot(sim::Time t);
  hal::Time board_time(sim::Time t) const { return t - boot_; }

  BoardSerial& serial_;
  std::string protocol_;
  boards::SimulatedBoard board_;
  std::unique_ptr<Image> image_;  ///< From start() on.
  sim::Time boot_{};
};

}  // namespace rosflight::apps
