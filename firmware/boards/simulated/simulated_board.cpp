// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/simulated/simulated_board.hpp"

#include <algorithm>

namespace rosflight::boards {

bool SimulatedStorage::read(std::size_t offset, std::uint8_t* data, std::size_t count) {
  if (power_cut_ || offset > bytes_.size() || count > bytes_.size() - offset) return false;
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), count, data);
  return true;
}

bool SimulatedStorage::write(std::size_t offset, const std::uint8_t* data, std::size_t count) {
  if (power_cut_ || offset > bytes_.size() || count > bytes_.size() - offset) return false;
  const std::size_t written = bytes_left_ ? std::min(count, *bytes_left_) : count;
  std::copy_n(data, written, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  if (!bytes_left_) return true;
  *bytes_left_ -= written;
  power_cut_ = written < count;
  return !power_cut_;
}

void SimulatedStorage::restore_power() {
  bytes_left_.reset();
  power_cut_ = false;
}

const char* SimulatedSystem::sensor_message(std::size_t index, bool& ok) const {
  if (index >= messages_.size()) return nullptr;
  ok = messages_[index].ok;
  return messages_[index].text.c_str();
}

const char* SimulatedSystem::sensor_change(bool& ok) {
  if (changes_reported_ == changes_.size()) return nullptr;
  const Message& change = changes_[changes_reported_++];
  ok = change.ok;
  return change.text.c_str();
}

void SimulatedSystem::reset(bool to_bootloader) {
  reset_requested_ = true;
  to_bootloader_ = to_bootloader;
}

bool MemorySerial::open(std::uint32_t baud, std::uint8_t /*device*/) {
  baud_ = baud;
  return true;
}

bool MemorySerial::write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) {
  if (size > writable()) {
    ++dropped_;
    return false;
  }
  sent_.insert(sent_.end(), data, data + size);
  return true;
}

std::size_t MemorySerial::read(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, incoming_.size() - taken_);
  std::copy_n(incoming_.begin() + static_cast<std::ptrdiff_t>(taken_), count, data);
  taken_ += count;
  if (taken_ == incoming_.size()) {
    incoming_.clear();
    taken_ = 0;
  }
  return count;
}

std::vector<std::uint8_t> MemorySerial::take_sent() {
  std::vector<std::uint8_t> bytes;
  bytes.swap(sent_);
  return bytes;
}

void MemorySerial::put(const std::uint8_t* data, std::size_t size) {
  incoming_.insert(incoming_.end(), data, data + size);
}

hal::Board SimulatedBoard::roles(hal::Serial& serial) {
  return {clock,   system, serial, storage, backup,        leds,  outputs, receiver,
          battery, imu,    mag,    baro,    diff_pressure, range, gnss};
}

}  // namespace rosflight::boards
