// SPDX-License-Identifier: BSD-3-Clause
#include "companion/record_reader.hpp"

#include <gtest/gtest.h>

#include "companion/test/rig.hpp"

namespace rosflight::companion::test {
namespace {

using State = RecordReader::State;

/// A rig whose FCU keeps a record as a board does: one entry a pass.
struct RecordRig : Rig {
  explicit RecordRig(double byte_loss = 0.0) : Rig{numbered_table(0), {}, byte_loss} {
    fcu.imu = false;
    fcu.intercept = [this](const link::Message& message) {
      if (const auto* wanted = std::get_if<link::RecordRequest>(&message)) {
        request = *wanted;
        asked = true;
        ++requests;
      }
      return false;
    };
  }

  static RecordReader::Bytes bytes_of(std::uint32_t number) {
    RecordReader::Bytes bytes{};
    for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(number + k);
    return bytes;
  }

  void answer() {
    if (!asked || !answers) return;
    request.first = std::max(request.first, oldest);
    asked = request.count > 0 && request.first <= newest;
    if (asked) {
      send(request.first, 0);
      send(request.first++, 1);
      asked = --request.count > 0;
    } else if (request.count == 0) {
      send(0, 0);
    }
  }
  void send(std::uint32_t number, std::uint8_t part) {
    link::RecordPart half{number, oldest, newest, part, {}};
    const RecordReader::Bytes bytes = bytes_of(number);
    std::copy_n(bytes.begin() + part * 64, 64, half.bytes.begin());
    fcu.send(half);
  }

  /// Until the reader has ended. @returns its state.
  State read(RecordReader& reader, Time limit = 60s) {
    for (const Time end = now + limit; now < end && reader.state() == State::kReading;) {
      step();
      answer();
      reader.step();
    }
    return reader.state();
  }

  link::RecordRequest request;
  std::uint32_t oldest{701}, newest{1700};
  int requests{0};
  bool asked{false}, answers{true};
};

void expect_all(const RecordReader& reader, std::uint32_t oldest, std::uint32_t newest) {
  ASSERT_EQ(reader.entries().size(), newest - oldest + 1);
  for (const auto& [number, bytes] : reader.entries()) {
    EXPECT_EQ(bytes, RecordRig::bytes_of(number)) << number;
  }
  EXPECT_EQ(reader.entries().begin()->first, oldest);
}

TEST(RecordReader, ReceivesEveryEntryInAFewRequests) {
  RecordRig rig;
  RecordReader reader(rig.session);
  EXPECT_EQ(rig.read(reader), State::kComplete);
  expect_all(reader, 701, 1700);
  EXPECT_EQ(reader.expected(), 1000U);
  EXPECT_LE(rig.requests, 10);
}

TEST(RecordReader, RequestsAgainWhatALossyLinkLost) {
  RecordRig rig{0.0005};  // 8 % of the entries
  RecordReader reader(rig.session);
  EXPECT_EQ(rig.read(reader), State::kComplete);
  expect_all(reader, 701, 1700);
}

TEST(RecordReader, EntriesThatAreOverwrittenMeanwhileArePassedOver) {
  RecordRig rig;
  RecordReader reader(rig.session);
  EXPECT_EQ(rig.read(reader, 200ms), State::kReading);
  rig.oldest = 1500;
  rig.newest = 2500;
  EXPECT_EQ(rig.read(reader), State::kComplete);
  EXPECT_EQ(reader.entries().rbegin()->first, 1700U) << "what was there when the reading began";
  EXPECT_LT(reader.entries().size(), 1000U);
}

TEST(RecordReader, AnEmptyRecordIsComplete) {
  RecordRig rig;
  rig.oldest = 1;
  rig.newest = 0;
  RecordReader reader(rig.session);
  EXPECT_EQ(rig.read(reader), State::kComplete);
  EXPECT_TRUE(reader.entries().empty());
}

TEST(RecordReader, AnFcuWithoutARecordIsNotWaitedForForever) {
  RecordRig rig;
  rig.answers = false;
  RecordReader reader(rig.session);
  EXPECT_EQ(rig.read(reader, 5s), State::kNoRecord);
}

TEST(RecordReader, WhatArrivedIsKeptWhenTheFcuStopsAnswering) {
  RecordRig rig;
  RecordReader reader(rig.session);
  EXPECT_EQ(rig.read(reader, 200ms), State::kReading);
  rig.answers = false;
  EXPECT_EQ(rig.read(reader, 10s), State::kStopped);
  EXPECT_GT(reader.entries().size(), 50U);
}

}  // namespace
}  // namespace rosflight::companion::test
