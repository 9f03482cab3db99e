// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct CsvPlayerTest : ::testing::Test {
  SignalRig rig{"csv_player", 2};
  std::string path = testing::TempDir() + "csv_player_" + std::to_string(::getpid()) + ".csv";

  ~CsvPlayerTest() override { ::unlink(path.c_str()); }

  RigAnswer read(const std::string& text, bool is_repeated = false, bool is_interpolated = false) {
    std::ofstream(path) << text;
    rig.instances("out", 1), rig.instances("start", 0);
    rig.joined("out", "q", "rad", 0);
    rig.resource("file", path.c_str());
    rig.set("is_repeated", is_repeated);
    rig.set("is_interpolated", is_interpolated);
    return rig.init();
  }
  double value(std::size_t i = 0) { return rig.get<double>("out", i); }
};

constexpr const char* kThreeRows = "t,q[0],q[1]\n5.000,1,10\n5.002,2,\n5.004,4,30\n";

TEST_F(CsvPlayerTest, HoldsEachRowUntilTheNextFromItsFirstTimeOn) {
  ASSERT_TRUE(read(kThreeRows));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(value(0), 1);
  EXPECT_EQ(value(1), 10);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(value(0), 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(value(0), 2);
  EXPECT_EQ(value(1), 10);  // an empty field keeps the value
  EXPECT_FALSE(rig.get<bool>("done"));
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  EXPECT_EQ(value(0), 4);
  EXPECT_TRUE(rig.get<bool>("done"));
  ASSERT_TRUE(rig.cycle(seconds(100)));
  EXPECT_EQ(value(1), 30);
}

TEST_F(CsvPlayerTest, FillsAMatrixRowByRowAndAScalar) {
  const auto played = [this](const char* rows, std::uint32_t size) {
    std::ofstream(path) << rows;
    Rig player("csv_player");
    player.shape("n", size, size);
    player.instances("out", 1);
    player.joined("out", "m", "1", 0);
    player.resource("file", path.c_str());
    EXPECT_TRUE(player.init() && player.on());
    std::vector<double> values;
    for (std::uint32_t i = 0; i < player.size("out"); ++i) values.push_back(player.get<double>("out", i));
    return values;
  };
  EXPECT_EQ(played("t,m[0][0],m[0][1],m[1][0],m[1][1]\n0,1,2,3,4\n", 2), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(played("t,m\n0,9\n", 1), (std::vector<double>{9}));
}

TEST_F(CsvPlayerTest, DrawsStraightLinesWhenAsked) {
  ASSERT_TRUE(read(kThreeRows, false, true));
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_NEAR(value(0), 1.5, 1e-9);
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  EXPECT_NEAR(value(0), 3, 1e-9);
  EXPECT_NEAR(value(1), 20, 1e-9);
}

TEST_F(CsvPlayerTest, BeginsAgainWhenAsked) {
  ASSERT_TRUE(read(kThreeRows, true));
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle(milliseconds(3)));
  EXPECT_EQ(value(0), 2);
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  EXPECT_EQ(value(0), 1);
  EXPECT_FALSE(rig.get<bool>("done"));
}

TEST_F(CsvPlayerTest, PlaysAFileOfCsvLog) {
  {
    Rig log("csv_log");
    log.instances("in", 1);
    log.joined("in", "q", "rad", 0);
    log.shape("n", 2, 1);
    log.set("capacity", std::int32_t{1000});
    log.resource("file", path.c_str());
    ASSERT_TRUE(log.init());
    ASSERT_TRUE(log.on());
    for (int k = 0; k < 500; ++k) {
      log.set("in", std::sin(0.01 * k), 0, 0);
      log.set("in", 1.0 * k, 1, 0);
      ASSERT_TRUE(log.cycle());
    }
    ASSERT_TRUE(log.background());
    ASSERT_TRUE(log.kill());
  }
  rig.instances("out", 1), rig.instances("start", 0);
  rig.joined("out", "q_ref", "rad", 0);
  rig.set("columns", Text<256>("q"));
  rig.resource("file", path.c_str());
  const RigAnswer made = rig.init();
  ASSERT_TRUE(made) << made.text;
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle(microseconds(500)));  // halfway between rows
  for (int k = 0; k < 500; ++k) {
    EXPECT_NEAR(value(0), std::sin(0.01 * k), 1e-14);
    EXPECT_EQ(value(1), k);
    ASSERT_TRUE(rig.cycle());
  }
}

