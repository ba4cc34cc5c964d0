// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <utility>

#include "firmware/core/firmware.hpp"
#include "link/codec.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

/// The firmware on a board of this process, rebuilt at each boot.
class HostedFirmware {
 public:
  /// Builds the firmware again and starts it; it reads its parameters from the board's storage.
  /// The caller has reset the board's clock.
  void boot(const hal::Board& board, std::shared_ptr<link::Codec> codec) {
    image_.reset();
    image_ = std::make_unique<Image>(board, std::move(codec));
    image_->firmware.start();
  }
  /// The firmware and its codec as they are now, to go on from here again.
  struct Moment {
    std::shared_ptr<link::Codec> codec;  ///< The same object: the firmware refers to it.
    core::Firmware firmware;
  };
  Moment save() const { return {image_->codec, image_->firmware}; }
  /// @param moment  of this object. The state of the codec is the caller's to restore.
  void restore(const Moment& moment) {
    image_.reset();
    image_ = std::make_unique<Image>(moment);
  }
  core::Firmware& operator*() { return image_->firmware; }
  const core::Firmware& operator*() const { return image_->firmware; }

 private:
  struct Image {
    Image(const hal::Board& board, std::shared_ptr<link::Codec> link)
        : codec{std::move(link)}, firmware{board, *codec} {}
    explicit Image(const Moment& moment) : codec{moment.codec}, firmware{moment.firmware} {}
    std::shared_ptr<link::Codec> codec;
    core::Firmware firmware;
  };
  std::unique_ptr<Image> image_;  ///< Empty before the first boot.
};

/// Puts new samples into the mailboxes of a board.
/// @param to_board_time  converts a stamp of simulated time to the board's clock.
template <class Board, class ToBoardTime>
void deliver(const sim::SensorSamples& samples, Board& board, ToBoardTime&& to_board_time) {
  const auto put = [&to_board_time](auto& mailbox, bool is_new, auto sample) {
    if (!is_new) return;
    sample.stamp = to_board_time(sample.stamp);
    mailbox.put(sample);
  };
  put(board.imu, samples.has_imu, samples.imu);
  put(board.mag, samples.has_mag, samples.mag);
  put(board.baro, samples.has_baro, samples.baro);
  put(board.diff_pressure, samples.has_diff_pressure, samples.diff_pressure);
  put(board.range, samples.has_range, samples.range);
  put(board.gnss, samples.has_gnss, samples.gnss);
  put(board.battery, samples.has_battery, samples.battery);
}

}  // namespace rosflight::flight
