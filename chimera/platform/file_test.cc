// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace chimera::file_test {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, and the path of a file in the folder.
struct FolderTest : ::testing::Test {
  FolderTest() { EXPECT_NE(::mkdtemp(made), nullptr); }
  ~FolderTest() override { fs::remove_all(folder()); }
  std::string folder() const { return made; }
  std::string path() const { return folder() + "/file"; }
  void write(const std::string& text) const { std::ofstream(path(), std::ios::binary) << text; }
  std::string content() const {
    std::ostringstream all;
    all << std::ifstream(path(), std::ios::binary).rdbuf();
    return all.str();
  }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder()), {}); }

  char made[40] = "/tmp/chimera_file_XXXXXX";
};

TEST(FileBytes, ReadsAtAPlaceUntilTheEnd) {
  std::FILE* file = std::tmpfile();
  ASSERT_EQ(std::fputs("abcdef", file), 1);
  std::fflush(file);
  char text[8] = {};
  EXPECT_EQ(file_size(::fileno(file)), 6);
  EXPECT_EQ(read_at(::fileno(file), 4, std::as_writable_bytes(std::span(text))), 2);
  EXPECT_STREQ(text, "ef");
  EXPECT_EQ(read_at(::fileno(file), 6, std::as_writable_bytes(std::span(text))), 0);
  std::fclose(file);
  EXPECT_EQ(file_size(-1), -1);
  EXPECT_EQ(read_at(-1, 0, std::as_writable_bytes(std::span(text))), -1);
}

TEST_F(FolderTest, FreesTheFirstBytesOfAGrowingFile) {
  write(std::string((1 << 20) - 1, 'x') + "\n");
  auto file = open_to_append(path());
  ASSERT_TRUE(file);
  struct stat before {}, after {};
  ASSERT_EQ(::fstat(file->fd, &before), 0);
  if (!free_bytes_before(file->fd, 1 << 19)) GTEST_SKIP() << "this file system cannot do it";
  ASSERT_EQ(::write(file->fd, "end", 3), 3);
  ASSERT_EQ(::fstat(file->fd, &after), 0);
  EXPECT_EQ(after.st_size, (1 << 20) + 3);
  EXPECT_LE(after.st_blocks, before.st_blocks / 2 + 16);
  EXPECT_EQ(content().substr((1 << 20) - 2), "x\nend");
}

