// SPDX-License-Identifier: BSD-3-Clause
#include "log/log_extract.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "log/topic_kinds.hpp"

namespace rosflight::log {
namespace {

constexpr std::uint64_t kMs_ns = 1'000'000;

class LogExtractTest : public testing::Test {
 protected:
  ~LogExtractTest() override { std::filesystem::remove(file_); }

  std::filesystem::path file_ = std::filesystem::temp_directory_path() /
                                ("log_extract_test_" + std::to_string(::getpid()) + ".mcap");
  std::vector<std::uint8_t> cdr_{0, 1, 0, 0, 1, 2, 3, 4};
};

TEST_F(LogExtractTest, KeepsEveryEventAndStatesAtFiftyHertz) {
  LogExtract extract(file_, {{"vehicle", "test"}});
  const std::uint64_t start_ns = 1'767'225'600'000 * kMs_ns;
  for (std::uint64_t k = 0; k < 1000; ++k) {  // a second
    const std::uint64_t now_ns = start_ns + k * kMs_ns;
    extract.on_logged(Topic::kImu, now_ns, cdr_);
    extract.on_logged(Topic::kTexts, now_ns, cdr_);
    extract.on_logged(Topic::kRawFrames, now_ns, cdr_);
  }
  EXPECT_EQ(extract.close().messages, 50U + 1000U);
}

TEST_F(LogExtractTest, KeepsARequestAndItsAnswer) {
  LogExtract extract(file_, {});
  for (std::uint64_t k = 0; k < 10; ++k) {
    extract.on_logged(Topic::kTimeSync, k * 100 * kMs_ns, cdr_);
    extract.on_logged(Topic::kTimeSync, k * 100 * kMs_ns + 2 * kMs_ns, cdr_);
  }
  EXPECT_EQ(extract.close().messages, 20U);
}

TEST_F(LogExtractTest, AStateThatComesRarelyIsComplete) {
  LogExtract extract(file_, {});
  for (std::uint64_t k = 0; k < 30; ++k) extract.on_logged(Topic::kGnss, k * 200 * kMs_ns, cdr_);
  EXPECT_EQ(extract.close().messages, 30U);
}

TEST_F(LogExtractTest, WithoutIndexesItHasTheSameMessagesAndAnEnd) {
  LogExtract extract(file_, {});
  for (std::uint64_t k = 0; k < 100; ++k) extract.on_logged(Topic::kTexts, k * kMs_ns, cdr_);
  extract.close();
  std::ifstream in(file_, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const std::string small = LogExtract::without_indexes(as_bytes(whole));
  EXPECT_LT(small.size() + 100U * 16U, whole.size());  // a time and an offset of 8 bytes each
  EXPECT_TRUE(small.starts_with(whole.substr(0, 8)));
  EXPECT_TRUE(small.ends_with(whole.substr(0, 8)));
}

TEST_F(LogExtractTest, EveryTopicHasOneKind) {
  std::map<TopicKind, int> count;
  for (std::size_t k = 0; k < kTopics.size(); ++k) ++count[kind_of(static_cast<Topic>(k))];
  EXPECT_EQ(count[TopicKind::kBulk], 2);
  EXPECT_EQ(count[TopicKind::kExchange], 1);
  EXPECT_GT(count[TopicKind::kEvent], 10);
  EXPECT_GT(count[TopicKind::kState], 20);
}

}  // namespace
}  // namespace rosflight::log
