// SPDX-License-Identifier: Apache-2.0
#include "chimera/component_test/partner.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

namespace chimera::component_test {
namespace {

namespace fs = std::filesystem;

class PartnerProgram : public ::testing::Test {
 protected:
  PartnerProgram() : file_((fs::temp_directory_path() / ("partner_" + std::to_string(::getpid()))).string()) {}
  ~PartnerProgram() override { fs::remove(file_); }
  Result<Partner> start(const std::string& script, Nanoseconds patience) {
    std::ofstream(file_) << "#!/bin/sh\n" << script;
    fs::permissions(file_, fs::perms::owner_all);
    return Partner::start(file_, patience);
  }
  std::string file_;
};

TEST_F(PartnerProgram, SaysALineAndIsEndedWithIt) {
  pid_t child = 0;
  {
    const auto partner = start("echo $$\nexec sleep 100\n", seconds(60));
    ASSERT_TRUE(partner) << partner.error().message.c_str();
    child = static_cast<pid_t>(std::stol(partner->line()));
    EXPECT_EQ(::kill(child, 0), 0);
  }
  EXPECT_NE(::kill(child, 0), 0);
}

TEST_F(PartnerProgram, LivesInItsFolder) {
  const auto partner = start("pwd\nexec sleep 100\n", seconds(60));
  ASSERT_TRUE(partner);
  EXPECT_EQ(partner->line(), fs::canonical(fs::temp_directory_path()).string());
}

TEST_F(PartnerProgram, IsRefusedWhenItSaysNothing) {
  const auto ended = start("exit 0\n", seconds(60));
  ASSERT_FALSE(ended);
  EXPECT_EQ(std::string(ended.error().message.c_str()), "printed no first line");
  EXPECT_FALSE(start("exec sleep 100\n", milliseconds(200)));
}

}  // namespace
}  // namespace chimera::component_test
