// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct CsvLogTest : testing::Test {
  Rig rig{"csv_log"};
  std::string path = testing::TempDir() + "csv_log_" + std::to_string(::getpid()) + ".csv";

  ~CsvLogTest() override { ::unlink(path.c_str()); }

  void start(std::int32_t capacity) {
    rig.instances("in", 2);
    rig.extent("n", 2);
    rig.set("capacity", capacity);
    rig.resource("file", path.c_str());
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(path).rdbuf();
    return all.str();
  }
};

TEST_F(CsvLogTest, WritesARowForEachCycleWhenItIsKilled) {
  start(10);
  rig.set("in", 1.5, 0, 0);
  rig.set("in", -2.0, 1, 0);
  ASSERT_TRUE(rig.cycle());
  rig.set("in", 0.1, 0, 1);
  rig.set("in", 1e20, 1, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int32_t>("rows"), 2);
  EXPECT_EQ(text(), "");  // nothing on its way to the disk while others run
  ASSERT_TRUE(rig.kill());
  EXPECT_EQ(text(), "t,in[0][0],in[0][1],in[1][0],in[1][1]\n"
                    "0.001,1.5,-2,,\n"
                    "0.002,1.5,-2,0.1,1e+20\n");
}

TEST_F(CsvLogTest, CountsTheRowsThatFindNoRoom) {
  start(2);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int32_t>("rows"), 2);
  EXPECT_EQ(rig.get<std::int64_t>("lost"), 3);
  ASSERT_TRUE(rig.kill());
  EXPECT_EQ(text(), "t,in[0][0],in[0][1],in[1][0],in[1][1]\n0.001,,,,\n0.002,,,,\n");
}

TEST_F(CsvLogTest, GoesOnInTheSameFileAfterItWasOff) {
  start(10);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.kill());
  EXPECT_EQ(text(), "t,in[0][0],in[0][1],in[1][0],in[1][1]\n0.001,,,,\n0.002,,,,\n");
}

TEST_F(CsvLogTest, RefusesAFileThatCannotBeWrittenAndNothingToLog) {
  path = "/no/such/folder/log.csv";
  rig.instances("in", 1);
  rig.resource("file", path.c_str());
  EXPECT_EQ(rig.init().text, "/no/such/folder/log.csv: No such file or directory");
  rig.instances("in", 0);
  EXPECT_EQ(rig.init().text, "there is nothing to log: name at least one input");
}

}  // namespace
}  // namespace chimera
