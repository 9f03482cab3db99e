// SPDX-License-Identifier: Apache-2.0
#include "chimera/analysis/link_age.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera {
namespace {

constexpr TaskId kWriter{0u}, kReader{1u}, kOther{2u};

/// `other` reads the writer on another rtpu.
struct LinkAge : ::testing::Test {
  LinkAge() {
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      tasks[t].name = t == 0 ? "writer" : t == 1 ? "reader" : "other";
      tasks[t].period = tasks[t].deadline = milliseconds(1);
      tasks[t].rtpu = RtpuId(t == 2 ? 1u : 0u);
    }
    rtpus[0].name = "main";
    rtpus[1].name = "spare";
    variables[0] = {.name = "v", .producers = {&ports[0], 1}, .consumers = {&ports[1], 2}};
    spec.tasks = tasks;
    spec.rtpus = rtpus;
    spec.variables = variables;
    tasks[1].place = tasks[2].place = 1;
  }
  std::string late(TaskId from, TaskId to) const { return late_text(spec, from, to); }

  std::array<TaskSpec, 3> tasks;
  std::array<RtpuSpec, 2> rtpus;
  const PortOf ports[3] = {{kWriter, 0}, {kReader, 0}, {kOther, 0}};
  std::array<Variable, 1> variables;
  std::array<TaskId, 3> order{kWriter, kReader, kOther};
  ApplicationSpec spec;
};

TEST_F(LinkAge, EqualsReadInTheSameCycle) {
  for (const Policy policy : {Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kLlf, Policy::kMufLaxity}) {
    rtpus[0].policy = policy;
    EXPECT_EQ(late(kWriter, kReader), "");
    EXPECT_EQ(late(kReader, kWriter), "a loop is cut here");
    EXPECT_EQ(cycle_order(spec, {kReader, kWriter}), (std::vector{kWriter, kReader}));
  }
}

TEST_F(LinkAge, EachCauseHasAChangeThatHelps) {
  rtpus[0].policy = Policy::kEdf;
  EXPECT_EQ(late(kWriter, kOther), "'other' runs on another rtpu; remedy: rtpu: main of 'other'");

  tasks[0].period = tasks[0].deadline = milliseconds(2);
  EXPECT_EQ(late(kWriter, kReader),
            "edf runs 'reader' first, which is due sooner; remedy: deadline: 1 ms of 'writer'");
  EXPECT_EQ(cycle_order(spec, {kWriter, kReader}), (std::vector{kReader, kWriter}));
  tasks[0].deadline = milliseconds(1);
  EXPECT_EQ(late(kWriter, kReader), "");

  rtpus[0].policy = Policy::kRm;
  EXPECT_EQ(late(kWriter, kReader),
            "rm runs the shorter period of 'reader' first; remedy: the same rate of 'writer'");
  tasks[0].period = milliseconds(1);
  EXPECT_EQ(late(kWriter, kReader), "");

  tasks[1].user_priority = 7;
  EXPECT_EQ(late(kWriter, kReader), "'reader' has the higher priority; remedy: user_priority: 7 of 'writer'");
  tasks[0].user_priority = 7;
  EXPECT_EQ(late(kWriter, kReader), "");

  rtpus[0].policy = Policy::kMuf;
  tasks[1].criticality = 2;
  EXPECT_EQ(late(kWriter, kReader), "'reader' is more critical; remedy: criticality: high of 'writer'");
  tasks[0].criticality = 2;
  EXPECT_EQ(late(kWriter, kReader), "");

  tasks[0].offset = microseconds(500);
  EXPECT_EQ(late(kWriter, kReader), "'reader' has the earlier offset; remedy: offset: 500 us of 'reader'");
  tasks[1].offset = microseconds(500);
  EXPECT_EQ(late(kWriter, kReader), "");

  rtpus[0].policy = Policy::kMufLaxity;
  tasks[0].budget = microseconds(100);
  tasks[1].budget = microseconds(300);
  EXPECT_EQ(late(kWriter, kReader),
            "muf-laxity runs 'reader' first, which can wait less; remedy: deadline: 800 us of 'writer'");
  tasks[0].deadline = microseconds(800);
  EXPECT_EQ(late(kWriter, kReader), "");
  rtpus[0].preemptive = true;
  EXPECT_EQ(late(kWriter, kReader),
            "muf-laxity promises no order; remedy: policy: edf or muf of rtpu 'main'");
}

TEST_F(LinkAge, ListsEachPairOfTheSetOnce) {
  const std::vector<TaskLink> links = links_among(spec, std::array{kReader, kWriter});
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links[0].from, kWriter);
  EXPECT_EQ(links[0].to, kReader);
  EXPECT_EQ(links[0].periods(), 0u);
  const std::vector<TaskLink> all = links_among(spec, order);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].periods(), 1u);
}

}  // namespace
}  // namespace chimera
