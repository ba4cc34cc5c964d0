// SPDX-License-Identifier: BSD-3-Clause
// What is special to lean frames: their bytes, their checksum, the schema. What holds for every
// codec is in codec_contract.hpp.
#include "link/lean/lean_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>

#include "link/detect/detecting_codec.hpp"
#include "link/lean/wire_table.hpp"
#include "link/test/fields.hpp"
#include "link/test/frames.hpp"

namespace rosflight::link {
namespace {

using test::Bytes;
using test::decoded;
using test::encoded;
using test::from_hex;
using test::random_message;

/// CRC-16/KERMIT bit by bit, from its definition.
std::uint16_t crc_by_bits(const Bytes& bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0x8408u : 0u);
  }
  return static_cast<std::uint16_t>(crc);
}

/// Cheshire & Baker's encoder as their paper lists it (figure 3), bytes complemented before and
/// after, so that FF takes the part of 0; blocks of 254 do not occur.
Bytes stuffed_by_the_paper(const Bytes& bytes) {
  Bytes out;
  Bytes block;
  const auto finish = [&] {
    out.push_back(static_cast<std::uint8_t>(~(block.size() + 1)));
    for (const std::uint8_t byte : block) out.push_back(static_cast<std::uint8_t>(~byte));
    block.clear();
  };
  for (const std::uint8_t byte : bytes) {
    const auto flipped = static_cast<std::uint8_t>(~byte);
    if (flipped == 0) {
      finish();
    } else {
      block.push_back(flipped);
    }
  }
  finish();
  return out;
}

Bytes framed(Bytes content, std::uint16_t seed) {
  const auto crc = static_cast<std::uint16_t>(crc_by_bits(content) ^ seed);
  content.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  content.push_back(static_cast<std::uint8_t>(crc >> 8));
  Bytes frame{0xFF};
  const Bytes stuffed = stuffed_by_the_paper(content);
  frame.insert(frame.end(), stuffed.begin(), stuffed.end());
  return frame;
}

std::uint16_t seed_of(std::uint32_t schema) {
  return static_cast<std::uint16_t>(schema ^ (schema >> 16));
}

TEST(LeanChecksum, HasTheCheckValueOfCrc16Kermit) {
  // Check value of "123456789" in the catalogue of parametrised CRC algorithms (G. Cook).
  const std::string digits = "123456789";
  const Bytes bytes(digits.begin(), digits.end());
  EXPECT_EQ(crc_by_bits(bytes), 0x2189);
  EXPECT_EQ(lean::checksum(bytes.data(), bytes.size()), 0x2189);
}

TEST(LeanChecksum, IsThatOfTheDefinitionForEverySize) {
  std::mt19937_64 random(1);
  for (std::size_t size = 0; size <= 100; ++size) {
    for (int run = 0; run < 20; ++run) {
      Bytes data(size);
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      ASSERT_EQ(lean::checksum(data.data(), size), crc_by_bits(data)) << size;
    }
  }
}

TEST(LeanStuffing, IsThatOfThePaperAndComesBack) {
  std::mt19937_64 random(2);
  for (std::size_t size = 1; size < lean::kMaxStuffedBytes; ++size) {
    for (const unsigned kinds : {2u, 256u}) {  // many FFs and few
      Bytes bytes(size);
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(255 - random() % kinds);
      Bytes buffer(1 + size);
      std::copy(bytes.begin(), bytes.end(), buffer.begin() + 1);
      lean::stuff(buffer.data(), size + 1);
      ASSERT_EQ(buffer, stuffed_by_the_paper(bytes)) << size;
      ASSERT_EQ(std::count(buffer.begin(), buffer.end(), 0xFF), 0);
      ASSERT_TRUE(lean::unstuff(buffer.data(), buffer.size()));
      ASSERT_EQ(Bytes(buffer.begin() + 1, buffer.end()), bytes) << size;
    }
  }
}

TEST(LeanStuffing, OfAKnownSizeIsTheSame) {
  std::mt19937_64 random(5);
  const auto check = [&](auto size) {
    constexpr std::size_t kSize = decltype(size)::value;
    for (int run = 0; run < 500; ++run) {
      Bytes bytes(kSize);
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
      if (run % 3 == 0) bytes[1 + random() % (kSize - 1)] = 0xFF;
      Bytes same = bytes;
      lean::stuff(bytes.data(), kSize);
      lean::stuff<kSize>(same.data());
      ASSERT_EQ(bytes, same) << kSize;
    }
  };
  [&]<std::size_t... kSizes>(std::index_sequence<kSizes...>) {
    (check(std::integral_constant<std::size_t, kSizes + 2>{}), ...);
  }(std::make_index_sequence<80>{});
}

TEST(LeanStuffing, AChainThatDoesNotEndWithTheFrameIsNone) {
  Bytes past{0xF0, 1, 2};
  EXPECT_FALSE(lean::unstuff(past.data(), past.size()));
  Bytes right{0xFC, 1, 2};
  EXPECT_TRUE(lean::unstuff(right.data(), right.size()));
}

