// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/line_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace chimera {
namespace {

struct LineFileTest : ::testing::Test {
  LineFileTest() { EXPECT_NE(::mkdtemp(folder), nullptr); }
  ~LineFileTest() override { std::filesystem::remove_all(folder); }
  void write(const std::string& text) { std::ofstream(path(), std::ios::binary) << text; }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(path(), std::ios::binary).rdbuf();
    return all.str();
  }
  std::string path() const { return std::string(folder) + "/lines"; }

  char folder[40] = "/tmp/chimera_line_file_XXXXXX";
};

TEST_F(LineFileTest, IsMadeForThisUserAloneAndGrowsAtItsEnd) {
  for (const char* line : {"one\n", "two\n"}) {
    auto file = LineFile::open(path());
    ASSERT_TRUE(file) << file.error().message.c_str();
    EXPECT_TRUE(file->append(line));
  }
  EXPECT_EQ(text(), "one\ntwo\n");
  struct stat status {};
  ASSERT_EQ(::stat(path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
}

TEST_F(LineFileTest, ALineWithoutItsEndIsCutOff) {
  for (const std::size_t length : {std::size_t{1}, std::size_t{1} << 16, std::size_t{200'000}}) {
    write("one\n" + std::string(length, 'x'));
    const auto file = LineFile::open(path());
    ASSERT_TRUE(file);
    EXPECT_EQ(file->bytes(), 4u);
    EXPECT_EQ(text(), "one\n") << length;
  }
  write("never ended");
  EXPECT_EQ(LineFile::open(path())->bytes(), 0u);
  EXPECT_EQ(text(), "");
}

TEST_F(LineFileTest, TheTailHasWholeLinesOnly) {
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

TEST_F(LineFileTest, WhatIsNoOrdinaryFileAndWhatCannotBeOpenedIsRefused) {
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
  const auto pipe = LineFile::open(path());
  ASSERT_FALSE(pipe);
  EXPECT_EQ(pipe.error().message.view(), "is no ordinary file");
  EXPECT_EQ(pipe.error().where.view(), path());
  const auto nowhere = LineFile::open(std::string(folder) + "/none/lines");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().message.view(), "cannot be opened: No such file or directory");
}

// A file size limit cuts a write in its middle, as a disk does that fills up.
TEST_F(LineFileTest, WhatFindsNoRoomLeavesTheFileAsItWas) {
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
  EXPECT_EQ(text(), "one\n2\n");
}

TEST_F(LineFileTest, ARenamedFileMakesRoomForANewOne) {
  auto file = LineFile::open(path());
  ASSERT_TRUE(file->append("one\n"));
  ASSERT_TRUE(file->rename_to(path() + ".1"));
  auto next = LineFile::open(path());  // the lock is on the file, not on its name
  ASSERT_TRUE(next);
  EXPECT_EQ(next->bytes(), 0u);
  EXPECT_TRUE(std::filesystem::exists(path() + ".1"));
}

}  // namespace
}  // namespace chimera
