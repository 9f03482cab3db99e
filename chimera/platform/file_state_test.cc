// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/file_state.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

namespace fs = std::filesystem;

class FileStateTest : public ::testing::Test {
 protected:
  FileStateTest() : folder_(testing::TempDir() + "file_state_" + std::to_string(::getpid())), path_(folder_ + "/f") {
    EXPECT_TRUE(make_private_folder(folder_));
    std::ofstream(path_) << "before";
    fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  }
  ~FileStateTest() override { fs::remove_all(folder_); }
  std::string content() const {
    std::ostringstream text;
    text << std::ifstream(path_).rdbuf();
    return text.str();
  }

  std::string folder_, path_;
};

TEST_F(FileStateTest, ReplacesWithTheSamePermissions) {
  const auto known = state_of_file(path_);
  ASSERT_TRUE(known);
  EXPECT_TRUE(replace_file(path_, *known, "after"));
  EXPECT_EQ(content(), "after");
  EXPECT_EQ(state_of_file(path_)->mode, 0640u);
  EXPECT_NE(state_of_file(path_), known);
}

TEST_F(FileStateTest, RefusesAFileThatHasChanged) {
  const auto known = state_of_file(path_);
  fs::remove(path_);
  std::ofstream(path_) << "somebody else";
  const auto replaced = replace_file(path_, *known, "after");
  ASSERT_FALSE(replaced);
  EXPECT_EQ(replaced.error().message.view(), "changed just now");
  EXPECT_EQ(content(), "somebody else");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(FileStateTest, KnowsNoFileThatIsNotThere) {
  EXPECT_FALSE(state_of_file(folder_ + "/none"));
  EXPECT_EQ(replace_file(folder_ + "/none/f", {}, "").error().message.view(),
            "cannot be written: No such file or directory");
}

TEST_F(FileStateTest, APrivateFolderIsForItsUserAlone) {
  EXPECT_EQ(state_of_file(folder_)->mode, 0700u);
  EXPECT_TRUE(make_private_folder(folder_));
  EXPECT_FALSE(make_private_folder(path_));
}

TEST(WallClockShift, LeadsFromOneClockToTheOther) {
  const auto wall = std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  EXPECT_NEAR(static_cast<double>(LinuxClock().now().count + wall_clock_shift() - wall), 0, 1e9);
}

}  // namespace
}  // namespace chimera
