// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/linux/file_storage.hpp"

#include <sys/stat.h>

#include <fstream>
#include <iterator>

#include "firmware/boards/linux/linux_error.hpp"
#include "firmware/boards/linux/test/far_end.hpp"
#include "firmware/core/parameter_store.hpp"

namespace rosflight::boards {
namespace {

namespace fs = std::filesystem;

Bytes contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(stream), {});
}

void fill(const fs::path& file, const Bytes& bytes) {
  std::ofstream stream(file, std::ios::binary);
  std::copy(bytes.begin(), bytes.end(), std::ostreambuf_iterator<char>(stream));
}

std::string error_of(const fs::path& file) {
  try {
    const FileStorage storage(file);
  } catch (const LinuxError& error) {
    return error.what();
  }
  return "no error";
}

class FileStorageTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path file_ = folder_ / "memory";
};

TEST_F(FileStorageTest, CreatesABlankFileOf16KiB) {
  const FileStorage storage(file_);
  EXPECT_TRUE(storage.created());
  EXPECT_EQ(contents(file_), Bytes(16384, 0xFF));
}

TEST_F(FileStorageTest, WritesInPlace) {
  FileStorage storage(file_);
  const Bytes data{1, 2, 3};
  ASSERT_TRUE(storage.write(100, data.data(), data.size()));
  ASSERT_TRUE(storage.flush());
  Bytes expected(16384, 0xFF);
  std::copy(data.begin(), data.end(), expected.begin() + 100);
  EXPECT_EQ(contents(file_), expected);
}

TEST_F(FileStorageTest, AnExistingFileKeepsItsBytesAndAShortOneIsFilledUp) {
  fill(file_, {7, 8, 9});
  FileStorage storage(file_);
  EXPECT_FALSE(storage.created());
  Bytes bytes(5);
  ASSERT_TRUE(storage.read(0, bytes.data(), bytes.size()));
  EXPECT_EQ(bytes, (Bytes{7, 8, 9, 0xFF, 0xFF}));
  EXPECT_EQ(contents(file_).size(), 16384u);
}

TEST_F(FileStorageTest, AFileCutOffBehindItsBackFailsInsteadOfInventingBytes) {
  FileStorage storage(file_);
  fs::resize_file(file_, 1000);
  Bytes bytes(100);
  EXPECT_TRUE(storage.read(900, bytes.data(), 100));
  EXPECT_FALSE(storage.read(950, bytes.data(), 100));
}

TEST_F(FileStorageTest, BadFilesAreOneLineEach) {
  EXPECT_EQ(error_of(folder_ / "nowhere/memory"),
            (folder_ / "nowhere/memory").string() +
                ": found 'No such file or directory', allowed a file to read and write as "
                "non-volatile memory");
  EXPECT_NE(error_of("/proc/memory").find("/proc/memory: found '"), std::string::npos);
  EXPECT_NE(error_of(folder_ / "").find("found 'Is a directory'"), std::string::npos);
  EXPECT_NE(error_of("/dev/null").find("found something else, allowed a plain file"),
            std::string::npos);
  const fs::path fifo = folder_ / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_NE(error_of(fifo).find("allowed a plain file"), std::string::npos);
}

TEST_F(FileStorageTest, AFolderWithoutPermissionIsOneLine) {
  const fs::path locked = folder_ / "locked";
  fs::create_directory(locked);
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  const uid_t me = ::geteuid();
  constexpr uid_t kNobody = 65534;
  if (me == 0) {
    ASSERT_EQ(::seteuid(kNobody), 0);  // root may write everywhere
  }
  const std::string error = error_of(locked / "memory");
  if (me == 0) {
    ASSERT_EQ(::seteuid(me), 0);
  }
  EXPECT_NE(error.find("found 'Permission denied'"), std::string::npos) << error;
}

TEST_F(FileStorageTest, ALongFileIsSomebodyElsesAndStaysAsItIs) {
  const Bytes bytes(16385, 5);
  fill(file_, bytes);
  EXPECT_NE(error_of(file_).find("found 16385 bytes, allowed at most 16384"), std::string::npos);
  EXPECT_EQ(contents(file_), bytes);
}

TEST_F(FileStorageTest, TwoBoardsCannotShareAMemory) {
  {
    const FileStorage first(file_);
    EXPECT_NE(error_of(file_).find("in use by another process"), std::string::npos);
  }
  EXPECT_EQ(error_of(file_), "no error");
}

/// A copy that ends anywhere gives the set before, the set after, or none: never something else.
TEST_F(FileStorageTest, AParameterSetCutOffAnywhereIsTheOldOneTheNewOneOrNone) {
  using core::Param;
  {
    FileStorage storage(file_);
    core::ParameterStore store(storage);
    core::Parameters parameters;
    ASSERT_EQ(parameters.set_int(Param::kNumMotors, 3), core::SetResult::kChanged);
    ASSERT_EQ(store.save(parameters), core::StoreResult::kOk);
    ASSERT_EQ(parameters.set_int(Param::kNumMotors, 6), core::SetResult::kChanged);
    ASSERT_EQ(store.save(parameters), core::StoreResult::kOk);
  }
  const Bytes whole = contents(file_);
  std::array<int, 3> seen{};
  for (std::size_t size = 0; size <= whole.size(); size += 128) {
    fill(file_, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    FileStorage storage(file_);
    core::ParameterStore store(storage);
    core::Parameters parameters;
    core::ParameterStore::LoadReport report;
    const core::StoreResult result = store.load(parameters, report);
    const int motors = parameters.get_int(Param::kNumMotors);
    if (result == core::StoreResult::kBlank || result == core::StoreResult::kDamaged) {
      ASSERT_EQ(motors, 4) << size;
      ++seen[0];
    } else {
      ASSERT_EQ(result, core::StoreResult::kOk) << size;
      ASSERT_TRUE(motors == 3 || motors == 6) << size;
      ++seen[motors == 3 ? 1 : 2];
    }
  }
  EXPECT_GT(seen[0], 0);
  EXPECT_GT(seen[1], 0);
  EXPECT_GT(seen[2], 0);
}

}  // namespace
}  // namespace rosflight::boards
