// SPDX-License-Identifier: BSD-3-Clause
#include "base/atomic_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <string>

namespace rosflight::base {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::path(testing::TempDir()) / "atomic_file_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(AtomicFileTest, AppearsOnlyWhenCommitted) {
  const fs::path path = folder_ / "a";
  {
    AtomicFile file{path};
    file.write("half", 4);
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_EQ(contents(folder_ / "a.part"), "half");

  AtomicFile file{path};
  file.write("all ", 4);
  file.write("of it", 5);
  file.commit(Durability::kPowerCut);
  EXPECT_EQ(contents(path), "all of it");
  EXPECT_FALSE(fs::exists(folder_ / "a.part"));
}

TEST_F(AtomicFileTest, FullDiskKeepsTheOldFileAndLeavesNoPart) {
  const fs::path path = folder_ / "a";
  write_file(path, "old");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  void (*const handler)(int) = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{4, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::string error;
  try {
    write_file(path, "more than four", Durability::kPowerCut);
  } catch (const FileError& e) {
    error = e.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error, path.string() + ".part: cannot write: File too large");
  EXPECT_EQ(contents(path), "old");
  EXPECT_FALSE(fs::exists(path.string() + ".part"));
}

TEST_F(AtomicFileTest, FolderInTheWayIsOneLine) {
  try {
    write_file(folder_, "text");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.what(), folder_.string() + ": cannot write: it is a folder, not a file");
  }
  EXPECT_FALSE(fs::exists(folder_.string() + ".part"));
}

TEST(FileDescriptor, IsClosedOnceByItsLastOwner) {
  const auto open = [](int fd) { return ::fcntl(fd, F_GETFD) >= 0; };
  FileDescriptor first{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
  const int fd = first.get();
  {
    const FileDescriptor second{std::move(first)};
    EXPECT_FALSE(first.valid());  // NOLINT(bugprone-use-after-move): empty by contract
    EXPECT_TRUE(open(fd));
  }
  EXPECT_FALSE(open(fd));
  FileDescriptor third{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
  const int given = third.release();
  EXPECT_TRUE(third.close());
  EXPECT_TRUE(open(given));
  ::close(given);
}

}  // namespace
}  // namespace rosflight::base
