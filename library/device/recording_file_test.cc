// SPDX-License-Identifier: Apache-2.0
#include "library/device/recording_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace chimera::library {
namespace {

struct OpenRecording : ::testing::Test {
  std::filesystem::path folder = testing::TempDir() + "recording_" + std::to_string(::getpid());
  std::string path = folder / "arm.csv";

  OpenRecording() { std::filesystem::create_directory(folder); }
  ~OpenRecording() override { std::filesystem::remove_all(folder); }
};

TEST(NumberedPath, PutsTheNumberBeforeTheExtension) {
  EXPECT_EQ(numbered_path("arm.csv", 2), "arm.2.csv");
  EXPECT_EQ(numbered_path("/log.d/arm", 3), "/log.d/arm.3");
  EXPECT_EQ(numbered_path("/log.d/.arm", 3), "/log.d/.arm.3");
  EXPECT_EQ(numbered_path("a.b.csv", 12), "a.b.12.csv");
}

TEST_F(OpenRecording, LeavesEveryEarlierRecordingAsItIs) {
  for (int i = 0; i < 12; ++i) {
    const RecordingFile made = open_recording(path);
    EXPECT_EQ(made.path, i == 0 ? path : numbered_path(path, i + 1));
    EXPECT_EQ(::write(made.file, &"abcdefghijkl"[i], 1), 1);
    ::close(made.file);
  }
  for (int i = 0; i < 12; ++i) {
    std::ifstream file(i == 0 ? path : numbered_path(path, i + 1));
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), std::string(1, "abcdefghijkl"[i]));
  }
}

TEST_F(OpenRecording, GivesEachOpenRecordingItsOwnFileBeforeTheFirstByte) {
  std::set<std::string> paths;
  std::vector<int> files;
  for (int i = 0; i < 5; ++i) {
    const RecordingFile made = open_recording(path);
    paths.insert(made.path);
    files.push_back(made.file);
  }
  EXPECT_EQ(paths.size(), 5u);
  for (const int file : files) ::close(file);
  const RecordingFile again = open_recording(path);
  EXPECT_EQ(again.path, path) << "empty and no longer locked";
  ::close(again.file);
}

TEST_F(OpenRecording, TakesADeviceAsItIs) {
  for (int i = 0; i < 2; ++i) {
    const RecordingFile made = open_recording("/dev/null");
    EXPECT_EQ(made.path, "/dev/null");
    ::close(made.file);
  }
}

TEST(OtherPathNote, NamesTheFileOnlyIfItIsAnother) {
  EXPECT_EQ(other_path_note("arm.csv", "arm.csv"), "");
  EXPECT_EQ(other_path_note("arm.csv", "arm.2.csv"), "records to arm.2.csv: an earlier recording has the name");
  EXPECT_LT(other_path_note("a", std::string(500, 'x')).size(), 160u);
}

}  // namespace
}  // namespace chimera::library
