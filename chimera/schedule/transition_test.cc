// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/transition.h"

#include <gtest/gtest.h>

#include <vector>

namespace chimera {
namespace {

using Part = TransitionPart;

Work work(std::int64_t period, std::int64_t time, std::int64_t offset = 0, std::uint32_t criticality = 0) {
  return {.period = milliseconds(period), .deadline = milliseconds(period), .offset = milliseconds(offset),
          .time = milliseconds(time), .criticality = criticality, .user_priority = 0, .rtpu = 0, .server = {}};
}

ProcessorUse use(Policy policy, Dispatch dispatch = Dispatch::kPreemptive) {
  return {.cpu = 0, .criticality = 0, .policy = policy, .dispatch = dispatch};
}

struct Judged {
  Judged(const std::vector<Work>& works, const std::vector<Part>& parts, const std::vector<ProcessorUse>& uses)
      : verdicts(works.size()), room(works.size()),
        all(analyse_transition(works, parts, uses, 0, verdicts, room)) {}
  bool fits() const { return all.guarantee == Guarantee::kYes; }
  std::int64_t response(std::size_t i) const { return verdicts[i].response.count / 1'000'000; }

  std::vector<WorkVerdict> verdicts;
  std::vector<MovingWork> room;
  TransitionVerdict all;
};

bool fits_alone(const std::vector<Work>& works, const std::vector<ProcessorUse>& uses) {
  std::vector<WorkVerdict> verdicts(works.size());
  std::vector<RankedWork> room(works.size());
  return analyse(works, uses, 0, verdicts, room).fits();
}

TEST(Transition, ASwitchBetweenTwoSchedulableSetsMayOverload) {
  const std::vector<Work> works = {work(10, 9), work(14, 12, 1)};
  EXPECT_TRUE(fits_alone({works[0]}, {use(Policy::kEdf)}));
  EXPECT_TRUE(fits_alone({works[1]}, {use(Policy::kEdf)}));
  const Judged j(works, {Part::kLeaves, Part::kArrives}, {use(Policy::kEdf)});
  EXPECT_EQ(j.all.guarantee, Guarantee::kNo);  // 21 ms from the last release before the change on, 14 ms after it
  EXPECT_TRUE(Judged({work(10, 5), work(14, 7, 1)}, {Part::kLeaves, Part::kArrives}, {use(Policy::kEdf)}).fits());
}

TEST(Transition, ALikeForLikeSwitchFitsIfTheLongerTimeFits) {
  for (const Policy policy : {Policy::kEdf, Policy::kRm, Policy::kMuf})
    for (const Dispatch dispatch : {Dispatch::kPreemptive, Dispatch::kExecutive}) {
      const Judged j({work(10, 6), work(10, 4), work(20, 6)}, {Part::kLeaves, Part::kArrives, Part::kStays},
                     {use(policy, dispatch)});
      EXPECT_TRUE(j.fits() || dispatch == Dispatch::kExecutive);
      EXPECT_EQ(j.fits(), fits_alone({work(10, 6), work(20, 6)}, {use(policy, dispatch)}));
      const Judged back({work(10, 6), work(10, 4), work(20, 6)}, {Part::kArrives, Part::kLeaves, Part::kStays},
                        {use(policy, dispatch)});
      EXPECT_EQ(j.fits(), back.fits());
    }
}

TEST(Transition, OnAnotherGridATaskMeetsTheLastJobOfItsPredecessor) {
  // The same rates and times. The first release after the change comes 9 ms after the last one before it.
  const Judged far({work(10, 6), work(10, 6, 9)}, {Part::kLeaves, Part::kArrives}, {use(Policy::kEdf)});
  EXPECT_FALSE(far.fits());
  const Judged near({work(10, 6), work(10, 4, 9)}, {Part::kLeaves, Part::kArrives}, {use(Policy::kEdf)});
  EXPECT_TRUE(near.fits());
  EXPECT_EQ(near.response(1), 10);  // bounded by its deadline
  EXPECT_EQ(near.all.settled, milliseconds(10));
}

TEST(Transition, CountsTheCarryInOfALeavingTaskOfHigherPriority) {
  const std::vector<Work> works = {work(10, 4), work(8, 3), work(20, 7)};
  const std::vector<Part> parts = {Part::kLeaves, Part::kArrives, Part::kStays};
  const Judged j(works, parts, {use(Policy::kRm)});
  EXPECT_TRUE(j.fits());
  // One job of 4 ms just before the change, and three of 3 ms from the change on.
  EXPECT_EQ(j.response(2), 20);
  EXPECT_EQ(Judged(works, {Part::kLeaves, Part::kAbsent, Part::kStays}, {use(Policy::kRm)}).response(2), 15);
  EXPECT_EQ(Judged(works, {Part::kAbsent, Part::kArrives, Part::kStays}, {use(Policy::kRm)}).response(2), 13);
  const Judged more({works[0], works[1], work(20, 9)}, parts, {use(Policy::kRm)});
  EXPECT_EQ(more.all.guarantee, Guarantee::kNo);
  EXPECT_EQ(more.all.task, 2u);
}

TEST(Transition, LetsAJobOfALeavingTaskBlockAnExecutiveOnceMore) {
  const std::vector<ProcessorUse> executive = {use(Policy::kEdf, Dispatch::kExecutive)};
  const std::vector<Work> works = {work(40, 8), work(10, 4, 1), work(5, 1)};
  EXPECT_TRUE(fits_alone({works[1], works[2]}, executive));
  EXPECT_FALSE(Judged(works, {Part::kLeaves, Part::kArrives, Part::kStays}, executive).fits());
  const std::vector<Work> shorter = {work(40, 3), works[1], works[2]};
  EXPECT_TRUE(Judged(shorter, {Part::kLeaves, Part::kArrives, Part::kStays}, executive).fits());
}

TEST(Transition, JudgesEachCriticalityByItself) {
  const std::vector<Work> works = {work(10, 8, 0, 0), work(10, 8, 5, 0), work(10, 1, 0, 2)};
  const Judged j(works, {Part::kLeaves, Part::kArrives, Part::kStays}, {use(Policy::kMuf)});
  EXPECT_EQ(j.verdicts[2].guarantee, Guarantee::kYes);
  EXPECT_EQ(j.response(2), 1);
  EXPECT_EQ(j.verdicts[1].guarantee, Guarantee::kNo);
}

TEST(Transition, CountsTasksWithoutATimeAndLeavesOutOtherProcessors) {
  std::vector<Work> works = {work(10, 0), work(10, 5), work(10, 9)};
  works[2].rtpu = 1;
  std::vector<ProcessorUse> uses = {use(Policy::kEdf), use(Policy::kEdf)};
  uses[1].cpu = 1;
  const Judged j(works, {Part::kLeaves, Part::kArrives, Part::kStays}, uses);
  EXPECT_TRUE(j.fits());
  EXPECT_EQ(j.all.unstated, 1u);
  EXPECT_EQ(j.verdicts[0].guarantee, Guarantee::kNotStated);
  EXPECT_EQ(j.verdicts[1].guarantee, Guarantee::kYes);
  EXPECT_EQ(j.verdicts[2].guarantee, Guarantee::kNotStated);  // not written
}

TEST(Transition, FromOrToTooMuchIsRefused) {
  const std::vector<Work> works = {work(10, 6), work(10, 6), work(10, 1)};
  EXPECT_FALSE(Judged(works, {Part::kStays, Part::kStays, Part::kLeaves}, {use(Policy::kEdf)}).fits());
  EXPECT_FALSE(Judged(works, {Part::kStays, Part::kArrives, Part::kLeaves}, {use(Policy::kEdf)}).fits());
  EXPECT_EQ(Judged(works, {Part::kStays, Part::kArrives, Part::kLeaves}, {use(Policy::kEdf)}).all.settled, kNever);
}

TEST(Transition, AWindowOfAThousandCyclesIsAnalysedInTime) {
  std::vector<Work> works;
  std::vector<Part> parts;
  for (std::int64_t i = 0; i < 60; ++i) {
    works.push_back(work(10 + i, 1));
    works.back().time = microseconds(300);
    parts.push_back(i % 3 == 0 ? Part::kStays : i % 3 == 1 ? Part::kLeaves : Part::kArrives);
  }
  const Judged j(works, parts, {use(Policy::kEdf)});
  EXPECT_TRUE(j.fits());
  EXPECT_LT(j.all.terms, 2'000'000);
}

}  // namespace
}  // namespace chimera
