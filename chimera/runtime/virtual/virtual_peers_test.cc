// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/virtual/virtual_peers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/two_rtpus.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"

namespace chimera {
namespace {

using testing::kMaker;
using testing::kTaker;

constexpr RtpuId kOfTaker{0u}, kOfMaker{1u};

struct VirtualPeersTest : ::testing::Test, testing::TwoRtpus {
  void build() {
    peers = *VirtualPeers::create(app.spec);
    for (std::uint32_t r = 0; r < 2; ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers.get();
      sets[r] = *HeapTaskSet::create(app.spec, app.components, place);
      peers->join(RtpuId(r), *sets[r]);
    }
  }
  void start(std::vector<ScriptAct> acts = {}) {
    script = std::move(acts);
    RunOptions options;
    options.script = Script(script);
    rtpus = std::make_unique<VirtualRtpus>(*peers, options, VirtualOptions{});
    const auto started = rtpus->start();
    ASSERT_TRUE(started) << started.error().message.c_str();
  }
  std::unique_ptr<VirtualPeers> peers;
  std::unique_ptr<HeapTaskSet> sets[2];
  std::vector<ScriptAct> script;
  std::unique_ptr<VirtualRtpus> rtpus;
};

TEST_F(VirtualPeersTest, NothingIsSeenOfAContextBeforeItJoins) {
  peers = *VirtualPeers::create(app.spec);
  EXPECT_EQ(peers->state(kMaker), State::kNotCreated);
  EXPECT_FALSE(peers->outputs(kMaker).is_bound());
  EXPECT_FALSE(peers->constants(kMaker).is_bound());
  EXPECT_TRUE(peers->operator_variable(0).is_bound()) << "operator variables are kept here";
}

TEST_F(VirtualPeersTest, StatesAndGroupsAreThoseOfTheContextAsItIs) {
  build();
  start();
  EXPECT_EQ(peers->state(kMaker), State::kOn);
  std::int32_t n = 0;
  std::memcpy(&n, peers->constants(kMaker).published() + 1, sizeof n);
  EXPECT_EQ(n, 3);
  EXPECT_EQ(peers->outputs(kMaker).published(), sets[1]->memory(kMaker).reader().published());
  peers->die(kOfMaker, {});
  EXPECT_EQ(peers->state(kMaker), State::kError);
  EXPECT_EQ(peers->state(kTaker), State::kOn);
}

TEST_F(VirtualPeersTest, PassesSignalsOnInOrderAsFarAsThereIsRoom) {
  build();
  const std::uint32_t before = peers->bell(kOfTaker);
  EXPECT_TRUE(peers->post(Signal::kOff, kTaker, kMaker, false));
  EXPECT_TRUE(peers->post(Signal::kReinit, kTaker, kMaker, true));
  EXPECT_EQ(peers->bell(kOfTaker), before + 2);
  VirtualPost post;
  ASSERT_TRUE(peers->take(kOfTaker, post));
  EXPECT_EQ(post.signal, Signal::kOff);
  EXPECT_EQ(post.target, kTaker);
  ASSERT_TRUE(peers->take(kOfTaker, post));
  EXPECT_TRUE(post.is_echo);
  EXPECT_FALSE(peers->take(kOfTaker, post));
  for (std::size_t i = 0; i < VirtualPeers::kMostPosts; ++i)
    EXPECT_TRUE(peers->post(Signal::kOff, kTaker, kMaker, false));
  EXPECT_FALSE(peers->post(Signal::kOff, kTaker, kMaker, false));
  peers->die(kOfMaker, {});
  EXPECT_FALSE(peers->post(Signal::kOff, kMaker, kTaker, false)) << "the rtpu of the maker is dead";
}

TEST_F(VirtualPeersTest, AnOperatorVariableReachesItsReaders) {
  build();
  const std::vector<std::byte> value = testing::bytes_of(2.5);
  ScriptAct set;
  set.at = milliseconds(2);
  set.kind = ScriptAct::Kind::kSet;
  set.value = value;
  start({set});
  double gain = 0;
  const auto read = [&] { std::memcpy(&gain, sets[0]->tasks()[kTaker.index].inputs[1].port->value, sizeof gain); };
  (void)rtpus->run_to(milliseconds(2));
  read();
  EXPECT_EQ(gain, 0.5);
  (void)rtpus->run_to(milliseconds(3));
  read();
  EXPECT_EQ(gain, 2.5);
}

struct Numberer {
  OutConst<std::int32_t> n{"n", "1"};
  std::int32_t next = 3;
  void init() { *n = next++; }
  void reinit() { init(); }
  void cycle(Cycle) {}
};
struct User {
  InConst<std::int32_t> n{"n", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  std::int32_t times = 0;
  void init() { ++times; }
  void reinit() { ++times; }
  void cycle(Cycle) { *seen = 100.0 * *n + times; }
};

ScriptAct signal_at(Nanoseconds at, Signal signal, TaskId task) {
  ScriptAct act;
  act.at = at;
  act.signal = signal;
  act.task = task;
  return act;
}

/// The last task writes one number, and is alone on the first of two rtpus.
struct VirtualReaderTest : VirtualPeersTest {
  VirtualReaderTest() { app = testing::TestApplication(); }
  void begin(std::vector<ScriptAct> acts, std::vector<TaskId> off = {}) {
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    std::vector<TaskId> on;
    for (std::size_t t = 0; t < app.tasks.size(); ++t) {
      app.tasks[t].rtpu = t + 1 == app.tasks.size() ? kOfTaker : kOfMaker;
      if (std::find(off.begin(), off.end(), TaskId(t)) == off.end()) on.push_back(TaskId(t));
    }
    app.make(on, false);
    build();
    start(std::move(acts));
  }
  double seen_at(Nanoseconds instant) {
    (void)rtpus->run_to(instant);
    double seen = 0;
    std::memcpy(&seen, sets[0]->memory(TaskId(app.tasks.size() - 1)).reader().published() + 1, sizeof seen);
    return seen;
  }
};

TEST_F(VirtualReaderTest, AUserOfAConstantIsReinitialisedWhenAnotherRtpuChangesIt) {
  app.add("numberer", testing::component<Numberer>("numberer"));
  app.add("user", testing::component<User>("user"));
  begin({signal_at(microseconds(2500), Signal::kReinit, TaskId(0u))});
  EXPECT_EQ(seen_at(milliseconds(2)), 301);
  EXPECT_EQ(seen_at(milliseconds(4)), 402);
}

template <int kNumber>
struct Writer {
  Out<double> v{"v", "1", initial = 0.0};
  void cycle(Cycle) { *v = kNumber; }
};
struct Reader {
  In<double> v{"v", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle) { *seen = *v; }
};

TEST_F(VirtualReaderTest, FollowsTheProducerThatIsOn) {
  app.add("one", testing::component<Writer<1>>("one"));
  app.add("two", testing::component<Writer<2>>("two"));
  app.add("reader", testing::component<Reader>("reader"));
  const TaskId one(0u), two(1u);
  begin({signal_at(microseconds(2500), Signal::kOff, one), signal_at(microseconds(4500), Signal::kOn, two)}, {two});
  EXPECT_EQ(seen_at(milliseconds(2)), 1);
  EXPECT_EQ(seen_at(milliseconds(4)), 1) << "the last value stands";
  EXPECT_EQ(seen_at(milliseconds(7)), 2);
}

}  // namespace
}  // namespace chimera
