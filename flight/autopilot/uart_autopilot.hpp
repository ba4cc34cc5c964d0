// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "companion/transport.hpp"
#include "flight/autopilot/emulated_autopilot.hpp"
#include "link/detect/detecting_codec.hpp"

namespace rosflight::flight {

/// The companion's end of the emulated UART: a socket of the emulator.
class UartTransport final : public companion::Transport {
 public:
  /// @param clock  simulated time.
  UartTransport(boards::m7::Emulator& emulator, const hal::Time& clock)
      : emulator_{emulator}, now_{clock} {}
  void set_tap(LinkTap* tap) { tap_ = tap; }

  bool connected() override { return emulator_.uart() >= 0; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;

 private:
  void show(const std::uint8_t* data, std::size_t size);
  void send_rest();

  boards::m7::Emulator& emulator_;
  const hal::Time& now_;
  LinkTap* tap_{nullptr};
  std::vector<std::uint8_t> unsent_;
  link::DetectingCodec cutter_;  ///< Cuts what arrives into frames, for the tap.
  std::vector<std::uint8_t> frame_;
};

/// The firmware's image on an emulated Cortex-M7 in real time. Its own clock runs, the link goes
/// over its UART, and it reads samples from the block when its driver polls. The loop must run at
/// the pace of the wall clock. Not repeatable. Every function may throw boards::m7::EmulatorError.
class UartAutopilot final : public Autopilot {
 public:
  UartAutopilot(const hal::Time& clock, const boards::m7::Emulator::Options& options);

  void start(sim::Time t) override;
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override;
  void break_down(sim::Time t, Breakdown kind) override;
  sim::Time boot_time() const override { return boot_; }
  FirmwareView view() const override { return view_of(answer_.firmware); }
  std::optional<ProcessorFigures> figures() const override { return figures_; }
  companion::Transport& link() override { return transport_; }
  void set_link_tap(LinkTap* tap) override { transport_.set_tap(tap); }

  const boards::m7::FromProcessor& last_answer() const { return answer_; }

 private:
  void take_answer();

  boards::m7::Emulator emulator_;
  UartTransport transport_;
  boards::m7::Trouble trouble_{boards::m7::Trouble::kNone};
  boards::m7::FromProcessor answer_;
  ProcessorFigures figures_;
  sim::Time boot_{};
  int until_check_{0};
};

}  // namespace rosflight::flight
