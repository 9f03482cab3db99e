// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/answer/event_archive.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "chimera/base/testing/await.h"
#include "chimera/control/rotated_file.h"
#include "chimera/manager/testing/lone_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

struct EventArchiveTest : ::testing::Test {
  EventArchiveTest() { EXPECT_NE(::mkdtemp(place), nullptr); }
  ~EventArchiveTest() override {
    archive.reset();
    std::filesystem::remove_all(place);
  }
  std::string folder() const { return std::string(place) + "/drive"; }
  control::RotatedFile file() const { return control::RotatedFile(folder(), "events"); }
  void begin(const std::string& where) {
    auto started = EventArchive::start(lone.state(), where);
    ASSERT_TRUE(started);
    archive = *std::move(started);
  }
  void tell(const std::string& text, TaskId task = {}) { lone.state().tell("signal", task, RtpuId{}, text, now()); }
  bool until(const std::function<bool()>& holds) {
    return await_that([&] { return archive->look(now()), holds(); });
  }
  bool until_filed() {
    return until([this] { return archive->filing().unfiled().empty(); });
  }

  char place[40] = "/tmp/chimera_events_XXXXXX";
  LoneState lone;
  std::unique_ptr<EventArchive> archive;
};

TEST_F(EventArchiveTest, EachEventIsALineWithItsAuthor) {
  begin(folder());
  {
    const Acting acting(lone.state(), "operate:ann");
    tell("on law", lone.task("law"));
  }
  tell("of no person");
  ASSERT_TRUE(until_filed());
  const std::vector<std::string> lines = file().last(10);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[0].starts_with("{\"number\": 1, \"origin_ns\": 0, \"at_ns\": ")) << lines[0];
  EXPECT_TRUE(lines[0].ends_with("\"text\": \"on law\", \"task\": \"law\", \"by\": \"operate:ann\"}")) << lines[0];
  EXPECT_TRUE(lines[1].ends_with("\"text\": \"of no person\"}")) << lines[1];
}

TEST_F(EventArchiveTest, RecallsEventsFromTheFileAndTheJournalAndReportsAGap) {
  const auto line = [](int number) {
    return "{\"number\": " + std::to_string(number) + ", \"origin_ns\": 0, \"at_ns\": 5, \"wall_ns\": 6, \"kind\": " +
           "\"set\", \"text\": \"kp\", \"rtpu\": \"spare\", \"by\": \"operate:ann\"}";
  };
  const std::string other = "{\"number\": 3, \"origin_ns\": 8, \"text\": \"of another run\"}";
  ASSERT_TRUE(file().file({other, line(1), line(3), line(4)}));
  lone.state().log = EventLog(5);  // a successor
  LineJournal journal(lone.state().own.block().event_journal());
  ASSERT_TRUE(journal.put(4, line(4)));  // killed between the file and the journal
  ASSERT_TRUE(journal.put(5, line(5)));
  begin(folder());
  tell("own");
  ASSERT_TRUE(until([this] { return lone.state().log.first() == 3; }));
  const LoggedEvent& event = lone.state().log.at(5);
  EXPECT_EQ(event.by, "operate:ann");
  EXPECT_EQ(event.kind, "set");
  EXPECT_EQ(event.rtpu, RtpuId(1u));
  EXPECT_FALSE(event.task.is_valid());
  EXPECT_EQ(event.at.count, 5);
  EXPECT_EQ(lone.told(5), "signal: own\nnote: events 1 to 2 are lost\n");
  ASSERT_TRUE(until_filed());
  EXPECT_EQ(file().last(10).size(), 7u) << "each once";
  EXPECT_TRUE(journal.unfiled().empty());
}

TEST_F(EventArchiveTest, AFullDiskIsReportedOnceAndLosesTheOldest) {
  std::filesystem::create_directories(file().path());  // a folder in the place of the file
  begin(folder());
  tell("first");
  ASSERT_TRUE(until([this] { return archive->filing().fault() != ""; }));
  const std::string path = file().path();
  EXPECT_EQ(lone.told(1), "note: events are not filed: " + path + ": cannot be opened: Is a directory; they are kept " +
                              "and tried again\n");
  for (int i = 0; i < 3000; ++i) tell("later");
  EXPECT_LE(archive->filing().unfiled().size(), 2 * Filing::kMostUnfiled);
  const std::string told = lone.told(1);
  const std::string lost = "note: events are lost from number 1 on: ";
  EXPECT_NE(told.find(lost), told.npos);
  EXPECT_EQ(told.find(lost), told.rfind(lost)) << "once";
  std::filesystem::remove(file().path());
  archive->filing().try_again(now());
  ASSERT_TRUE(until([this] { return file().last(1).size() == 1 && archive->filing().fault().empty(); }));
  EXPECT_NE(lone.told(3000).find("note: events are filed again, without "), told.npos) << lone.told(3000);
}

TEST_F(EventArchiveTest, WithoutAFolderItSaysSoOnce) {
  begin("");
  tell("first");
  tell("second");
  archive->look(now());
  EXPECT_EQ(lone.told(), "signal: first\n"
                         "note: events are not filed: neither XDG_STATE_HOME nor HOME names a folder for them\n"
                         "signal: second\n");
}

}  // namespace
}  // namespace chimera::manager
