// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/page_draft.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace chimera::web {
namespace {

FileNow there(const std::string& text) { return {true, text, ""}; }
FileNow broken() { return {true, "", "cannot be read"}; }
const FileNow kNone;

TEST(PageDraft, BeginsAsFileAndFollowsItUntouched) {
  PageDraft draft(there("a"));
  EXPECT_EQ(draft.text(), "a");
  EXPECT_EQ(draft.version(), 1u);
  EXPECT_FALSE(draft.is_touched());
  draft.see(there("b"));
  EXPECT_EQ(draft.text(), "b");
  EXPECT_EQ(draft.version(), 2u);
  EXPECT_FALSE(draft.is_touched());
  draft.see(there("b"));
  EXPECT_EQ(draft.version(), 2u);
  EXPECT_EQ(draft.to_keep(), std::nullopt);
}

TEST(PageDraft, TouchedStaysWhenAnotherProgramChangesFile) {
  PageDraft draft(there("a"));
  draft.change("mine");
  EXPECT_TRUE(draft.is_touched());
  EXPECT_FALSE(draft.is_outside());
  EXPECT_EQ(draft.to_keep(), (KeptText{"mine", "a"}));
  draft.see(there("theirs"));
  EXPECT_EQ(draft.text(), "mine");
  EXPECT_TRUE(draft.is_outside());
  draft.see(there("a"));
  EXPECT_FALSE(draft.is_outside()) << "the other program took its change back";
  draft.see(there("mine"));
  EXPECT_FALSE(draft.is_touched());
  draft.see(there("next"));
  EXPECT_EQ(draft.text(), "next") << "it is not own any more";
}

TEST(PageDraft, APersonSettlesAChangeFromOutside) {
  PageDraft draft(there("a"));
  draft.change("mine");
  draft.see(there("theirs"));
  draft.keep_draft();
  EXPECT_FALSE(draft.is_outside());
  EXPECT_EQ(draft.to_keep(), (KeptText{"mine", "theirs"}));
  draft.see(there("theirs again"));
  EXPECT_TRUE(draft.is_outside());
  draft.keep_file();
  EXPECT_EQ(draft.text(), "theirs again");
  EXPECT_FALSE(draft.is_touched());
  EXPECT_EQ(draft.version(), 3u);
}

TEST(PageDraft, KeepsItsTextWhenFileGoesOrCannotBeRead) {
  for (const FileNow& gone : {kNone, broken(), there("")}) {
    PageDraft draft(there("a"));
    draft.see(gone);
    EXPECT_EQ(draft.text(), "a");
    EXPECT_TRUE(draft.is_touched());
    EXPECT_FALSE(draft.is_outside());
    ASSERT_TRUE(draft.to_keep());
    draft.see(there("b"));
    EXPECT_EQ(draft.text(), "b") << "no person changed the draft";
  }
}

TEST(PageDraft, WithoutFileItIsEmptyAndFollowsAFileThatComes) {
  PageDraft draft(kNone);
  EXPECT_FALSE(draft.is_touched());
  draft.change("mine");
  EXPECT_TRUE(draft.is_touched());
  EXPECT_FALSE(draft.is_outside());
  EXPECT_EQ(draft.to_keep(), (KeptText{"mine", std::nullopt}));
  draft.see(there("theirs"));
  EXPECT_TRUE(draft.is_outside());
  PageDraft other(kNone);
  other.see(there("theirs"));
  EXPECT_EQ(other.text(), "theirs");
}

TEST(PageDraft, GoesOnWithAKeptTextAndNoticesAChangeInBetween) {
  EXPECT_FALSE(PageDraft(there("a"), KeptText{"mine", "a"}).is_outside());
  EXPECT_TRUE(PageDraft(there("theirs"), KeptText{"mine", "a"}).is_outside());
  EXPECT_TRUE(PageDraft(kNone, KeptText{"mine", "a"}).is_outside());
  EXPECT_FALSE(PageDraft(kNone, KeptText{"mine", std::nullopt}).is_outside());
  EXPECT_FALSE(PageDraft(there("mine"), KeptText{"mine", "a"}).is_touched());
}

/// The disk, another program, a person, and a process that may be killed at any time.
struct Story {
  FileNow file = there("0");
  std::optional<KeptText> kept;
  std::optional<PageDraft> draft{PageDraft(there("0"))};
  std::string mine;                    // the last text of the person, until the person or another program replaces it
  std::set<std::string> shown = {"0", ""};  // texts of FILE that the draft had, or that the person decided about
  int number = 0;

  void edit() { draft->change(mine = "person " + std::to_string(++number)); }
  void replace_outside(FileNow by) {
    if (file.is_read() && file.text == mine) mine.clear();  // it was written, so it is the other program's to replace
    file = std::move(by);
  }
  void keep() { kept = draft->to_keep(); }
  void see() {
    draft->see(file);
    if (!draft->is_touched()) shown.insert(file.text);
  }
  void write() {
    see();
    if (!file.problem.empty() || draft->is_outside() || !draft->is_touched()) return;
    EXPECT_TRUE(shown.contains(file.text)) << "overwritten unseen: " << file.text;
    file = there(draft->text());
    draft->written();
    keep();
    shown.insert(file.text);
  }
  void settle(bool take_file) {
    see();
    if (!file.problem.empty()) return;
    if (take_file && file.is_read()) {
      draft->keep_file();
      mine.clear();
    } else {
      draft->keep_draft();
    }
    shown.insert(file.text);
  }
  void kill() {
    if (!mine.empty() && draft->text() == mine && draft->to_keep() != kept) mine.clear();  // within 300 ms of the edit
    draft.emplace(file, kept);
    if (!draft->is_touched()) shown.insert(file.text);
  }
  bool has_mine() const {
    return mine.empty() || draft->text() == mine || (file.is_read() && file.text == mine) ||
           (kept && kept->text == mine);
  }
};

TEST(PageDraft, LosesNoTextOfAPersonAndOverwritesNoneUnseenInAnyOrderOfEvents) {
  int n_outside = 0, n_written = 0;
  for (std::uint32_t seed = 0; seed < 5000; ++seed) {
    std::mt19937 random(seed);
    Story story;
    std::string order;
    for (int step = 0; step < 14; ++step) {
      const auto event = static_cast<std::size_t>(random() % 10);
      order += "eoubgskwdfx"[event];
      const std::string other = "other " + std::to_string(++story.number);
      const std::string before = story.file.text;
      switch (event) {
        case 0: story.edit(); break;
        case 1: story.replace_outside(there(other)); break;
        case 2: story.replace_outside(random() % 2 == 0 ? there("0") : there("")); break;
        case 3: story.replace_outside(broken()); break;
        case 4: story.replace_outside(kNone); break;
        case 5: story.see(); break;
        case 6: story.keep(); break;
        case 7: story.write(); break;
        case 8: story.settle(random() % 2 == 0); break;
        default: story.kill(); break;
      }
      n_outside += story.draft->is_outside();
      n_written += event == 7 && story.file.text != before;
      ASSERT_TRUE(story.has_mine()) << seed << " " << order << ": " << story.mine;
      ASSERT_TRUE(!story.draft->is_outside() || story.draft->is_touched()) << seed << " " << order;
      if (::testing::Test::HasFailure()) FAIL() << seed << " " << order;
    }
  }
  EXPECT_GT(n_outside, 1000);
  EXPECT_GT(n_written, 1000);
}

}  // namespace
}  // namespace chimera::web
