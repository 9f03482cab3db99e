// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/run_log.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/base/testing/await.h"
#include "chimera/platform/file.h"

namespace chimera::cli {
namespace {

struct RunLogTest : ::testing::Test {
  RunLogTest() {
    EXPECT_NE(::mkdtemp(place), nullptr);
    ::setenv("TZ", "UTC", 1);
    ::tzset();
  }
  ~RunLogTest() override { std::filesystem::remove_all(place); }
  std::string path() const { return std::string(place) + "/run.log"; }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(path(), std::ios::binary).rdbuf();
    return all.str();
  }
  static Json event(int number) {
    return {{"number", number}, {"at_ns", 5}, {"wall_ns", std::int64_t{1'700'000'000} * 1'000'000'000}, {"kind", "set"},
            {"text", "kp = 2\x1b[2J"}, {"by", "operate:ann"}};
  }

  char place[40] = "/tmp/chimera_log_XXXXXX";
};

constexpr const char* kRest = "  2023-11-14 22:13:20.000  set              kp = 2 [2J, by operate:ann\n";

TEST_F(RunLogTest, AddsEachEventOnceBehindTheLinesOfBefore) {
  std::ofstream(path()) << "of before\nand a cut li";
  RunLog log(path(), *open_to_append(path()));
  for (const int number : {1, 2, 2, 1, 3}) log.add(event(number));
  EXPECT_EQ(log.finish(kHangLimit), "");
  EXPECT_EQ(text(), std::string("of before\nand a cut li\n     1") + kRest + "     2" + kRest + "     3" + kRest);
}

TEST_F(RunLogTest, AFileThatCannotBeWrittenIsRefused) {
  EXPECT_EQ(open_to_append(place).error().message.view(), "cannot be opened: Is a directory");
  EXPECT_EQ(open_to_append("/dev/null").error().message.view(), "is no ordinary file");
  EXPECT_EQ(open_to_append(path() + "/x").error().message.view(), "cannot be opened: No such file or directory");
}

// A limit of the file size stands for a full disk: it, too, writes a part of a line.
TEST_F(RunLogTest, AFullDiskIsReportedOnceAndLeavesWholeLines) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  const std::string line = std::string("     1") + kRest;
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit full{2 * line.size() + 7, limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  RunLog log(path(), *open_to_append(path()));
  for (int number = 1; number <= 5; ++number) log.add(event(number));
  const std::string loss = log.finish(kHangLimit);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(loss, path() + ": events are lost: File too large");
  EXPECT_EQ(text(), line + "     2" + kRest);
  std::FILE* const said = std::tmpfile();
  log.report_loss(said);
  log.report_loss(said);
  EXPECT_EQ(std::ftell(said), static_cast<long>((loss + "; the run goes on, and its exit code is 1\n").size()));
  std::fclose(said);
}

}  // namespace
}  // namespace chimera::cli
