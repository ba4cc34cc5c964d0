// SPDX-License-Identifier: BSD-3-Clause
// The format itself is checked by test_log_reads_back.py with the mcap package; here: what needs no
// reader.
#include "log/mcap_writer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>

namespace rosflight::log {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Little-endian value at `offset`.
template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

struct Record {
  std::uint8_t opcode;
  std::size_t offset;  ///< Offset of the contents.
  std::size_t length;
};

std::vector<Record> records(const std::string& bytes) {
  std::vector<Record> out;
  for (std::size_t at = 8; at + 9 <= bytes.size() - 8;) {
    const auto length = static_cast<std::size_t>(value_at<std::uint64_t>(bytes, at + 1));
    out.push_back({static_cast<std::uint8_t>(bytes[at]), at + 9, length});
    at += 9 + length;
  }
  return out;
}

class McapWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::path(testing::TempDir()) /
            (std::string("mcap_writer_") +
             testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  void TearDown() override { fs::remove(path_); }

  LogSummary write_example(Compression compression, std::size_t chunk_bytes) const {
    McapWriter writer(path_, {"ros2", "test", chunk_bytes, compression});
    const auto schema = writer.add_schema("std_msgs/msg/String", "ros2msg", "string data\n");
    const auto a = writer.add_channel("/a", schema, "cdr", {{"k", "v"}});
    const auto b = writer.add_channel("/b", schema, "cdr");
    const std::string data(100, 'x');
    for (std::uint64_t k = 0; k < 50; ++k) {
      // Every fifth is late.
      writer.write(k % 2 == 0 ? a : b, 1000 + k - (k % 5 == 0 ? 3 : 0), 2000 + k, as_bytes(data));
    }
    writer.attach("file", "text/plain", 7, as_bytes("contents"));
    writer.add_metadata("table", {{"key", "value"}});
    return writer.close();
  }

  fs::path path_;
};

TEST_F(McapWriterTest, EveryByteOfATinyFile) {
  McapWriter writer(path_, {"", "", 1024, Compression::kNone});
  const LogSummary summary = writer.close();
  const std::string bytes = contents(path_);
  const auto all = records(bytes);

  const std::string magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(bytes.substr(0, 8), magic);
  EXPECT_EQ(bytes.substr(bytes.size() - 8), magic);
  std::vector<int> opcodes;
  opcodes.reserve(all.size());
  for (const Record& record : all) opcodes.push_back(record.opcode);
  // Header, data end, statistics, their summary offset, footer.
  ASSERT_EQ(opcodes, (std::vector<int>{0x01, 0x0F, 0x0B, 0x0E, 0x02}));
  EXPECT_EQ(summary.bytes, bytes.size());
  EXPECT_EQ(summary.messages, 0U);

  // 8 magic, header 9 + 8, data end 9 + 4 -> summary at 38; statistics 9 + 46 -> offsets at 93.
  EXPECT_EQ(value_at<std::uint64_t>(bytes, all[4].offset), 38U);
  EXPECT_EQ(value_at<std::uint64_t>(bytes, all[4].offset + 8), 93U);
  const Bytes raw = as_bytes(bytes);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, all[1].offset), 0U);  // Not computed.
  EXPECT_EQ(value_at<std::uint32_t>(bytes, all[4].offset + 16),
            crc32(raw.subspan(38, all[4].offset + 16 - 38)));
}

TEST_F(McapWriterTest, SameCallsSameBytes) {
  for (const Compression compression :
       {Compression::kNone, Compression::kZstd, Compression::kZstdFast}) {
    const LogSummary first = write_example(compression, 1000);
    const std::string bytes = contents(path_);
    const LogSummary second = write_example(compression, 1000);
    EXPECT_EQ(first.sha256, second.sha256);
    EXPECT_EQ(bytes, contents(path_));
    EXPECT_EQ(first.bytes, bytes.size());
    EXPECT_EQ(first.messages, 50U);
  }
}

TEST_F(McapWriterTest, TheIdentityKnowsNeitherCompressionNorChunks) {
  const std::string identity = write_example(Compression::kNone, 1000).sha256;
  const std::string bytes = contents(path_);
  EXPECT_EQ(write_example(Compression::kZstd, 1000).sha256, identity);
  EXPECT_NE(contents(path_), bytes);
  EXPECT_EQ(write_example(Compression::kZstd, 1 << 20).sha256, identity);

  // Its definition, on the file that is not compressed.
  Sha256 hash;
  const Bytes all = as_bytes(bytes);
  for (const Record& record : records(bytes)) {
    constexpr std::size_t kChunkHeader = 8 + 8 + 8 + 4 + 4 + 8;  // No compression name.
    if (record.opcode == 0x0F) break;
    if (record.opcode == 0x06) {
      hash.update(all.subspan(record.offset + kChunkHeader, record.length - kChunkHeader));
    } else if (record.opcode == 0x09 || record.opcode == 0x0C) {
      hash.update(all.subspan(record.offset - 9, record.length + 9));
    }
  }
  EXPECT_EQ(hash.hex(), identity);
}