struct FileStateTest : FolderTest {
  FileStateTest() {
    write("before");
    fs::permissions(path(), fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  }
};

TEST_F(FileStateTest, ReplacesWithTheSamePermissions) {
  const auto known = state_of_file(path());
  ASSERT_TRUE(known);
  EXPECT_TRUE(replace_file(path(), *known, "after"));
  EXPECT_EQ(content(), "after");
  EXPECT_EQ(state_of_file(path())->mode, 0640u);
  EXPECT_NE(state_of_file(path()), known);
}

TEST_F(FileStateTest, RefusesToReplaceAChangedFile) {
  const auto known = state_of_file(path());
  fs::remove(path());
  std::ofstream(path()) << "another text";
  const auto replaced = replace_file(path(), *known, "after");
  ASSERT_FALSE(replaced);
  EXPECT_EQ(replaced.error().message.view(), "changed just now");
  EXPECT_EQ(content(), "another text");
  EXPECT_EQ(files(), 1);
}

TEST_F(FileStateTest, HasNoStateWithoutAFile) {
  EXPECT_FALSE(state_of_file(folder() + "/none"));
  EXPECT_EQ(replace_file(folder() + "/none/f", {}, "").error().message.view(),
            "cannot be written: No such file or directory");
}

TEST_F(FileStateTest, PrivateFolderIsForItsUserOnly) {
  const std::string inner = folder() + "/private";
  EXPECT_TRUE(make_private_folder(inner));
  EXPECT_EQ(state_of_file(inner)->mode, 0700u);
  EXPECT_TRUE(make_private_folder(inner));
  EXPECT_FALSE(make_private_folder(path()));
}

struct PartFileTest : FolderTest {
  PartFileTest() { write("before"); }
};

TEST_F(PartFileTest, ReplacesTheFileWhole) {
  auto part = PartFile::open(path());
  ASSERT_TRUE(part);
  EXPECT_EQ(content(), "before");
  EXPECT_EQ(files(), 2);
  EXPECT_TRUE(part->put("after"));
  EXPECT_EQ(content(), "after");
  EXPECT_EQ(files(), 1);
}

TEST_F(PartFileTest, LeavesNothingWithoutPut) {
  { ASSERT_TRUE(PartFile::open(path())); }
  EXPECT_EQ(content(), "before");
  EXPECT_EQ(files(), 1);
}

TEST_F(PartFileTest, RefusesAFolderAsPlaceAndAMissingFolder) {
  EXPECT_EQ(PartFile::open(folder()).error().message.view(), "is no ordinary file");
  const auto refused = PartFile::open(folder() + "/none/f");
  EXPECT_EQ(refused.error().message.view(), "cannot be written: No such file or directory");
  EXPECT_EQ(refused.error().where.view(), folder() + "/none/f");
}

TEST_F(PartFileTest, LeavesThePlaceAsItWasWhenPutFails) {
  auto part = PartFile::open(path());
  ASSERT_TRUE(part);
  fs::remove(path() + "." + std::to_string(::getpid()) + ".part");  // the renaming fails
  EXPECT_EQ(part->put("after").error().message.view(), "cannot be written: No such file or directory");
  EXPECT_EQ(content(), "before");
}

TEST_F(PartFileTest, RefusesToPutANewFileOverAnother) {
  EXPECT_EQ(PartFile::open(path(), 0600)->put_new("after").error().message.view(), "is there already");
  EXPECT_EQ(content(), "before");
  fs::remove(path());
  EXPECT_TRUE(PartFile::open(path(), 0600)->put_new("after"));
  EXPECT_EQ(content(), "after");
  EXPECT_EQ(files(), 1);
  EXPECT_EQ(state_of_file(path())->mode, 0600u);
}

struct LineFileTest : FolderTest {};

TEST_F(LineFileTest, IsMadeForThisUserOnlyAndGrowsAtItsEnd) {
  for (const char* line : {"one\n", "two\n"}) {
    auto file = LineFile::open(path());
    ASSERT_TRUE(file) << file.error().message.c_str();
    EXPECT_TRUE(file->append(line));
  }
  EXPECT_EQ(content(), "one\ntwo\n");
  struct stat status {};
  ASSERT_EQ(::stat(path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
}

TEST_F(LineFileTest, CutsOffALineWithoutItsEnd) {
  for (const std::size_t length : {std::size_t{1}, std::size_t{1} << 16, std::size_t{200'000}}) {
    write("one\n" + std::string(length, 'x'));
    const auto file = LineFile::open(path());
    ASSERT_TRUE(file);
    EXPECT_EQ(file->bytes(), 4u);
    EXPECT_EQ(content(), "one\n") << length;
  }
  write("never ended");
  EXPECT_EQ(LineFile::open(path())->bytes(), 0u);
  EXPECT_EQ(content(), "");
}

TEST_F(LineFileTest, TailHasWholeLinesOnly) {
  write("one\ntwo\nthree\n");
  const auto file = LineFile::open(path());
  ASSERT_TRUE(file);
  EXPECT_EQ(file->tail(100), "one\ntwo\nthree\n");
  EXPECT_EQ(file->tail(13), "two\nthree\n");
  EXPECT_EQ(file->tail(10), "two\nthree\n");
  EXPECT_EQ(file->tail(9), "three\n");
  EXPECT_EQ(file->tail(14), "one\ntwo\nthree\n");
  EXPECT_EQ(file->tail(3), "");
  EXPECT_EQ(file->tail(0), "");
}

TEST_F(LineFileTest, RefusesANamedPipeAndAMissingFolder) {
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
  const auto pipe = LineFile::open(path());
  ASSERT_FALSE(pipe);
  EXPECT_EQ(pipe.error().message.view(), "is no ordinary file");
  EXPECT_EQ(pipe.error().where.view(), path());
  const auto nowhere = LineFile::open(folder() + "/none/lines");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().message.view(), "cannot be opened: No such file or directory");
}

// A file size limit cuts a write in its middle, like a disk that becomes full.
TEST_F(LineFileTest, KeepsTheFileAsItWasWhenThereIsNoRoom) {
  write("one\n");
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{6, 6};
    auto file = LineFile::open(path());
    const bool is_set = ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
    const auto refused = file->append("two\nthree\n");
    const bool is_told = !refused && refused.error().message.view() == "cannot be written: File too large";
    ::_exit(is_set && is_told && file->bytes() == 4 && file->append("2\n") ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(content(), "one\n2\n");
}

TEST_F(LineFileTest, RenamedFileMakesRoomForANewFile) {
  auto file = LineFile::open(path());
  ASSERT_TRUE(file->append("one\n"));
  ASSERT_TRUE(file->rename_to(path() + ".1"));
  auto next = LineFile::open(path());  // the lock is on the file, not on its name
  ASSERT_TRUE(next);
  EXPECT_EQ(next->bytes(), 0u);
  EXPECT_TRUE(fs::exists(path() + ".1"));
}

}  // namespace
}  // namespace chimera::file_test
