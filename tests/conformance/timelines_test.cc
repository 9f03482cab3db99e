// SPDX-License-Identifier: Apache-2.0
// The classic set of the MUF literature under five policies: every unit of sixty, and every missed deadline.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/conformance/runner.h"

#include "chimera/base/hosted/wording.h"

namespace chimera::toy {
namespace {

struct Expected {
  Policy policy;
  const char* timeline;
  const char* missed;
};

const Expected kExpected[] = {
    {Policy::kRm, "AABBBBAACCBBAABBCCAABBBBAACCCDAABBBBAACCBBAABBCDAABBBBAACCCD", "C@12 D@15 C@24 D@30 D@45"},
    {Policy::kEdf, "AABBBBAACCCDDDDAABBBAACCAABBBBAACCCBBBBAADDDDAACBBAABBBBAACC", "B@20 C@24 D@30 C@48 B@50"},
    {Policy::kLlf, "AABBBBCCAACDDDDABBBBCCAABDDBBACCAACBBBBAADDDDCCABBAABDDBCCAB",
     "A@18 C@24 A@30 B@30 D@30 A@48 C@48 B@50"},
    {Policy::kMufLaxity, "AABBBBCCAACBAABBBCCAACBBBAABCCAACBBBBAACCBAABCBBAABBCCABBACD", "D@15 D@30 D@45"},
    {Policy::kMuf, "AABBBBAACCCBAABBBCCCAABBBBAACCCAABBBBAACCCAABBBBAABBBBAACCCD", "D@15 D@30 D@45"},
};

void add_classic_set(Application& app, bool by_budget) {
  const struct { const char* name; int period, work; std::uint32_t criticality; } set[] = {
      {"A", 6, 2, 2}, {"B", 10, 4, 2}, {"C", 12, 3, 2}, {"D", 15, 4, 0}};
  for (const auto& one : set) {
    TaskSpec& spec = app.add(one.name, milliseconds(one.period), by_budget ? Nanoseconds{} : milliseconds(one.work));
    spec.budget = milliseconds(one.work);
    spec.criticality = one.criticality;
    spec.on_miss = OnMiss::kAbort;
  }
}

std::string timeline(const std::vector<TapRecord>& records) {
  std::string line(60, '.');
  for (const TapRecord& r : records) {
    if (r.kind != TapKind::kRun) continue;
    for (std::int64_t t = r.at.count; t < r.at.count + r.b; t += 1'000'000) {
      char& unit = line.at(static_cast<std::size_t>(t / 1'000'000));
      EXPECT_EQ(unit, '.') << "two jobs at once";
      unit = static_cast<char>('A' + r.task.index);
    }
  }
  return line;
}

std::string missed(const std::vector<TapRecord>& records) {
  std::vector<std::pair<std::int64_t, std::uint32_t>> misses;
  for (const TapRecord& r : records) {
    if (r.kind == TapKind::kMiss && r.at < milliseconds(60)) misses.emplace_back(r.at.count / 1'000'000, r.task.index);
  }
  std::sort(misses.begin(), misses.end());
  return join(misses, " ", [](const auto& miss) {
    return std::string(1, static_cast<char>('A' + miss.second)) + "@" + std::to_string(miss.first);
  });
}

class Timelines : public ::testing::TestWithParam<bool> {};

TEST_P(Timelines, ComeOutToTheLetterWithEveryMiss) {
  for (const Expected& expected : kExpected) {
    SCOPED_TRACE("policy " + std::to_string(static_cast<int>(expected.policy)));
    Application app;
    add_classic_set(app, GetParam());
    Runner run(app.build(), Kind::kPreemptive, expected.policy);
    ASSERT_TRUE(run.start());
    EXPECT_EQ(run.run(milliseconds(60)), RunEnd::kTime);
    const auto records = run.records();
    EXPECT_EQ(timeline(records), expected.timeline);
    EXPECT_EQ(missed(records), expected.missed);
  }
}

INSTANTIATE_TEST_SUITE_P(WorkFrom, Timelines, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Budget" : "Spend"; });

TEST(Timeline, ARunThatIsContinuedIsTheSameRun) {
  std::string whole, parts;
  for (const bool at_once : {true, false}) {
    Application app;
    add_classic_set(app, false);
    Runner run(app.build(), Kind::kPreemptive, Policy::kMufLaxity);
    ASSERT_TRUE(run.start());
    for (int until = at_once ? 60 : 7; until < 60; until += 7) run.run(milliseconds(until));
    run.run(milliseconds(60));
    (at_once ? whole : parts) = timeline(run.records());
  }
  EXPECT_EQ(parts, whole);
}

}  // namespace
}  // namespace chimera::toy
