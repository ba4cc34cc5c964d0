// SPDX-License-Identifier: BSD-3-Clause
#include "log/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>

namespace rosflight::log {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("output_file_") +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const LogError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(OutputFileTest, AppearsOnlyWhenCommitted) {
  const fs::path path = folder_ / "log.mcap";
  {
    OutputFile file(path);
    file.write(as_bytes("half a sentence"));
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(fs::exists(folder_ / "log.mcap.part"));

  OutputFile file(path);
  file.write(as_bytes("all of it"));
  file.commit();
  EXPECT_EQ(contents(path), "all of it");
  EXPECT_FALSE(fs::exists(folder_ / "log.mcap.part"));
}

TEST_F(OutputFileTest, ABrokenRunLeavesTheOldFileAlone) {
  const fs::path path = folder_ / "log.mcap";
  base::write_file(path, "old");
  {
    OutputFile file(path);
    file.write(as_bytes("new"));
  }
  EXPECT_EQ(contents(path), "old");
}

TEST_F(OutputFileTest, SmallAndLargePiecesArriveInOrder) {
  std::string expected;
  OutputFile file(folder_ / "x");
  for (std::size_t size : {1U, 700'000U, 3U, 262'144U, 262'143U, 5U, 0U, 100'000U, 200'000U}) {
    const std::string piece(size, static_cast<char>('a' + size % 26));
    file.write(as_bytes(piece));
    expected += piece;
  }
  EXPECT_EQ(file.size(), expected.size());
  file.commit();
  EXPECT_EQ(contents(folder_ / "x"), expected);
}

TEST_F(OutputFileTest, AFolderThatIsNotThereIsOneLineThatNamesTheFile) {
  const std::string error = error_of([&] { OutputFile file(folder_ / "missing" / "log.mcap"); });
  EXPECT_EQ(error, (folder_ / "missing" / "log.mcap.part").string() +
                       ": cannot create: No such file or directory");
}

TEST_F(OutputFileTest, AFolderIsNotAFile) {
  EXPECT_EQ(error_of([&] { OutputFile file(folder_); }),
            folder_.string() + ": cannot write: it is a folder, not a file");
  EXPECT_FALSE(fs::exists(folder_.string() + ".part"));
}

/// Limits the size of files this process may write, which is a full disk in a test's reach.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int){nullptr};
};

TEST_F(OutputFileTest, AFullDiskIsOneLineAndNoCompleteFile) {
  const fs::path path = folder_ / "log.mcap";
  const std::string megabyte(1'000'000, 'x');
  std::string error;
  {
    const FullDisk full(1'500'000);
    error = error_of([&] {
      OutputFile file(path);
      for (int k = 0; k < 3; ++k) file.write(as_bytes(megabyte));
      file.commit();
    });
  }
  EXPECT_EQ(error, (folder_ / "log.mcap.part").string() + ": cannot write: File too large");
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(OutputFileTest, AFullDiskIsNoticedAtTheVeryEndToo) {
  const fs::path path = folder_ / "log.mcap";
  std::string error;
  {
    const FullDisk full(4);
    error = error_of([&] {
      OutputFile file(path);
      file.write(as_bytes("more than four"));  // All of it waits in the buffer.
      file.commit();
    });
  }
  EXPECT_NE(error.find("cannot write"), std::string::npos) << error;
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace rosflight::log
