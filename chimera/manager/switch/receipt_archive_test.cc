// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/switch/receipt_archive.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "chimera/base/testing/await.h"
#include "chimera/control/rotated_file.h"
#include "chimera/manager/testing/lone_state.h"
#include "chimera/platform/file.h"

namespace chimera::manager {
namespace {

struct ReceiptArchiveTest : ::testing::Test {
  ReceiptArchiveTest() {
    EXPECT_NE(::mkdtemp(place), nullptr);
    begin(folder());
  }
  ~ReceiptArchiveTest() override {
    archive.reset();
    std::filesystem::remove_all(place);
  }
  std::string folder() const { return std::string(place) + "/drive"; }
  void begin(const std::string& where) {
    auto started = ReceiptArchive::start(lone.state(), where);
    ASSERT_TRUE(started);
    archive = *std::move(started);
  }
  static std::string receipt(std::uint32_t number) {
    return "{\"number\": " + std::to_string(number) + ", \"origin_ns\": 7, \"to\": \"a\"}";
  }
  void add(std::uint32_t number) {
    archive->add(number, receipt(number), now(), [this, number] { answered += std::to_string(number) + " "; });
  }
  bool until(const std::function<bool()>& holds) {
    return await_that([&] { return archive->look(now()), holds(); });
  }
  std::string path() const { return control::RotatedFile(folder(), "receipts").path(); }
  std::vector<std::string> filed() const { return control::RotatedFile(folder(), "receipts").last(1000); }
  SwitchJournal journal() { return SwitchJournal(lone.state().own.block().journal()); }

  char place[40] = "/tmp/chimera_archive_XXXXXX";
  LoneState lone;
  std::unique_ptr<ReceiptArchive> archive;
  std::string answered;
};

TEST_F(ReceiptArchiveTest, AnAnswerWaitsForTheDisk) {
  add(1);
  EXPECT_EQ(answered, "");
  ASSERT_TRUE(until([this] { return archive->unfiled() == 0; }));
  EXPECT_EQ(answered, "1 ");
  EXPECT_EQ(filed(), std::vector<std::string>{receipt(1)});
  EXPECT_TRUE(journal().unfiled().empty());
  EXPECT_EQ(journal().next(), 2u);
  add(2);
  add(3);
  ASSERT_TRUE(until([this] { return archive->unfiled() == 0; }));
  EXPECT_EQ(answered, "1 2 3 ");
  EXPECT_EQ(filed().size(), 3u);
  EXPECT_EQ(archive->kept().size(), 3u);
}

// Another process holds the lock: the writer waits, as for a stalled disk.
TEST_F(ReceiptArchiveTest, AStalledDiskIsWaitedForATenthOfASecond) {
  std::filesystem::create_directories(folder());
  std::optional<Result<LineFile>> lock(LineFile::open(path()));
  const Nanoseconds at = now();
  archive->add(1, receipt(1), at, [this] { answered += "1 "; });
  archive->look(at + ReceiptArchive::kDiskLimit - milliseconds(1));
  EXPECT_EQ(answered, "");
  EXPECT_LE(archive->next_due(), at + ReceiptArchive::kDiskLimit);
  archive->look(at + ReceiptArchive::kDiskLimit);
  EXPECT_EQ(answered, "1 ");
  EXPECT_EQ(archive->unfiled(), 1u);
  lock.reset();
  ASSERT_TRUE(until([this] { return archive->unfiled() == 0; }));
  EXPECT_EQ(filed().size(), 1u);
}

TEST_F(ReceiptArchiveTest, KeepsAReceiptThatCannotBeFiledAndTriesAgain) {
  std::filesystem::create_directories(path());  // a folder in the place of the file
  add(1);
  ASSERT_TRUE(until([this] { return archive->fault() != ""; }));
  EXPECT_EQ(answered, "1 ") << "a switch does not wait for a failing disk";
  EXPECT_EQ(archive->fault(), archive->path() + ": cannot be opened: Is a directory");
  EXPECT_EQ(archive->unfiled(), 1u);
  EXPECT_EQ(journal().unfiled().size(), 1u);
  add(2);
  ASSERT_TRUE(until([this] { return answered == "1 2 "; }));
  EXPECT_EQ(lone.told(), "note: receipts are not filed: " + archive->path() +
                             ": cannot be opened: Is a directory; they are kept and tried again\n")
      << "reported once";
  std::filesystem::remove(archive->path());
  ASSERT_TRUE(until([this] {
    archive->look(now() + Filing::kTryAgain + seconds(1));
    return archive->unfiled() == 0;
  }));
  EXPECT_EQ(filed(), (std::vector<std::string>{receipt(1), receipt(2)}));
  EXPECT_TRUE(lone.told().ends_with("note: receipts are filed again\n"));
  EXPECT_EQ(archive->fault(), "");
}

// The manager was killed between the file and the journal: the successor has both in its journal, and one of them in
// the file.
TEST_F(ReceiptArchiveTest, FilesReceiptsOfAPredecessorOnce) {
  archive.reset();
  ASSERT_TRUE(journal().put(1, receipt(1)));
  ASSERT_TRUE(journal().put(2, receipt(2)));
  ASSERT_TRUE(control::RotatedFile(folder(), "receipts").file({receipt(1)}));
  begin(folder());
  EXPECT_EQ(archive->unfiled(), 2u);
  ASSERT_TRUE(until([this] { return archive->unfiled() == 0; }));
  EXPECT_EQ(filed(), (std::vector<std::string>{receipt(1), receipt(2)}));
  EXPECT_EQ(archive->kept(), (std::deque<std::string>{receipt(1), receipt(2)}));
}

TEST_F(ReceiptArchiveTest, WithoutRoomTheOldestReceiptIsLostAndReported) {
  std::filesystem::create_directories(path());
  add(1);
  ASSERT_TRUE(until([&] { return archive->fault() != ""; }));
  const auto most = static_cast<std::uint32_t>(Filing::kMostUnfiled);
  for (std::uint32_t number = 2; number <= 2 * most + 2; ++number) add(number);
  EXPECT_LE(archive->unfiled(), 2 * most);
  EXPECT_NE(lone.told().find("note: receipts are lost from number "), std::string::npos) << lone.told();
}

TEST_F(ReceiptArchiveTest, FlushFilesTheRemainingReceipts) {
  add(1);
  add(2);
  archive->filing().flush(kHangLimit);
  EXPECT_EQ(filed().size(), 2u);
}

TEST_F(ReceiptArchiveTest, WithoutAFolderNothingWaits) {
  begin("");
  add(1);
  add(2);
  EXPECT_EQ(answered, "1 2 ");
  EXPECT_EQ(lone.told(),
            "note: receipts are not filed: neither XDG_STATE_HOME nor HOME names a folder for them\n");
  EXPECT_EQ(archive->kept().size(), 2u);
  EXPECT_EQ(archive->path(), "");
  EXPECT_EQ(archive->descriptor(), -1);
}

}  // namespace
}  // namespace chimera::manager
