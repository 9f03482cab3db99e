// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct CsvLogTest : ::testing::Test {
  Rig rig{"csv_log"};
  std::string path = testing::TempDir() + "csv_log_" + std::to_string(::getpid()) + ".csv";

  ~CsvLogTest() override {
    for (const std::string& each : {path, second()}) ::unlink(each.c_str());
  }
  std::string second() const { return path.substr(0, path.rfind('.')) + ".2.csv"; }

  void start(std::int32_t capacity, std::uint32_t instances = 2) {
    rig.instances("in", instances);
    rig.extent("n", 2);
    rig.set("capacity", capacity);
    rig.resource("file", path.c_str());
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  // Ends the task as the framework does: a last background, then kill.
  RigAnswer end() {
    EXPECT_TRUE(rig.background());
    return rig.kill();
  }
  std::int64_t rows() { return rig.get<std::int64_t>("rows"); }
  std::int64_t lost() { return rig.get<std::int64_t>("lost"); }
  std::int32_t disk_error() { return rig.get<std::int32_t>("disk_error"); }
  std::string text() const { return text_of(path); }
  static std::string text_of(const std::string& file) {
    std::ostringstream all;
    all << std::ifstream(file).rdbuf();
    return all.str();
  }
  // Counts the rows of the file. Each must have five columns.
  std::int64_t rows_in_file() const {
    std::istringstream all(text());
    std::string line;
    std::int64_t n = -1;
    while (std::getline(all, line)) {
      EXPECT_EQ(std::count(line.begin(), line.end(), ','), 4) << line;
      ++n;
    }
    return n;
  }
};

TEST_F(CsvLogTest, WritesARowForEachCycleBesideTheCycles) {
  start(10);
  rig.set("in", 1.5, 0, 0);
  rig.set("in", -2.0, 1, 0);
  ASSERT_TRUE(rig.cycle());
  rig.set("in", 0.1, 0, 1);
  rig.set("in", 1e20, 1, 1);
  EXPECT_EQ(text(), "");  // a cycle does not write to the disk
  ASSERT_TRUE(rig.background());
  EXPECT_EQ(text(), "t(s),in[0][0],in[0][1],in[1][0],in[1][1]\n0.001,1.5,-2,,\n");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rows(), 2);
  ASSERT_TRUE(end());
  EXPECT_EQ(text(), "t(s),in[0][0],in[0][1],in[1][0],in[1][1]\n"
                    "0.001,1.5,-2,,\n"
                    "0.002,1.5,-2,0.1,1e+20\n");
}

TEST_F(CsvLogTest, CountsTheRowsThatFindNoRoomAndGoesOnWhenThereIsSome) {
  start(2);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rows(), 2);
  EXPECT_EQ(lost(), 3);
  ASSERT_TRUE(rig.background());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rows(), 3);
  EXPECT_EQ(lost(), 3);
  EXPECT_EQ(end().text, "the file lacks rows: 3 rows found no room, the disk did not take them in time");
  EXPECT_EQ(text(), "t(s),in[0][0],in[0][1],in[1][0],in[1][1]\n0.001,,,,\n0.002,,,,\n0.006,,,,\n");
}

TEST_F(CsvLogTest, NamesAScalarByItsNumberAndAMatrixRowByRow) {
  const auto written = [this](std::uint32_t rows, std::uint32_t columns) {
    Rig log("csv_log");
    log.shape("n", rows, columns);
    log.instances("in", 1);
    log.set("capacity", std::int32_t{10});
    log.resource("file", path.c_str());
    for (std::uint32_t i = 0; i < rows * columns; ++i) log.set("in", 10.0 + i, i);
    EXPECT_TRUE(log.init() && log.on() && log.cycle() && log.background() && log.kill());
    const std::string made = text();
    ::unlink(path.c_str());
    return made;
  };
  EXPECT_EQ(written(1, 1), "t(s),in[0]\n0.001,10\n");
  EXPECT_EQ(written(2, 3), "t(s),in[0][0][0],in[0][0][1],in[0][0][2],in[0][1][0],in[0][1][1],in[0][1][2]\n"
                           "0.001,10,11,12,13,14,15\n");
}

