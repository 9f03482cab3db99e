// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/part_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace chimera {
namespace {

class PartFileTest : public ::testing::Test {
 protected:
  PartFileTest() : folder_(testing::TempDir() + "part_file_" + std::to_string(::getpid())), path_(folder_ + "/f") {
    std::filesystem::create_directory(folder_);
    std::ofstream(path_) << "before";
  }
  ~PartFileTest() override { std::filesystem::remove_all(folder_); }
  std::string content() const {
    std::ostringstream text;
    text << std::ifstream(path_).rdbuf();
    return text.str();
  }
  std::ptrdiff_t files() const { return std::distance(std::filesystem::directory_iterator(folder_), {}); }

  std::string folder_, path_;
};

TEST_F(PartFileTest, TakesThePlaceWhole) {
  auto part = PartFile::open(path_);
  ASSERT_TRUE(part);
  EXPECT_EQ(content(), "before");
  EXPECT_EQ(files(), 2);
  EXPECT_TRUE(part->put("after"));
  EXPECT_EQ(content(), "after");
  EXPECT_EQ(files(), 1);
}

TEST_F(PartFileTest, LeavesNothingWhenItIsNotPut) {
  { ASSERT_TRUE(PartFile::open(path_)); }
  EXPECT_EQ(content(), "before");
  EXPECT_EQ(files(), 1);
}

TEST_F(PartFileTest, RefusesWhatIsNoFileAndAFolderThatIsNotThere) {
  EXPECT_EQ(PartFile::open(folder_).error().message.view(), "is no ordinary file");
  const auto refused = PartFile::open(folder_ + "/none/f");
  EXPECT_EQ(refused.error().message.view(), "cannot be written: No such file or directory");
  EXPECT_EQ(refused.error().where.view(), folder_ + "/none/f");
}

TEST_F(PartFileTest, WhatCannotBePutLeavesThePlaceAsItWas) {
  auto part = PartFile::open(path_);
  ASSERT_TRUE(part);
  std::filesystem::remove(path_ + "." + std::to_string(::getpid()) + ".part");  // the renaming fails
  EXPECT_EQ(part->put("after").error().message.view(), "cannot be written: No such file or directory");
  EXPECT_EQ(content(), "before");
}

}  // namespace
}  // namespace chimera
