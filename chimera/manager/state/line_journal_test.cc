// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/line_journal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <random>
#include <string>

namespace chimera::manager {
namespace {

constexpr std::size_t kRingBytes = 1024;

/// A copy is the journal that a successor finds if its owner is killed now.
struct RingMemory {
  alignas(64) std::byte bytes[LineJournal::kHeadBytes + kRingBytes] = {};
};

std::string lines_of(const LineJournal& journal) {
  std::string text;
  for (const LineJournal::Line& line : journal.unfiled())
    text += std::to_string(line.number) + ":" + std::string(line.text) + " ";
  return text;
}

TEST(LineJournal, HandsUnfiledLinesOn) {
  RingMemory memory, next;
  LineJournal journal(memory.bytes);
  EXPECT_EQ(lines_of(journal), "");
  EXPECT_TRUE(journal.put(1, "a"));
  EXPECT_TRUE(journal.put(2, ""));
  EXPECT_TRUE(journal.put(3, std::string(100, 'c')));
  journal.filed(2);
  LineJournal successor(next.bytes);
  EXPECT_EQ(successor.take_over(memory.bytes), 3u);
  EXPECT_EQ(lines_of(successor), "1:a 3:" + std::string(100, 'c') + " ");
  EXPECT_FALSE(successor.put(4, std::string(kRingBytes, 'x'))) << "it never fits";
  successor.filed(1);
  successor.filed(3);
  EXPECT_TRUE(successor.put(5, std::string(kRingBytes - sizeof(LineJournal::Entry), 'x'))) << "it fits at any place";
  EXPECT_EQ(successor.unfiled().size(), 1u);
}

// Lines come and go in order. The room is used again for ever, and each copy has all lines of that instant.
TEST(LineJournal, ARandomLifeLosesNoLineThatItAccepted) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  RingMemory memory;
  LineJournal journal(memory.bytes);
  std::deque<std::pair<std::uint64_t, std::string>> expected;
  int refused = 0;
  for (std::uint64_t number = 1; number < 5000; ++number) {
    const std::string line(random() % 300, static_cast<char>('a' + number % 26));
    if (journal.put(number, line)) expected.emplace_back(number, line);
    else ++refused;
    for (; !expected.empty() && random() % 2 == 0; expected.pop_front()) journal.filed(expected.front().first);
    RingMemory copy;
    std::memcpy(copy.bytes, memory.bytes, sizeof copy.bytes);
    const std::vector<LineJournal::Line> left = LineJournal(copy.bytes).unfiled();
    ASSERT_EQ(left.size(), expected.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
      ASSERT_EQ(left[i].number, expected[i].first);
      ASSERT_EQ(left[i].text, expected[i].second);
    }
  }
  EXPECT_LT(refused, 4000);
}

// A dead manager may have left any bytes.
TEST(LineJournal, GarbageIsNotFollowed) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    RingMemory memory, next;
    LineJournal journal(memory.bytes);
    for (std::uint64_t n = 1; n < 6; ++n) (void)journal.put(n, std::string(random() % 100, 'x'));
    for (int n = 0; n < 10; ++n) memory.bytes[random() % (n < 5 ? 200 : sizeof memory.bytes)] = std::byte(random());
    for (const LineJournal::Line& line : journal.unfiled()) EXPECT_LE(line.text.size(), kRingBytes);
    (void)LineJournal(next.bytes).take_over(memory.bytes);
  }
}

}  // namespace
}  // namespace chimera::manager
