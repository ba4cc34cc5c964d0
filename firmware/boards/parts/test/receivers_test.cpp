// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "firmware/boards/parts/crsf.hpp"
#include "firmware/boards/parts/models/receiver_streams.hpp"
#include "firmware/boards/parts/sbus.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::microseconds;
using hal::milliseconds;
using models::Bytes;

std::array<std::uint16_t, 16> ascending() {
  std::array<std::uint16_t, 16> raw{};
  for (std::size_t k = 0; k < raw.size(); ++k) raw[k] = static_cast<std::uint16_t>(172 + 100 * k);
  return raw;
}

// ---- S.Bus

class SbusTest : public testing::Test {
 protected:
  /// Sends bytes without a gap, in calls of `chunk` bytes, `silence` after the last ones.
  void send(const Bytes& bytes, Time silence = milliseconds(6), std::size_t chunk = 25) {
    now_ += silence;
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      const std::size_t n = std::min(chunk, bytes.size() - at);
      now_ += static_cast<std::int64_t>(n) * SbusInput::kByte;
      input_.receive(bytes.data() + at, n, now_);
    }
  }
  int frames() {
    int count = 0;
    while (input_.poll(frame_)) ++count;
    return count;
  }

  SbusInput input_;
  hal::RcFrame frame_;
  Time now_{milliseconds(1000)};
};

TEST_F(SbusTest, DecodesAFrameOfTheWire) {
  // Sixteen channels of 0x3E0 = 992: the bit pattern 00000111110 repeated, low bit first.
  const Bytes wire{0x0F, 0xE0, 0x03, 0x1F, 0xF8, 0xC0, 0x07, 0x3E, 0xF0, 0x81, 0x0F, 0x7C, 0xE0,
                   0x03, 0x1F, 0xF8, 0xC0, 0x07, 0x3E, 0xF0, 0x81, 0x0F, 0x7C, 0x00, 0x00};
  send(wire);
  ASSERT_EQ(frames(), 1);
  for (std::size_t k = 0; k < 16; ++k) EXPECT_FLOAT_EQ(frame_.channels[k], 820.0f / 1639.0f);
  EXPECT_EQ(frame_.channel_count, 24);
  EXPECT_FALSE(frame_.frame_lost);
  EXPECT_FALSE(frame_.failsafe);
}

TEST_F(SbusTest, EveryChannelHasItsOwnPlace) {
  send(models::sbus_frame(ascending()));
  ASSERT_EQ(frames(), 1);
  for (std::size_t k = 0; k < 16; ++k) {
    EXPECT_FLOAT_EQ(frame_.channels[k], 100.0f * static_cast<float>(k) / 1639.0f) << k;
  }
}

TEST_F(SbusTest, FlagsAreFrameLostFailsafeAndEightTwoStateChannels) {
  send(models::sbus_frame(ascending(), 0x04));
  ASSERT_EQ(frames(), 1);
  EXPECT_TRUE(frame_.frame_lost);
  EXPECT_FALSE(frame_.failsafe);
  send(models::sbus_frame(ascending(), 0x09));
  ASSERT_EQ(frames(), 1);
  EXPECT_FALSE(frame_.frame_lost);
  EXPECT_TRUE(frame_.failsafe);
  EXPECT_EQ(frame_.channels[16], 0.0f);  // set
  EXPECT_EQ(frame_.channels[17], 1.0f);  // clear
  EXPECT_EQ(frame_.channels[19], 0.0f);
}

TEST_F(SbusTest, StampIsTheBeginningOfTheFrame) {
  send(models::sbus_frame(ascending()));
  ASSERT_EQ(frames(), 1);
  EXPECT_EQ(frame_.stamp, now_ - milliseconds(3));
}

TEST_F(SbusTest, TakesAllFootersAndNoOther) {
  for (int footer = 0; footer < 256; ++footer) {
    send(models::sbus_frame(ascending(), 0, static_cast<std::uint8_t>(footer)));
    const bool right =
        footer == 0 || footer == 0x04 || footer == 0x14 || footer == 0x24 || footer == 0x34;
    EXPECT_EQ(frames(), right ? 1 : 0) << footer;
  }
  EXPECT_EQ(input_.good(), 5u);
  EXPECT_EQ(input_.bad(), 251u);
}

