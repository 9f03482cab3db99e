// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/home.h"
#include "chimera/text/json.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace chimera::control {
namespace {

const std::string kHere = std::filesystem::current_path().string();

TEST(Home, IsReadFromHelloAndMissingFieldsStayEmpty) {
  const Home home = home_of({{"subsystem", "arm"}, {"keeper_pid", 7}, {"session", 5}, {"folder", "/a"}, {"file", "b"}});
  EXPECT_EQ(home.subsystem, "arm");
  EXPECT_EQ(home.keeper_pid, 7);
  EXPECT_EQ(home.session, 5);
  EXPECT_EQ(home.folder, "/a");
  EXPECT_EQ(home.file, "b");
  EXPECT_EQ(home_of({{"session", "5"}, {"folder", 3}}).session, -1);
  EXPECT_EQ(home_of(Json()).folder, "");
}

TEST(Home, IsHereInTheSameTerminalOrFolderOnly) {
  const std::int64_t mine = ::getsid(0);
  EXPECT_TRUE(is_here({"arm", 1, mine, "/", "arm.yaml"})) << "of this terminal";
  EXPECT_TRUE(is_here({"arm", 1, mine + 1, kHere, "/tmp/arm.yaml"})) << "started in this folder";
  EXPECT_TRUE(is_here({"arm", 1, mine + 1, "/", kHere.substr(1) + "/arm.yaml"})) << "its description lies here";
  EXPECT_TRUE(is_here({"arm", 1, mine + 1, "/", kHere + "/arm.yaml"})) << "its description lies here";
  EXPECT_FALSE(is_here({"arm", 1, mine + 1, "/", "arm.yaml"}));
  EXPECT_FALSE(is_here({"arm", 1, mine + 1, "/nowhere", "arm.yaml"}));
}

TEST(Home, ASubsystemWithoutAStartingPlaceIsNotHere) {
  EXPECT_FALSE(is_here({"arm", 1, -1, "", ""}));
  EXPECT_FALSE(is_here({"arm", 1, -1, "", "arm.yaml"}));
  EXPECT_FALSE(is_here(Home()));
}

}  // namespace
}  // namespace chimera::control