TEST(LeanFrames, AreWhatTheDocumentSays) {
  LeanCodec codec;
  const std::uint32_t schema = lean::kSchema;
  const Bytes told{static_cast<std::uint8_t>(schema), static_cast<std::uint8_t>(schema >> 8),
                   static_cast<std::uint8_t>(schema >> 16),
                   static_cast<std::uint8_t>(schema >> 24)};
  EXPECT_EQ(encoded(codec, Heartbeat{VehicleType::kMultirotor}),
            framed({1, 0, 2, told[0], told[1], told[2], told[3]}, 0));
  EXPECT_EQ(encoded(codec, CommandAck{10, true}), framed({11, 1, 10, 1}, seed_of(schema)));
  EXPECT_EQ(
      encoded(codec, TimeSync{-1, 1'000'000'000}),
      framed(from_hex("02 02 FF FF FF FF FF FF FF FF 00 CA 9A 3B 00 00 00 00"), seed_of(schema)));
  EXPECT_EQ(encoded(codec, Status{true, false, true, 0x3DC, 0x20, 2, -3, 150}),
            framed(from_hex("14 03 01 00 01 DC 03 20 02 FD FF 96 00"), seed_of(schema)));
  EXPECT_EQ(
      encoded(codec, Imu{123'456'789, {0.0f, 0.0f, -9.80665f}, {0.01f, -0.02f, 0.03f}, 300.0f}),
      framed(from_hex("0D 04 15 CD 5B 07 00 00 00 00 00 00 00 00 00 00 00 00 0A E8 1C C1 0A D7 23 "
                      "3C 0A D7 A3 BC 8F C2 F5 3C 00 00 96 43"),
             seed_of(schema)));
}

TEST(LeanFrames, HaveSixBytesOnTopOfAnyPayload) {
  std::mt19937_64 random(3);
  LeanCodec codec;
  for (std::size_t id = 1; id < lean::kAlternatives; ++id) {
    for (int run = 0; run < 50; ++run) {
      const Bytes frame = encoded(codec, random_message(id, random));
      ASSERT_EQ(frame.size(), lean::kRows[id].length + 6u) << id;
      ASSERT_EQ(std::count(frame.begin(), frame.end(), 0xFF), 1) << id;
    }
  }
}

TEST(LeanFrames, TheCodecIsSmall) {
  EXPECT_LE(sizeof(LeanCodec), 300u);
}

TEST(LeanReceiver, AnUnknownIdIsDroppedEvenWithAChecksumThatFits) {
  constexpr auto kPastTheEnd = static_cast<std::uint8_t>(lean::kAlternatives);
  for (const std::uint8_t id : Bytes{0, kPastTheEnd, 200}) {
    LeanCodec codec;
    EXPECT_TRUE(decoded(codec, framed({id, 0, 1, 2, 3}, seed_of(lean::kSchema))).empty());
    EXPECT_EQ(codec.counters().frames_dropped, 1u) << int{id};
  }
}

TEST(LeanReceiver, AChainThroughTheIdIsDropped) {
  // The id 11 stands where the chain says FF: with the checksum of what that would mean.
  Bytes content{0xFF, 0, 10, 1};
  const auto crc = static_cast<std::uint16_t>(crc_by_bits(content) ^ seed_of(lean::kSchema));
  const Bytes frame{0xFF,
                    0xFE,
                    11,
                    0,
                    10,
                    1,
                    static_cast<std::uint8_t>(crc & 0xFF),
                    static_cast<std::uint8_t>(crc >> 8)};
  LeanCodec codec;
  EXPECT_TRUE(decoded(codec, frame).empty());
  EXPECT_EQ(codec.counters().frames_dropped, 1u);
}

TEST(LeanReceiver, EveryStartThatLeadsNowhereIsCounted) {
  LeanCodec sender;
  Bytes bytes(100, 0xFF);
  const Bytes frame = encoded(sender, CommandAck{1, true});
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  LeanCodec receiver;
  EXPECT_EQ(decoded(receiver, bytes).size(), 1u);
  EXPECT_EQ(receiver.counters().frames_dropped, 100u);
}

TEST(LeanReceiver, ABooleanIsTrueForAnyNonZeroByte) {
  LeanCodec codec;
  decoded(codec, framed({11, 0, 1, 0x80}, seed_of(lean::kSchema)));
  EXPECT_TRUE(std::get<CommandAck>(codec.message()).success);
  decoded(codec, framed({11, 1, 1, 0}, seed_of(lean::kSchema)));
  EXPECT_FALSE(std::get<CommandAck>(codec.message()).success);
}

// ---- schema

std::string schema_text() {
  std::string text;
  const auto put = [&text](char c) { text += c; };
  [&]<std::size_t... kIds>(std::index_sequence<kIds...>) {
    (lean::spell_message<kIds + 1>(put), ...);
  }(std::make_index_sequence<lean::kAlternatives - 1>{});
  return text;
}

TEST(LeanSchema, IsTheFnv1aHashOfItsText) {
  std::string text = schema_text();
  text.erase(0, text.find('\n') + 1);  // the heartbeat is in no schema
  std::uint32_t hash = 2166136261u;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619u;
  EXPECT_EQ(lean::kSchema, hash);
  EXPECT_NE(text.find("\n13 Imu time_boot_us:u64 accel_m_s2:f32[3] gyro_rad_s:f32[3] "
                      "temperature_K:f32\n"),
            std::string::npos)
      << text;
}

/// The struct's size is at least the payload's and at most that and the gaps a compiler may leave:
/// a field that is missing in the list is seen.
template <std::size_t kId>
void expect_whole_struct() {
  using M = typename lean::OnWire<kId>::Type;
  std::size_t end = 0;
  std::size_t alignment = 1;
  lean::each_field<M>([&](auto one) {
    using T = std::remove_reference_t<decltype(std::declval<M&>().*one.member)>;
    end = (end + alignof(T) - 1) / alignof(T) * alignof(T) + sizeof(T);
    alignment = std::max(alignment, alignof(T));
  });
  EXPECT_EQ((end + alignment - 1) / alignment * alignment, sizeof(M)) << lean::Layout<M>::kName;
}

TEST(LeanSchema, ListsEveryFieldOfEveryStructInItsOrder) {
  [&]<std::size_t... kIds>(std::index_sequence<kIds...>) {
    (expect_whole_struct<kIds + 1>(), ...);
  }(std::make_index_sequence<lean::kAlternatives - 1>{});
}

TEST(LeanSchema, IsTheTableOfTheDocument) {
  std::ifstream file("docs/link.md");
  const std::string document{std::istreambuf_iterator<char>(file), {}};
  ASSERT_FALSE(document.empty());
  std::istringstream lines(schema_text());
  std::string line;
  for (std::size_t id = 1; std::getline(lines, line); ++id) {
    const std::size_t name = line.find(' ') + 1;
    const std::size_t fields = line.find(' ', name) + 1;
    const std::string row =
        "| " + std::to_string(id) + " | `" + line.substr(name, fields - 1 - name) + "` | " +
        std::to_string(lean::kRows[id].length) + " | `" + line.substr(fields) + "` |";
    EXPECT_NE(document.find(row), std::string::npos) << "docs/link.md lacks\n" << row;
  }
  std::array<char, 16> hash{};
  std::snprintf(hash.data(), hash.size(), "`%08X`", lean::kSchema);
  EXPECT_NE(document.find(hash.data()), std::string::npos) << "docs/link.md lacks " << hash.data();
}

constexpr std::uint32_t kOtherSchema = 0x12345678;

template <class Receiver>
void expect_refusal(Receiver& receiver) {
  LeanCodec other(kOtherSchema);
  LeanCodec same;
  std::mt19937_64 random(4);
  for (int run = 0; run < 2000; ++run) {
    EXPECT_TRUE(
        decoded(receiver, encoded(other, random_message(2 + random() % 24, random))).empty());
  }
  EXPECT_EQ(receiver.mismatch(), nullptr);
  EXPECT_TRUE(decoded(receiver, encoded(other, Heartbeat{VehicleType::kMultirotor})).empty());
  ASSERT_NE(receiver.mismatch(), nullptr);
  EXPECT_EQ(receiver.mismatch()->ours, lean::kSchema);
  EXPECT_EQ(receiver.mismatch()->theirs, kOtherSchema);
  // The other end was exchanged for one of our schema.
  EXPECT_EQ(decoded(receiver, encoded(same, Heartbeat{})).size(), 1u);
  EXPECT_EQ(receiver.mismatch(), nullptr);
  EXPECT_EQ(decoded(receiver, encoded(same, CommandAck{1, true})).size(), 1u);
}

TEST(LeanSchema, AnotherOneIsRefusedAndToldUntilTheRightOneComes) {
  LeanCodec receiver;
  expect_refusal(receiver);
  DetectingCodec detecting;
  expect_refusal(detecting);
}

TEST(LeanSchema, OfTheSameSeedIsRefusedByTheHeartbeat) {
  const std::uint32_t twin = lean::kSchema ^ 0x00010001u;  // both halves: the seed stays
  ASSERT_EQ(seed_of(twin), seed_of(lean::kSchema));
  LeanCodec other(twin);
  LeanCodec receiver;
  EXPECT_TRUE(decoded(receiver, encoded(other, Heartbeat{})).empty());
  EXPECT_TRUE(decoded(receiver, encoded(other, CommandAck{1, true})).empty());
  EXPECT_NE(receiver.mismatch(), nullptr);
  EXPECT_EQ(receiver.counters().frames_received, 0u);
}

}  // namespace
}  // namespace rosflight::link