TEST_F(SbusTest, ShorterAndLongerFramesAreNotParsedByPosition) {
  Bytes frame = models::sbus_frame(ascending());
  for (std::size_t size = 1; size < 25; ++size) {
    send({frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_EQ(frames(), 0) << size;
  }
  send(frame);
  EXPECT_EQ(frames(), 1);
  EXPECT_EQ(input_.bad(), 24u);
  // A byte too many within the frame moves its end.
  Bytes longer = models::sbus_frame({2047, 2047, 2047, 2047, 2047, 2047, 2047, 2047, 2047, 2047,
                                     2047, 2047, 2047, 2047, 2047, 2047},
                                    0xFF);
  longer.insert(longer.begin() + 5, 0xFF);
  send(longer);
  EXPECT_EQ(frames(), 0);
  EXPECT_EQ(input_.bad(), 25u);
  EXPECT_EQ(input_.strays(), 1u);
}

TEST_F(SbusTest, SynchronizesWithTheFirstFrameAfterGarbage) {
  std::mt19937 random(7);
  for (int k = 0; k < 200; ++k) {
    Bytes garbage(1 + random() % 60);
    for (auto& byte : garbage) byte = static_cast<std::uint8_t>(random());
    garbage[0] = 0x55;  // one that begins a frame may by chance be one
    send(garbage);
    EXPECT_EQ(frames(), 0);
    send(models::sbus_frame(ascending()));
    EXPECT_EQ(frames(), 1) << k;
  }
}

TEST_F(SbusTest, ADamagedByteCostsItsFrameAndNoOther) {
  const Bytes frame = models::sbus_frame(ascending());
  send({frame.begin(), frame.begin() + 10});
  input_.line_error(now_);
  send({frame.begin() + 11, frame.end()}, microseconds(120));
  EXPECT_EQ(frames(), 0);
  EXPECT_EQ(input_.bad(), 1u);
  send(frame);
  EXPECT_EQ(frames(), 1);
  // Between frames it costs nothing but a frame that follows without silence.
  now_ += milliseconds(6);
  input_.line_error(now_);
  send(frame, microseconds(0));
  EXPECT_EQ(frames(), 0);
  send(frame);
  EXPECT_EQ(frames(), 1);
  EXPECT_EQ(input_.bad(), 1u);
}

TEST_F(SbusTest, TheDivisionIntoCallsDoesNotMatter) {
  for (std::size_t chunk = 1; chunk <= 25; ++chunk) {
    send(models::sbus_frame(ascending()), milliseconds(6), chunk);
    EXPECT_EQ(frames(), 1) << chunk;
  }
}

TEST_F(SbusTest, HasNoLinkQuality) {
  EXPECT_EQ(input_.link_quality_percent(now_), ReceiverInput::kQualityUnknown);
  EXPECT_EQ(input_.rssi(now_), 255);
}

// ---- CRSF

class CrsfTest : public testing::Test {
 protected:
  void send(const Bytes& bytes, Time silence = milliseconds(4), std::size_t chunk = 64) {
    now_ += silence;
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      const std::size_t n = std::min(chunk, bytes.size() - at);
      now_ += Time{static_cast<std::int64_t>(n) * 10'000'000 / 420'000};
      input_.receive(bytes.data() + at, n, now_);
    }
  }
  int frames() {
    int count = 0;
    while (input_.poll(frame_)) ++count;
    return count;
  }
  static Bytes channels(std::uint16_t raw = 992) {
    std::array<std::uint16_t, 16> all{};
    all.fill(raw);
    return models::crsf_frame(0x16, models::pack_channels(all));
  }

  CrsfInput input_;
  hal::RcFrame frame_;
  Time now_{milliseconds(1000)};
};

TEST_F(CrsfTest, TheChecksumIsTheOneOfDvbS2) {
  const char* digits = "123456789";
  EXPECT_EQ(CrsfFormat::crc8(reinterpret_cast<const std::uint8_t*>(digits), 9), 0xBC);
  EXPECT_EQ(models::crc8_by_division({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0xBC);
}

TEST_F(CrsfTest, DecodesAFrameOfTheWire) {
  // Centred sticks: 24 bytes follow, type 0x16, sixteen times 992, CRC 0xAD.
  const Bytes wire{0xC8, 0x18, 0x16, 0xE0, 0x03, 0x1F, 0xF8, 0xC0, 0x07, 0x3E, 0xF0, 0x81, 0x0F,
                   0x7C, 0xE0, 0x03, 0x1F, 0xF8, 0xC0, 0x07, 0x3E, 0xF0, 0x81, 0x0F, 0x7C, 0xAD};
  send(wire);
  ASSERT_EQ(frames(), 1);
  for (std::size_t k = 0; k < 16; ++k) EXPECT_FLOAT_EQ(frame_.channels[k], 0.5f);
  EXPECT_EQ(frame_.channel_count, 16);
}

TEST_F(CrsfTest, ChannelsAreFractionsOfOneToTwoMilliseconds) {
  send(channels(172));  // 987.5 us
  ASSERT_EQ(frames(), 1);
  EXPECT_NEAR(frame_.channels[3], -0.0125f, 1e-6f);
  send(channels(1811));  // 2011.875 us
  ASSERT_EQ(frames(), 1);
  EXPECT_NEAR(frame_.channels[3], 1.011875f, 1e-6f);
}

TEST_F(CrsfTest, LinkQualityComesFromTheStatisticsWhileTheyAreCurrent) {
  EXPECT_EQ(input_.link_quality_percent(now_), ReceiverInput::kQualityUnknown);
  send(models::crsf_statistics(87));
  EXPECT_EQ(input_.link_quality_percent(now_), 87);
  EXPECT_EQ(input_.rssi(now_), 220);  // 87 % of 254
  EXPECT_EQ(frames(), 0);
  EXPECT_EQ(input_.link_quality_percent(now_ + milliseconds(1001)), ReceiverInput::kQualityUnknown);
  send(models::crsf_statistics(255));
  EXPECT_EQ(input_.link_quality_percent(now_), 100);
  EXPECT_EQ(input_.rssi(now_), 254);
}

TEST_F(CrsfTest, AQualityOfZeroIsFailsafe) {
  send(models::crsf_statistics(0));
  send(channels());
  ASSERT_EQ(frames(), 1);
  EXPECT_TRUE(frame_.failsafe);
  send(models::crsf_statistics(1));
  send(channels());
  ASSERT_EQ(frames(), 1);
  EXPECT_FALSE(frame_.failsafe);
}

TEST_F(CrsfTest, AnyChangedByteIsNoticed) {
  const Bytes frame = channels();
  for (std::size_t k = 0; k < frame.size(); ++k) {
    Bytes wrong = frame;
    wrong[k] = static_cast<std::uint8_t>(wrong[k] ^ 0x10);
    send(wrong);
    EXPECT_EQ(frames(), 0) << k;
    send(frame);
    EXPECT_EQ(frames(), 1) << k;
  }
  EXPECT_GE(input_.bad(), frame.size() - 2);
}

TEST_F(CrsfTest, FindsFramesDirectlyBehindGarbage) {
  std::mt19937 random(3);
  int lost = 0;
  for (int k = 0; k < 300; ++k) {
    Bytes stream(random() % 80);
    for (auto& byte : stream) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? 0xC8 : random());
    const Bytes frame = channels();
    for (int n = 0; n < 3; ++n) stream.insert(stream.end(), frame.begin(), frame.end());
    send(stream, milliseconds(4), 1 + random() % 64);
    const int found = frames();
    EXPECT_LE(found, 3);
    lost += 3 - found;
  }
  EXPECT_LT(lost, 20);  // a false beginning hides at most the frames that are not behind it yet
}

TEST_F(CrsfTest, OtherFramesAreIgnored) {
  send(models::crsf_frame(0x08, {1, 2, 3, 4, 5, 6, 7, 8}));
  send(models::crsf_frame(0x16, {1, 2, 3}));
  send(models::crsf_frame(0x14, {1, 2, 3}));
  EXPECT_EQ(frames(), 0);
  EXPECT_EQ(input_.good(), 3u);
  EXPECT_EQ(input_.link_quality_percent(now_), ReceiverInput::kQualityUnknown);
}

TEST_F(CrsfTest, LengthsOutOfRangeBeginNoFrame) {
  for (const int length : {0, 1, 63, 255}) {
    send({0xC8, static_cast<std::uint8_t>(length)});
    send(channels());
    EXPECT_EQ(frames(), 1) << length;
  }
  input_.receive(nullptr, 0, now_);
}

TEST_F(CrsfTest, SilenceAndDamageEndAFrame) {
  const Bytes frame = channels();
  send({frame.begin(), frame.begin() + 20});
  send(frame);
  EXPECT_EQ(frames(), 1);
  send({frame.begin(), frame.begin() + 20});
  input_.line_error(now_);
  send(frame, microseconds(0));
  EXPECT_EQ(frames(), 1);
  EXPECT_EQ(input_.bad(), 2u);
}

TEST_F(CrsfTest, StampIsTheBeginningOfTheFrame) {
  send(channels());
  ASSERT_EQ(frames(), 1);
  EXPECT_NEAR(static_cast<double>((now_ - frame_.stamp).count()), 26 * 10.0 / 0.42, 2.0);
}

}  // namespace
}  // namespace rosflight::boards::parts
