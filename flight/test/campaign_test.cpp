// SPDX-License-Identifier: BSD-3-Clause
#include "flight/campaign.hpp"

#include <gtest/gtest.h>

#include <atomic>

namespace rosflight::flight {
namespace {

CampaignOptions hops(std::uint64_t first, std::uint64_t last, unsigned threads) {
  CampaignOptions options;
  options.choice.mission = "hop";
  options.choice.wind = "3,270,4";
  options.first_seed = first;
  options.last_seed = last;
  options.threads = threads;
  return options;
}

TEST(Campaign, RowsDoNotDependOnTheNumberOfThreads) {
  const auto one = fly_campaign(hops(3, 8, 1));
  ASSERT_EQ(one.size(), 6U);
  EXPECT_EQ(one[0].choice.seed, 3U);
  EXPECT_EQ(one[5].choice.seed, 8U);
  EXPECT_EQ(campaign_csv(fly_campaign(hops(3, 8, 3))), campaign_csv(one));
  EXPECT_NE(one[0].tracking.rms(), one[1].tracking.rms()) << "each seed is another flight";
}

TEST(Campaign, AFlightIsThatOfTheSameSeedAlone) {
  FlightChoice choice = hops(1, 1, 1).choice;
  choice.seed = 5;
  const FlightSetup setup(choice);
  Flight flight(setup);
  flight.run();
  const auto rows = fly_campaign(hops(4, 6, 2));
  EXPECT_EQ(campaign_csv({rows[1]}), campaign_csv({summarise(flight)}));
}

TEST(Campaign, FlightsThatHaveEndedAreKeptWhenItIsStopped) {
  CampaignOptions options = hops(1, 1000, 2);
  std::atomic<std::size_t> done{0};
  options.on_flight = [&done](std::size_t flights) { done = flights; };
  options.interrupted = [&done] { return done >= 3; };
  const auto rows = fly_campaign(options);
  EXPECT_GE(rows.size(), 3U);
  EXPECT_LE(rows.size(), 5U);
  for (std::size_t k = 1; k < rows.size(); ++k)
    EXPECT_LT(rows[k - 1].choice.seed, rows[k].choice.seed);
}

TEST(Campaign, BadInputIsRefusedBeforeItFlies) {
  CampaignOptions options = hops(1, 5, 2);
  options.choice.vehicle = "none";
  EXPECT_THROW(fly_campaign(options), config::Error);
  options = hops(1, 5, 2);
  options.choice.board = "qemu_m7";
  EXPECT_THROW(fly_campaign(options), config::Error);
}

TEST(Campaign, SeedsAreARangeOrOne) {
  CampaignOptions options;
  read_seeds("7:12", options);
  EXPECT_EQ(options.first_seed, 7U);
  EXPECT_EQ(options.last_seed, 12U);
  read_seeds("3", options);
  EXPECT_EQ(options.first_seed, 3U);
  EXPECT_EQ(options.last_seed, 3U);
  for (const char* bad : {"", ":", "1:", ":5", "5:1", "a", "1:2:3", "-1:2", "1.5", "1 :2",
                          "0:1000000", "99999999999999999999"}) {
    EXPECT_THROW(read_seeds(bad, options), config::Error) << bad;
  }
}

}  // namespace
}  // namespace rosflight::flight
