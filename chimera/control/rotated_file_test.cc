// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/rotated_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace chimera::control {
namespace {

using Lines = std::vector<std::string>;

struct ReceiptFile : RotatedFile {
  explicit ReceiptFile(const std::string& folder, std::uint64_t most = kMostBytes)
      : RotatedFile(folder, "receipts", most) {}
};

struct RotatedFileTest : ::testing::Test {
  RotatedFileTest() { EXPECT_NE(::mkdtemp(place), nullptr); }
  ~RotatedFileTest() override { std::filesystem::remove_all(place); }
  std::string folder() const { return std::string(place) + "/chimera/drive"; }
  static std::string receipt(int number, int run = 7, const std::string& more = "") {
    return "{\"number\": " + std::to_string(number) + ", \"origin_ns\": " + std::to_string(run) + ", \"to\": \"a" +
           more + "\"}";
  }
  static std::string text_of(const std::string& path) {
    std::ostringstream all;
    all << std::ifstream(path, std::ios::binary).rdbuf();
    return all.str();
  }

  char place[40] = "/tmp/chimera_receipts_XXXXXX";
};

TEST_F(RotatedFileTest, EachIsALineBehindTheOthersInAFolderThatIsMade) {
  ReceiptFile file(folder());
  EXPECT_EQ(file.last(10), Lines());
  ASSERT_TRUE(file.file({receipt(1)}));
  ASSERT_TRUE(file.file({receipt(2), receipt(3)}));
  EXPECT_EQ(text_of(file.path()), receipt(1) + "\n" + receipt(2) + "\n" + receipt(3) + "\n");
  EXPECT_EQ(file.last(10), (Lines{receipt(1), receipt(2), receipt(3)}));
  EXPECT_EQ(file.last(2), (Lines{receipt(2), receipt(3)}));
  EXPECT_EQ(file.last(0), Lines());
}

TEST_F(RotatedFileTest, NumberAndRunTellReceiptsApart) {
  EXPECT_EQ(line_key(receipt(1)), "{\"number\": 1, \"origin_ns\": 7, ");
  EXPECT_EQ(line_key("{}"), "{}");
  EXPECT_EQ(line_key(""), "");
  EXPECT_EQ(line_key("{\"number\": 1, \"origin_ns\": 7}"), "{\"number\": 1, \"origin_ns\": 7}");
}

// A successor files what its predecessor may have filed, and may collect it with other times.
TEST_F(RotatedFileTest, AReceiptInTheFileIsNotFiledAgain) {
  ASSERT_TRUE(ReceiptFile(folder()).file({receipt(1), receipt(12)}));
  ReceiptFile successor(folder());
  ASSERT_TRUE(successor.file({receipt(1, 7, "gain"), receipt(2), receipt(12), receipt(1, 77)}));
  EXPECT_EQ(successor.last(10), (Lines{receipt(1), receipt(12), receipt(2), receipt(1, 77)}));
}

TEST_F(RotatedFileTest, AReceiptThatWasCutOffIsFiledWhole) {
  ASSERT_TRUE(ReceiptFile(folder()).file({receipt(1)}));
  std::ofstream(ReceiptFile(folder()).path(), std::ios::app) << receipt(2).substr(0, 20);
  EXPECT_EQ(ReceiptFile(folder()).last(10), (Lines{receipt(1)}));
  ASSERT_TRUE(ReceiptFile(folder()).file({receipt(2)}));
  EXPECT_EQ(ReceiptFile(folder()).last(10), (Lines{receipt(1), receipt(2)}));
}

// The writer died, or the machine lost power, behind any byte of a line.
TEST_F(RotatedFileTest, ACutBehindAnyByteLeavesWholeLines) {
  ReceiptFile file(folder());
  const std::string line = receipt(2) + "\n";
  for (std::size_t bytes = 0; bytes <= line.size(); ++bytes) {
    std::filesystem::remove(file.path());
    ASSERT_TRUE(ReceiptFile(folder()).file({receipt(1)}));
    std::ofstream(file.path(), std::ios::app) << line.substr(0, bytes);
    const Lines whole = bytes == line.size() ? Lines{receipt(1), receipt(2)} : Lines{receipt(1)};
    EXPECT_EQ(file.last(10), whole) << bytes;
    ASSERT_TRUE(ReceiptFile(folder()).file({receipt(2), receipt(3)}));
    EXPECT_EQ(file.last(10), (Lines{receipt(1), receipt(2), receipt(3)})) << bytes;
  }
}

// Batches of any size by one manager after the other: the files stay within the bound, and no line is cut.
TEST_F(RotatedFileTest, BothFilesStayWithinTheBound) {
  constexpr std::uint64_t kMost = 2000;
  std::srand(1);
  int number = 0;
  for (int manager = 0; manager < 40; ++manager) {
    ReceiptFile file(folder(), kMost);
    for (int batch = 0; batch < 5; ++batch) {
      Lines lines;
      for (int i = std::rand() % 20; i > 0; --i)
        lines.push_back(receipt(++number, 7, std::string(static_cast<std::size_t>(std::rand() % 50), 'x')));
      ASSERT_TRUE(file.file(lines));
      EXPECT_LE(text_of(file.path()).size(), kMost);
      EXPECT_LE(text_of(file.path_before()).size(), kMost);
    }
    Lines all = file.last(10'000);
    for (int last = number; !all.empty(); all.pop_back(), --last)
      EXPECT_TRUE(all.back().starts_with("{\"number\": " + std::to_string(last) + ", ")) << all.back();
  }
}

TEST_F(RotatedFileTest, LinesOfOneRunAreReadAlone) {
  ReceiptFile file(folder());
  ASSERT_TRUE(file.file({receipt(1), receipt(2), receipt(1, 77), receipt(2, 77)}));
  EXPECT_EQ(file.last(10, "\"origin_ns\": 7, "), (Lines{receipt(1), receipt(2)}));
  EXPECT_EQ(file.last(1, "\"origin_ns\": 77, "), (Lines{receipt(2, 77)}));
}

TEST_F(RotatedFileTest, LinesThatAreNoReceiptAreSkipped) {
  ASSERT_TRUE(ReceiptFile(folder()).file({receipt(1)}));
  std::ofstream(ReceiptFile(folder()).path(), std::ios::app) << "hello\n{\"number\": 2, \n{}\n";
  EXPECT_EQ(ReceiptFile(folder()).last(10), (Lines{receipt(1)}));
}

TEST_F(RotatedFileTest, AFullFileIsRenamedOnceAndNothingIsFiledTwice) {
  const std::uint64_t two = 2 * (receipt(1).size() + 1);
  for (int number = 1; number <= 5; ++number)
    ASSERT_TRUE(ReceiptFile(folder(), two).file({receipt(number)})) << number;  // each as a new manager
  EXPECT_EQ(text_of(ReceiptFile(folder()).path()), receipt(5) + "\n");
  EXPECT_EQ(text_of(ReceiptFile(folder()).path_before()), receipt(3) + "\n" + receipt(4) + "\n");
  EXPECT_EQ(ReceiptFile(folder()).last(2), (Lines{receipt(4), receipt(5)}));
  ASSERT_TRUE(ReceiptFile(folder(), two).file({receipt(4), receipt(5)}));
  EXPECT_EQ(ReceiptFile(folder()).last(10), (Lines{receipt(3), receipt(4), receipt(5)}));
}

TEST_F(RotatedFileTest, NamesAFileThatCannotBeWrittenAndMayTryAgain) {
  ReceiptFile file(folder());
  ASSERT_TRUE(file.file({receipt(1)}));
  std::filesystem::rename(file.path(), file.path() + ".away");
  std::filesystem::create_directory(file.path());
  const auto refused = file.file({receipt(2)});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.view(), "cannot be opened: Is a directory");
  EXPECT_EQ(refused.error().where.view(), file.path());
  std::filesystem::remove(file.path());
  std::filesystem::rename(file.path() + ".away", file.path());
  ASSERT_TRUE(file.file({receipt(1), receipt(2)}));
  EXPECT_EQ(file.last(10), (Lines{receipt(1), receipt(2)}));
}

}  // namespace
}  // namespace chimera::control