TEST_F(McapWriterTest, TheIdentityChangesWithEveryBitOfTheContents) {
  const auto identity = [this](std::uint64_t time_ns, std::string_view data,
                               std::string_view file) {
    McapWriter writer(path_, {});
    writer.write(writer.add_channel("/a", 0, "cdr"), time_ns, time_ns, as_bytes(data));
    writer.attach("file", "text/plain", 7, as_bytes(file));
    return writer.close().sha256;
  };
  const std::string first = identity(1, "a", "x");
  EXPECT_EQ(identity(1, "a", "x"), first);
  EXPECT_NE(identity(2, "a", "x"), first);
  EXPECT_NE(identity(1, "b", "x"), first);
  EXPECT_NE(identity(1, "a", "y"), first);
}

TEST_F(McapWriterTest, AFullDiskReachesTheCallerAndLeavesNoCompleteFile) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{100'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::string error;
  try {
    McapWriter writer(path_, {"", "", 50'000, Compression::kNone});
    const auto channel = writer.add_channel("/a", 0, "cdr");
    const std::string data(10'000, 'x');
    for (std::uint64_t k = 0; k < 1000; ++k) writer.write(channel, k, k, as_bytes(data));
    writer.close();
  } catch (const LogError& e) {
    error = e.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error, path_.string() + ".part: cannot write: File too large");
  EXPECT_FALSE(fs::exists(path_));
  fs::remove(path_.string() + ".part");
}

TEST_F(McapWriterTest, ChunkIndexesPointAtChunksAndMessages) {
  write_example(Compression::kNone, 1000);
  const std::string bytes = contents(path_);
  int chunks = 0;
  for (const Record& record : records(bytes)) {
    if (record.opcode != 0x08) continue;
    ++chunks;
    const auto chunk = static_cast<std::size_t>(value_at<std::uint64_t>(bytes, record.offset + 16));
    const auto length = value_at<std::uint64_t>(bytes, record.offset + 24);
    EXPECT_EQ(bytes[chunk], 0x06);
    EXPECT_EQ(value_at<std::uint64_t>(bytes, chunk + 1), length - 9);
    const std::size_t data = chunk + 9 + 8 + 8 + 8 + 4 + 4 + 8;  // No compression name.
    // The first message index of the chunk: its first entry is a message of that channel and time.
    const auto index = static_cast<std::size_t>(value_at<std::uint64_t>(bytes, record.offset + 38));
    EXPECT_EQ(bytes[index], 0x07);
    const auto channel = value_at<std::uint16_t>(bytes, index + 9);
    const auto time = value_at<std::uint64_t>(bytes, index + 15);
    const auto message =
        data + static_cast<std::size_t>(value_at<std::uint64_t>(bytes, index + 23));
    EXPECT_EQ(bytes[message], 0x05);
    EXPECT_EQ(value_at<std::uint16_t>(bytes, message + 9), channel);
    EXPECT_EQ(value_at<std::uint64_t>(bytes, message + 15), time);
  }
  // 50 messages of 131 bytes and some 100 bytes of schema and channels, cut at 1000.
  EXPECT_EQ(chunks, 7);
}

TEST_F(McapWriterTest, MessageIndexesAreSortedThoughMessagesWereLate) {
  write_example(Compression::kNone, 1 << 20);
  const std::string bytes = contents(path_);
  int indexes = 0;
  for (const Record& record : records(bytes)) {
    if (record.opcode != 0x07) continue;
    ++indexes;
    std::uint64_t last = 0;
    for (std::size_t at = record.offset + 6; at < record.offset + record.length; at += 16) {
      EXPECT_LE(last, value_at<std::uint64_t>(bytes, at));
      last = value_at<std::uint64_t>(bytes, at);
    }
  }
  EXPECT_EQ(indexes, 2);
}

TEST_F(McapWriterTest, RefusesUnknownChannelsAndSchemas) {
  McapWriter writer(path_, {});
  EXPECT_THROW(writer.add_channel("/a", 1, "cdr"), LogError);
  EXPECT_THROW(writer.write(1, 0, 0, {}), LogError);
  EXPECT_THROW(writer.write(0, 0, 0, {}), LogError);
}

TEST_F(McapWriterTest, TheFileAppearsInClose) {
  McapWriter writer(path_, {});
  EXPECT_FALSE(fs::exists(path_));
  writer.close();
  EXPECT_TRUE(fs::exists(path_));
}

}  // namespace
}  // namespace rosflight::log
