// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/supervised_signals.h"

#include <gtest/gtest.h>

#include "chimera/rtpu/testing/test_rtpus.h"

namespace chimera {
namespace {

using testing::component;

const SupervisedSignals* watched = nullptr;

/// Reads in each method what a supervisor would read then.
struct Seer {
  Out<double> x{"x", "1", initial = 0.0};
  void on(Cycle) { seen_on = watched->acting(), progress = watched->progress(); }
  void off(Cycle) { seen_off = watched->acting(); }
  void cycle(Cycle) { seen_cycle = watched->acting(); }
  static inline std::uint32_t seen_on = 0, seen_off = 0, seen_cycle = 1, progress = 0;
};

TEST(SupervisedSignals, TellTheMethodForAsLongAsItIsUnderWay) {
  const TaskId seer(0u);
  testing::TestApplication app;
  app.rtpus = {{"only", 0, Policy::kEdf}};
  app.add("seer", component<Seer>("seer")).rtpu = RtpuId(0u);
  app.make({seer}, false);
  testing::TestRtpus rtpus(app);
  watched = &rtpus.rtpus[0]->edge->supervised();
  rtpus.run(milliseconds(1));
  const std::uint32_t before = watched->progress();
  rtpus.bring_up({seer});
  rtpus.run(milliseconds(20));
  EXPECT_EQ(Seer::seen_on, TaskWord(seer, Method::kOn).word());
  EXPECT_EQ(Seer::progress % 2, 1u) << "begun, not ended";
  EXPECT_EQ(Seer::seen_cycle, 0u) << "a job is no signal";
  EXPECT_EQ(watched->acting(), 0u);
  rtpus.send(Signal::kOff, {seer});
  rtpus.run(milliseconds(1));
  EXPECT_EQ(Seer::seen_off, TaskWord(seer, Method::kOff).word());
  EXPECT_EQ(watched->progress(), before + 6) << "spawn, on and off";
  EXPECT_EQ(rtpus.rtpus[0]->state(seer), State::kOff) << "shown to the others";
}

}  // namespace
}  // namespace chimera