TEST_F(CsvLogTest, RefusesRowsThatNoMemoryIsMeantFor) {
  rig.shape("n", 8, 8);
  rig.instances("in", 16);
  rig.set("capacity", std::int32_t{100'000});
  rig.resource("file", path.c_str());
  EXPECT_EQ(rig.init().text,
            "rows of 1025 values are 8200 bytes: at most 65472 of them may wait, and capacity is 100000");
}

TEST_F(CsvLogTest, NeverChangesAnEarlierRecording) {
  start(10);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(end());
  const std::string before = text();
  EXPECT_TRUE(rig.notes().empty());
  Rig again("csv_log");  // as after the death of the process, or `kill` and `spawn`
  again.instances("in", 1);
  again.extent("n", 2);
  again.resource("file", path.c_str());
  ASSERT_TRUE(again.init() && again.on() && again.cycle() && again.background() && again.kill());
  EXPECT_EQ(text(), before);
  EXPECT_EQ(text_of(second()), "t(s),in[0][0],in[0][1]\n0.001,,\n");
  ASSERT_EQ(again.notes().size(), 1u);
  EXPECT_NE(again.notes()[0].find(".2.csv: an earlier recording has the name"), std::string::npos);
}

TEST_F(CsvLogTest, TwoAtATimeHaveAFileEach) {
  start(10);
  Rig other("csv_log");
  other.instances("in", 1);
  other.extent("n", 1);
  other.resource("file", path.c_str());
  ASSERT_TRUE(other.init() && other.on() && other.cycle());
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(other.background() && other.kill());
  ASSERT_TRUE(end());
  EXPECT_EQ(text(), "t(s),in[0][0],in[0][1],in[1][0],in[1][1]\n0.001,,,,\n");
  EXPECT_EQ(text_of(second()), "t(s),in[0]\n0.001,\n");
}

TEST_F(CsvLogTest, GoesOnInTheSameFileAfterItWasOff) {
  start(10);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(end());
  EXPECT_EQ(text(), "t(s),in[0][0],in[0][1],in[1][0],in[1][1]\n0.001,,,,\n0.002,,,,\n");
}

TEST_F(CsvLogTest, RefusesAFileThatCannotBeWrittenAndNothingToLog) {
  path = "/no/such/folder/log.csv";
  rig.instances("in", 1);
  rig.resource("file", path.c_str());
  EXPECT_EQ(rig.init().text, "/no/such/folder/log.csv: No such file or directory");
  rig.instances("in", 0);
  EXPECT_EQ(rig.init().text, "there is nothing to log: name at least one input");
}

TEST_F(CsvLogTest, AFullDiskCostsRowsAndNoCycleAndKillSaysHowMany) {
  path = "/dev/full";
  start(10);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(disk_error(), 0);
  ASSERT_TRUE(rig.background());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(disk_error(), ENOSPC);
  EXPECT_EQ(rows(), 10);
  EXPECT_EQ(lost(), 14);
  const RigAnswer killed = end();
  EXPECT_EQ(killed.text, "10 rows were not written: No space left on device; before them 14 rows found no room");
  EXPECT_EQ(killed.code, ENOSPC);
  path = "";
}

TEST_F(CsvLogTest, ReportsARefusingDiskAndLostRowsAtOnceAndOnce) {
  path = "/dev/full";
  start(10);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.background());
  EXPECT_TRUE(rig.notes().empty());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.notes(), (std::vector<std::string>{
                             "the disk refuses rows: No space left on device; 10 may wait",
                             "rows are lost from t = 0.011 s on: No space left on device"}));
  (void)end();
  path = "";
}

TEST_F(CsvLogTest, NamesItsColumnsByVariableElementAndUnit) {
  Rig log("csv_log");
  log.shape("n", 1, 2);
  log.instances("in", 3);
  log.joined("in", "q", "rad", 0);
  log.joined("in", "speed", "m s-1", 1);
  log.joined("in", "ratio", "1", 2);
  log.set("capacity", std::int32_t{10});
  log.resource("file", path.c_str());
  ASSERT_TRUE(log.init() && log.background() && log.kill());
  EXPECT_EQ(text(), "t(s),q[0][0](rad),q[0][1](rad),speed[0][0](m.s-1),speed[0][1](m.s-1),ratio[0][0],ratio[0][1]\n");
}

TEST_F(CsvLogTest, ReportsAWriteErrorOfTheDisk) {
  path = "/proc/self/mem";  // no memory is mapped at its start, so a write fails with EIO
  start(10);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.background());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(disk_error(), EIO);
  EXPECT_EQ(end().text, "2 rows were not written: Input/output error");
  path = "";
}

// A file size limit stops a write within a row, as a full disk does, and can be lifted.
TEST_F(CsvLogTest, ADiskThatHasRoomAgainGetsEveryRowThatWasKeptWhole) {
  start(50);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{.rlim_cur = 500, .rlim_max = before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  std::int64_t cycles = 0;
  for (; cycles < 200; ++cycles) {
    ASSERT_TRUE(rig.cycle());
    if (cycles % 10 == 9) (void)rig.background();
  }
  EXPECT_EQ(disk_error(), EFBIG);
  EXPECT_GT(lost(), 0);
  EXPECT_EQ(rows() + lost(), cycles);
  EXPECT_EQ(text().back(), '\n') << "no cut row, however long the disk is full";
  EXPECT_GT(text().size(), 480u);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  const std::int64_t lost_by_then = lost();
  ASSERT_TRUE(rig.background());
  for (; cycles < 230; ++cycles) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(disk_error(), 0);
  EXPECT_EQ(lost(), lost_by_then);
  EXPECT_EQ(end().text, "the file lacks rows: " + std::to_string(lost()) +
                            " rows found no room, the disk did not take them in time");
  EXPECT_EQ(rows_in_file(), rows());
  EXPECT_EQ(rows() + lost(), cycles);
}

// A pipe without a reader blocks the writer. The cycles run on, here as fast as possible.
TEST_F(CsvLogTest, AStalledDiskHoldsUpNoCycleAndEveryRowIsWrittenOrCounted) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reading = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  start(1000);
  std::atomic<bool> ending{false};
  std::thread disk([&] {
    while (!ending) (void)rig.background();
  });
  constexpr std::int64_t kCycles = 200'000;
  for (std::int64_t i = 0; i < kCycles; ++i) (void)rig.cycle();
  EXPECT_GT(lost(), 0);
  EXPECT_EQ(rows() + lost(), kCycles);
  std::int64_t lines = 0;
  std::atomic<bool> is_over{false};
  std::thread reader([&] {
    char bytes[4096];
    for (;;) {
      const bool last = is_over;
      const ssize_t n = ::read(reading, bytes, sizeof bytes);
      if (n > 0) lines += std::count(bytes, bytes + n, '\n');
      else if (last) return;
    }
  });
  ending = true;
  disk.join();
  EXPECT_NE(end().text.find("the file lacks rows: "), std::string::npos);
  is_over = true;
  reader.join();
  ::close(reading);
  EXPECT_EQ(lines - 1, rows());
}

}  // namespace
}  // namespace chimera
