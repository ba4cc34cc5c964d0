// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/linux_serial.hpp"

#include <algorithm>

#include "firmware/boards/linux/linux_error.hpp"

namespace rosflight::boards {

static_assert(TransmitQueue::kMaxFrame <= 1400, "a frame fits a datagram");

std::unique_ptr<Wire> open_wire(const LinkAddress& address) {
  switch (address.kind) {
    case LinkAddress::Kind::kPty:
      return open_pty(address);
    case LinkAddress::Kind::kUdp:
      return open_udp(address);
    case LinkAddress::Kind::kTcpServer:
      return open_tcp(address);
    default:
      throw LinuxError("link \"" + address.text() + "\": no kind of link of a board");
  }
}

LinuxSerial::LinuxSerial(const LinkAddress& address)
    : wire_{open_wire(address)},
      received_(kReceiveChunk + kMaxDatagram),
      staged_(kMaxSend),
      peer_{wire_->peer()} {}

bool LinuxSerial::open(std::uint32_t baud, std::uint8_t device) {
  return baud > 0 && device == 0;
}

bool LinuxSerial::write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) {
  const bool queued = queue_.push(data, size, qos);
  if (!queued) ++counters_.frames_dropped;
  return queued;
}

std::size_t LinuxSerial::read(std::uint8_t* data, std::size_t capacity) {
  const std::size_t count = std::min(capacity, readable_ - read_);
  std::copy_n(received_.data() + read_, count, data);
  read_ += count;
  return count;
}

void LinuxSerial::receive() {
  std::copy(received_.begin() + static_cast<std::ptrdiff_t>(read_),
            received_.begin() + static_cast<std::ptrdiff_t>(received_size_), received_.begin());
  received_size_ -= read_;
  read_ = 0;
  connected_ = wire_->refresh();
  forget_old_peer();
  while (received_size_ < kReceiveChunk) {
    const std::size_t n =
        wire_->receive(received_.data() + received_size_, received_.size() - received_size_);
    if (n == 0) break;
    counters_.bytes_received += n;
    if (!cut_) received_size_ += n;
  }
  readable_ = std::min(received_size_, kReceiveChunk);
}

void LinuxSerial::forget_old_peer() {
  if (connected_ && peer_ == wire_->peer()) return;
  peer_ = wire_->peer();
  queue_.clear();
  staged_size_ = begun_ = 0;
}

void LinuxSerial::transmit() {
  forget_old_peer();
  // A frame that was begun is finished all the same, or the next one could not be read.
  if (cut_) queue_.clear();
  while (begun_ < staged_size_ || !queue_.empty()) {
    if (begun_ == staged_size_) {
      begun_ = 0;
      staged_size_ = queue_.take(staged_.data(), staged_.size());
    }
    const std::size_t n = wire_->send(staged_.data() + begun_, staged_size_ - begun_);
    if (n == 0) return;
    begun_ += n;
    counters_.bytes_sent += n;
  }
}

void LinuxSerial::clear() {
  queue_.clear();
  read_ = readable_ = received_size_ = 0;
}

}  // namespace rosflight::boards