TEST_F(CsvPlayerTest, FindsItsColumnsByNameInAnyOrder) {
  ASSERT_TRUE(read("t(s),tau(N.m),q[1](rad),lost,q[0](rad)\n0,5,2,0,1\n"));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(value(0), 1);
  EXPECT_EQ(value(1), 2);
}

TEST_F(CsvPlayerTest, RefusesOtherNamesAndUnits) {
  const auto refusal = [&](const std::string& text) { return read(text).text; };
  EXPECT_EQ(refusal("t(s),qd[0](rad/s),qd[1](rad/s)\n0,1,2\n"),
            path + ":1: has no column 'q[0]': name the recorded variable with the constant `columns`");
  EXPECT_EQ(refusal("t(s),q[0](deg),q[1](deg)\n0,1,2\n"), path + ":1: 'q[0]' is in deg, and the output takes rad");
  EXPECT_EQ(refusal("t(s),q[0],q[1],q[0]\n0,1,2,1\n"), path + ":1: has 'q[0]' twice");
  EXPECT_EQ(refusal("t(ms),q[0],q[1]\n0,1,2\n"),
            path + ":1: the first column is 't(ms)', expected 't(s)', the time in s");
  rig.set("columns", Text<256>("qd tau"));
  EXPECT_EQ(refusal("t(s),qd[0](rad/s),qd[1](rad/s)\n0,1,2\n"), "`columns` has 2 names, and there are 1 outputs");
}

TEST_F(CsvPlayerTest, RefusesForeignFilesWithTheCause) {
  const auto refusal = [&](const std::string& text) { return read(text).text; };
  EXPECT_EQ(refusal("0,1,2\n1,1,2\n"),
            path + ":1: is a row of numbers: the first line is a head, such as t(s),q[0](rad)");
  EXPECT_EQ(refusal("t;q[0];q[1]\n0;0,5;1\n"),
            path + ":1: has ';' between its fields: write ',' there, and a decimal point in numbers");
  EXPECT_EQ(refusal("t,q[0],q[1]\n0 , 1, 2\n"), path + ":2: has a blank: write no blank beside a comma or in a field");
  EXPECT_EQ(refusal("t,q[0],q[1]\n0,1,2\n# end\n"),
            path + ":3: is a comment: a recording has none, so remove the line");
  EXPECT_TRUE(read("\xEF\xBB\xBFt(s),q[0](rad),q[1](rad)\r\n0,1,2\r\n"));
}

TEST_F(CsvPlayerTest, RefusesWithFileAndLine) {
  const auto refusal = [&](const std::string& rows) { return read("t,q[0],q[1]\n" + rows).text; };
  EXPECT_EQ(refusal(""), path + ": there is no row in it");
  EXPECT_EQ(read("").text, path + ": there is no row in it");
  EXPECT_EQ(refusal("0,1,2\n0,1,2\n"), path + ":3: the time does not grow");
  EXPECT_EQ(refusal("0,1,x\n"), path + ":2: a field is not a finite number");
  EXPECT_EQ(refusal("0,1,nan\n"), path + ":2: a field is not a finite number");
  EXPECT_EQ(refusal("0,1,\n"), path + ":2: a field of the first row is empty");
  EXPECT_EQ(refusal("0,1\n"), path + ":2: has fewer fields than the first line");
  EXPECT_EQ(refusal("0,1,2,3\n"), path + ":2: has more fields than the first line; numbers have a decimal point");
  EXPECT_EQ(refusal("x,1,2\n"), path + ":2: the time is not a finite number");
  rig.resource("file", "no_such.csv");
  EXPECT_EQ(rig.init().text, "no_such.csv: cannot be read");
}

}  // namespace
}  // namespace chimera
