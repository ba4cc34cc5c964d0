// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/live_data.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace rosflight::web::server {
namespace {

using Kind = LiveData::Kind;
using Seen = std::vector<std::pair<std::size_t, std::uint64_t>>;  ///< Channel, time.

class LiveDataTest : public testing::Test {
 protected:
  void put(std::size_t channel, std::uint64_t time_ns, std::size_t size = 1) {
    data_.put(channel, time_ns, std::vector<std::uint8_t>(size, 7));
  }
  Seen news(LiveData::Cursor& cursor) const {
    Seen seen;
    for (const auto& message : data_.news(cursor).messages)
      seen.emplace_back(message->channel, message->time_ns);
    return seen;
  }
  static void want_all(LiveData::Cursor& cursor) {
    for (auto& state : cursor.channel_states) state.wanted = true;
  }

  LiveData data_;
  std::size_t state_ = data_.add_channel({"/state", "a/B", "int8 x", Kind::kState});
  std::size_t event_ = data_.add_channel({"/event", "a/B", "int8 x", Kind::kEvent});
  std::size_t exchange_ = data_.add_channel({"/exchange", "a/B", "int8 x", Kind::kExchange});
};

TEST_F(LiveDataTest, OnlyTheLatestStateIsThere) {
  LiveData::Cursor cursor;
  EXPECT_EQ(data_.news(cursor).channels.size(), 3U);
  want_all(cursor);
  put(state_, 1);
  put(state_, 2);
  EXPECT_EQ(news(cursor), (Seen{{state_, 2}}));
  EXPECT_EQ(news(cursor), Seen{});
}

TEST_F(LiveDataTest, OfAnExchangeTheLastAreThereInOrder) {
  LiveData::Cursor cursor;
  data_.news(cursor);
  want_all(cursor);
  put(exchange_, 1);
  put(exchange_, 2);
  EXPECT_EQ(news(cursor), (Seen{{exchange_, 1}, {exchange_, 2}}));
  put(exchange_, 3);
  EXPECT_EQ(news(cursor), (Seen{{exchange_, 3}}));
  EXPECT_EQ(news(cursor), Seen{});
  Seen last;
  for (std::uint64_t t = 4; t < 4 + 3 * LiveData::kKeptOfExchange; ++t) {
    put(exchange_, t);
    if (t >= 4 + 2 * LiveData::kKeptOfExchange) last.emplace_back(exchange_, t);
  }
  EXPECT_EQ(news(cursor), last) << "of a viewer that is too slow";
}

TEST_F(LiveDataTest, EveryEventIsThereInOrderAlsoForWhoComesLater) {
  for (std::uint64_t t = 1; t <= 3; ++t) put(event_, t);
  for (int viewer = 0; viewer < 2; ++viewer) {
    LiveData::Cursor cursor;
    EXPECT_EQ(news(cursor), Seen{}) << "nothing was wanted yet";
    want_all(cursor);
    EXPECT_EQ(news(cursor), (Seen{{event_, 1}, {event_, 2}, {event_, 3}}));
    EXPECT_EQ(news(cursor), Seen{});
  }
}

TEST_F(LiveDataTest, ChannelsMayComeLater) {
  LiveData::Cursor cursor;
  data_.news(cursor);
  data_.add_channel({"/new", "a/B", "int8 x", Kind::kEvent});
  const auto found = data_.news(cursor);
  ASSERT_EQ(found.channels.size(), 1U);
  EXPECT_EQ(found.channels[0].topic, "/new");
}

TEST_F(LiveDataTest, EventsBeyondTheLimitAreLostAndCounted) {
  put(event_, 1, LiveData::kMaxEventBytes - 1);
  put(event_, 2, 2);
  put(event_, 3, 1);
  EXPECT_EQ(data_.events_lost(), 1U);
  LiveData::Cursor cursor;
  data_.news(cursor);
  want_all(cursor);
  EXPECT_EQ(news(cursor), (Seen{{event_, 1}, {event_, 3}}));
}

TEST_F(LiveDataTest, AnUnknownChannelIsAnError) {
  EXPECT_THROW(put(99, 1), std::out_of_range);
}

// Viewers look at random moments: times of each channel only grow, and no event is missing.
TEST_F(LiveDataTest, ViewersInAnyOrderMissNoEvent) {
  std::mt19937 random(3);
  std::vector<LiveData::Cursor> viewers(4);
  for (auto& viewer : viewers) {
    data_.news(viewer);
    want_all(viewer);
  }
  std::vector<Seen> seen(viewers.size());
  std::uint64_t events = 0;
  for (std::uint64_t t = 1; t <= 5000; ++t) {
    const bool event = random() % 3 == 0;
    put(event ? event_ : state_, t);
    events += event ? 1U : 0U;
    const std::size_t k = random() % viewers.size();
    if (random() % 4 == 0) {
      const Seen found = news(viewers[k]);
      seen[k].insert(seen[k].end(), found.begin(), found.end());
    }
  }
  for (std::size_t k = 0; k < viewers.size(); ++k) {
    const Seen found = news(viewers[k]);
    seen[k].insert(seen[k].end(), found.begin(), found.end());
    std::uint64_t count = 0;
    std::uint64_t last[2] = {0, 0};
    for (const auto& [channel, t] : seen[k]) {
      EXPECT_GT(t, last[channel]);
      last[channel] = t;
      count += channel == event_ ? 1U : 0U;
    }
    EXPECT_EQ(count, events);
  }
}

}  // namespace
}  // namespace rosflight::web::server
