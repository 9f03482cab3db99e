// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/switch_journal.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>
#include <string>

namespace chimera::manager {
namespace {

/// The journal of a block. A copy is the journal that a successor finds if the owner is killed now.
struct Memory {
  alignas(64) std::byte bytes[kJournalBytes] = {};

  SwitchJournal journal() { return SwitchJournal(bytes); }
  SwitchJournal::Pages& pages() { return *reinterpret_cast<SwitchJournal::Pages*>(bytes); }
};

struct SwitchJournalTest : ::testing::Test {
  /// The owner is killed now; from here on `memory` belongs to its successor.
  SwitchJournal successor() {
    auto next = std::make_unique<Memory>();
    next->journal().take_over(memory->bytes);
    memory = std::move(next);
    return memory->journal();
  }
  static std::string numbers(const SwitchJournal& journal) {
    std::string text;
    for (const auto& receipt : journal.unfiled())
      text += std::to_string(receipt.number) + ":" + std::string(receipt.text) + " ";
    return text;
  }
  static BegunSwitch switch_to(std::uint32_t set) {
    BegunSwitch begun;
    begun.order.after = set;
    begun.asked_by = {control::Role::kOperate, 1000};
    return begun;
  }

  std::unique_ptr<Memory> memory = std::make_unique<Memory>();
};

TEST_F(SwitchJournalTest, ZeroedMemoryIsAnEmptyJournal) {
  SwitchJournal journal = memory->journal();
  EXPECT_EQ(journal.next(), 1u);
  EXPECT_FALSE(journal.begun());
  EXPECT_EQ(numbers(journal), "");
  EXPECT_EQ(successor().next(), 1u);
}

TEST_F(SwitchJournalTest, ASwitchHasItsNumberUntilItsReceiptIsPut) {
  SwitchJournal journal = memory->journal();
  journal.begin(switch_to(3));
  EXPECT_EQ(journal.begun()->number, 1u);
  EXPECT_EQ(journal.next(), 2u);
  EXPECT_TRUE(journal.put(2, "refused during 1"));
  BegunSwitch changed = *journal.begun();
  changed.tries = 2;
  journal.change(changed);
  EXPECT_EQ(journal.begun()->tries, 2u);
  EXPECT_EQ(journal.begun()->number, 1u);
  SwitchJournal next = successor();
  EXPECT_EQ(next.begun()->tries, 2u);
  EXPECT_EQ(next.begun()->order.after, 3u);
  EXPECT_EQ(next.begun()->asked_by.user, 1000u);
  EXPECT_TRUE(next.put(1, "done"));
  EXPECT_FALSE(next.begun());
  EXPECT_EQ(next.next(), 3u);
  EXPECT_EQ(numbers(next), "2:refused during 1 1:done ");
}

TEST_F(SwitchJournalTest, AForgottenSwitchLeavesNoGap) {
  memory->journal().begin(switch_to(1));
  SwitchJournal next = successor();
  next.forget();
  EXPECT_FALSE(next.begun());
  EXPECT_EQ(next.next(), 1u);
  EXPECT_EQ(successor().next(), 1u);
}

TEST_F(SwitchJournalTest, AFiledReceiptFreesItsRoomAndIsNotHandedOn) {
  SwitchJournal journal = memory->journal();
  const std::string half(60 << 10, 'x');
  EXPECT_TRUE(journal.put(1, half));
  EXPECT_TRUE(journal.put(2, half));
  EXPECT_FALSE(journal.put(3, half)) << "there is no room";
  EXPECT_EQ(journal.next(), 4u) << "its number is used nevertheless";
  journal.lines().filed(1);
  SwitchJournal next = successor();
  ASSERT_EQ(next.unfiled().size(), 1u);
  EXPECT_EQ(next.unfiled()[0].number, 2u);
  EXPECT_TRUE(next.put(4, half)) << "a successor takes over unfiled receipts";
  next.lines().filed(2);
  next.lines().filed(4);
  EXPECT_EQ(numbers(next), "");
  EXPECT_EQ(next.next(), 5u);
  EXPECT_FALSE(next.put(5, std::string(sizeof memory->pages().lines, 'x')));
}

// The stores of an act one by one. After each of them its owner may be killed.
TEST_F(SwitchJournalTest, AKillBetweenTwoStoresLeavesAnActDoneOrNot) {
  SwitchJournal journal = memory->journal();
  journal.begin(switch_to(1));
  memory->pages().last = 0;  // begin(): the number is not in use yet
  SwitchJournal next = successor();
  EXPECT_EQ(next.begun()->number, 1u);
  EXPECT_EQ(next.next(), 2u);
  const std::uint64_t begun = memory->pages().begun;
  EXPECT_TRUE(next.put(1, "done"));
  memory->pages().begun = begun;  // put(): it is still under way
  SwitchJournal third = successor();
  EXPECT_FALSE(third.begun());
  EXPECT_EQ(numbers(third), "1:done ");
  EXPECT_TRUE(third.put(2, "refused"));
  memory->pages().last = 1;  // put(): its number is not in use yet
  SwitchJournal fourth = successor();
  EXPECT_EQ(fourth.next(), 3u);
  fourth.lines().filed(1);
  EXPECT_EQ(numbers(successor()), "2:refused ");
}

// The manager is killed at any time in a random life with a slow disk. At the end each number has one receipt.
TEST_F(SwitchJournalTest, EachNumberHasOneReceiptThoughManagersAreKilled) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::multiset<std::uint64_t> filed;
  SwitchJournal journal = memory->journal();
  for (int i = 0; i < 20'000; ++i) {
    switch (random() % 6) {
      case 0:
        if (!journal.begun()) journal.begin(switch_to(i % 3));
        break;
      case 1:
        if (journal.begun()) (void)journal.put(journal.begun()->number, "switch");
        break;
      case 2:
        if (journal.unfiled().size() < 20) (void)journal.put(journal.next(), "refused");
        break;
      case 3:
        if (const auto begun = journal.begun(); begun && begun->number + 1 == journal.next()) journal.forget();
        break;
      case 4:
        for (const auto& [number, text] : journal.unfiled()) {
          if (filed.count(number) == 0) filed.insert(number);  // as the file, which knows its receipts, does
          if (random() % 8 == 0) break;  // killed between the file and the journal
          journal.lines().filed(number);
        }
        break;
      default: journal = successor();
    }
  }
  if (journal.begun()) (void)journal.put(journal.begun()->number, "switch");
  for (const auto& [number, text] : journal.unfiled())
    if (filed.count(number) == 0) filed.insert(number);
  EXPECT_GT(filed.size(), 1000u);
  std::uint32_t expected = 0;
  for (const std::uint64_t number : filed) EXPECT_EQ(number, ++expected);
  EXPECT_EQ(expected + 1, journal.next());
}

// A dead manager may have written any value there.
TEST_F(SwitchJournalTest, GarbageIsNotFollowed) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    SwitchJournal journal = memory->journal();
    (void)journal.put(journal.next(), std::string(random() % 300, 'x'));
    for (int n = 0; n < 20; ++n) memory->bytes[random() % 4096] = static_cast<std::byte>(random());
    SwitchJournal next = successor();
    for (const auto& receipt : next.unfiled()) EXPECT_LE(receipt.text.size(), sizeof memory->pages().lines);
  }
}

}  // namespace
}  // namespace chimera::manager
