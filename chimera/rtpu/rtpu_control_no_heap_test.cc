// SPDX-License-Identifier: Apache-2.0
// The cycle boundaries of rtpus allocate nothing from the heap. The test counts allocations during signals, changes,
// faults, and restarts of an rtpu and the manager. It also finds vectors that grow beyond their reserved room, which
// tools/check_cycle_path.py cannot see. The test steps the rtpus, as in rtpu_control_test.cc.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "chimera/rtpu/testing/test_rtpus.h"

namespace {

bool is_counting = false;
std::size_t n_allocations = 0;

}  // namespace

// For the whole test program: every form of new that the library's own default calls in the end.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (is_counting) ++n_allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  std::abort();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return operator new(size); }
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace chimera {
namespace {

using testing::component;
using testing::TestApplication;
using testing::TestRtpus;

struct Giver {
  Out<double> given{"given", "1", initial = 0.0};
  Outcome cycle(Cycle) {
    *given = ++n_;
    if (allocates) delete new int(1);
    return n_ == 30 ? fault("thirtieth", 30) : ok();
  }
  bool error(Cycle) { return true; }
  double n_ = 0;
  static inline bool allocates = false;
};

struct Taker {
  In<double> given{"given", "1"};
  Out<double> taken{"taken", "1", initial = 0.0};
  void cycle(Cycle) { *taken = *given; }
};

constexpr TaskId kGiver{0u}, kTaker{1u};

class EdgeNoHeap : public ::testing::Test {
 protected:
  EdgeNoHeap() {
    Giver::allocates = false;
    app_.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app_.add("giver", component<Giver>("giver")).rtpu = RtpuId(0u);
    app_.add("taker", component<Taker>("taker")).rtpu = RtpuId(1u);
    app_.make({kGiver, kTaker}, false);
    rtpus_ = std::make_unique<TestRtpus>(app_);
    rtpus_->posts.reserve(10'000);
    rtpus_->run(milliseconds(1));
    rtpus_->bring_up({kGiver, kTaker});
  }
  /// Allocations while all rtpus run for `time`.
  std::size_t run(Nanoseconds time) {
    n_allocations = 0;
    is_counting = true;
    rtpus_->run(time);
    is_counting = false;
    return n_allocations;
  }
  State taker() const { return rtpus_->rtpus[1]->state(kTaker); }

  TestApplication app_;
  std::unique_ptr<TestRtpus> rtpus_;
};

TEST_F(EdgeNoHeap, SignalsChangesAndFaultsAllocateNothing) {
  EXPECT_EQ(run(milliseconds(50)), 0u);
  EXPECT_EQ(rtpus_->rtpus[0]->tasks->tasks()[kGiver.index].faults.count, 1u);
  for (int i = 0; i < 10; ++i) {
    rtpus_->send(i % 2 == 0 ? Signal::kOff : Signal::kOn, {kTaker}, static_cast<std::uint64_t>(i) + 1);
    EXPECT_EQ(run(milliseconds(2)), 0u);
    EXPECT_EQ(taker(), i % 2 == 0 ? State::kOff : State::kOn);
  }
  rtpus_->manager->block.set_tapped(kGiver, true);
  rtpus_->change();
  EXPECT_EQ(run(milliseconds(2)), 0u);
  EXPECT_TRUE(rtpus_->rtpus[0]->tasks->tasks()[kGiver.index].is_tapped);
}

TEST_F(EdgeNoHeap, AnotherRtpuAndAnotherManagerAreAdoptedWithoutAllocation) {
  rtpus_->die(0);
  EXPECT_EQ(run(milliseconds(2)), 0u);
  rtpus_->start(0, 2);
  EXPECT_EQ(run(milliseconds(2)), 0u);
  rtpus_->start_manager(2);
  EXPECT_EQ(run(milliseconds(2)), 0u);
  EXPECT_EQ(rtpus_->rtpus[1]->peers->at(0)->block().head().incarnation, 2u);
}

TEST_F(EdgeNoHeap, AComponentThatAllocatesIsSeen) {
  Giver::allocates = true;
  EXPECT_GE(run(milliseconds(20)), 19u);
  Giver::allocates = false;
}

}  // namespace
}  // namespace chimera
