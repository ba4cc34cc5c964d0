// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::boards::parts {

/// What a stream begins with.
struct Finding {
  enum Kind : std::uint8_t {
    kMore,    ///< The beginning of a frame, perhaps.
    kFrame,   ///< A whole frame with a right checksum.
    kStray,   ///< The first byte begins no frame.
    kDamaged  ///< A whole frame with a wrong checksum.
  };
  Kind kind{kMore};
  std::size_t size{0};  ///< Bytes of a whole frame.
};

/// Finds frames in a stream of bytes. After a damaged frame the search goes on with its second byte, so
/// a frame that began within it is found. Format has
///
///     static constexpr std::size_t kMaxLength;
///     static Finding inspect(const std::uint8_t* data, std::size_t size);  // size >= 1; looks no
///                                                                          // further than one frame
template <class Format>
class Framer {
 public:
  /// Takes one byte; calls on_frame(data, size) for each frame that is now complete.
  template <class OnFrame>
  void take(std::uint8_t byte, OnFrame&& on_frame) {
    buffer_[size_++] = byte;
    while (size_ > 0) {
      const Finding finding = Format::inspect(buffer_.data(), size_);
      switch (finding.kind) {
        case Finding::kMore:
          return;
        case Finding::kFrame:
          ++frames_;
          on_frame(buffer_.data(), finding.size);
          drop(finding.size);
          break;
        case Finding::kStray:
          ++strays_;
          drop(1);
          break;
        case Finding::kDamaged:
          ++damaged_;
          drop(1);
          break;
      }
    }
  }
  /// The stream was interrupted: what has been received of a frame is dropped and counted as damaged.
  void interrupt() {
    if (size_ > 0) ++damaged_;
    size_ = 0;
  }

  std::uint32_t frames() const { return frames_; }
  std::uint32_t damaged() const { return damaged_; }
  /// Bytes outside frames.
  std::uint32_t strays() const { return strays_; }

 private:
  void drop(std::size_t count) {
    std::copy(buffer_.data() + count, buffer_.data() + size_, buffer_.data());
    size_ -= count;
  }

  std::array<std::uint8_t, Format::kMaxLength> buffer_{};
  std::size_t size_{0};
  std::uint32_t frames_{0};
  std::uint32_t damaged_{0};
  std::uint32_t strays_{0};
};

}  // namespace rosflight::boards::parts
