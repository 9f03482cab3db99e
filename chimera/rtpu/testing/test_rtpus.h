// SPDX-License-Identifier: Apache-2.0
// For tests: several rtpus and the manager's segment in one process, stepped in virtual time. The test plays the keeper
// and the manager.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "chimera/platform/clock.h"
#include "chimera/rtpu/rtpu_control.h"
#include "chimera/rtpu/switch_links.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::testing {

/// Only notes in ask() that init or kill must run. The test runs them later, for example in TestRtpu::serve().
class HandService final : public Service {
 public:
  void ask(TaskId task) noexcept override { asked.push_back(task); }
  bool take_served(TaskId& task) noexcept override {
    if (done.empty()) return false;
    task = done.front();
    done.pop_front();
    return true;
  }
  std::deque<TaskId> asked, done;
};

/// spend() of a method advances the clock of its rtpu.
class SteppedJobClock final : public JobClock {
 public:
  explicit SteppedJobClock(VirtualClock& clock) noexcept : clock_(clock) {}
  Nanoseconds now() noexcept override { return clock_.now(); }
  void spend(Nanoseconds time) noexcept override { clock_.advance(time); }

 private:
  VirtualClock& clock_;
};

/// A layer of the test between an rtpu and its links in a switch.
using BetweenLinks = std::function<std::shared_ptr<SwitchPeers>(std::uint32_t me, SwitchPeers& links)>;

/// A segment of a peer, formatted, with its block.
struct OwnSegment {
  OwnSegment(const ApplicationSpec& spec, std::uint32_t peer, std::uint32_t incarnation) {
    HeapMemory heap;
    const auto layout = PeerLayout::of(spec, peer, heap);
    const auto n_tasks = static_cast<std::uint32_t>(spec.tasks.size());
    region = *MemoryRegion::create("test", peer_segment_bytes(layout->table(), n_tasks));
    EXPECT_TRUE(SegmentOwner::format(region.writable(), layout->table()).has_value());
    block = BlockOwner(region.writable().data() + block_offset(layout->table()), peer, incarnation, n_tasks,
                       static_cast<std::uint32_t>(spec.rtpus.size()) + 1);
  }
  MemoryRegion region;
  BlockOwner block;
};

struct TestRtpu {
  TestRtpu(const ApplicationSpec& spec, std::span<const chimera_component* const> components, std::uint32_t me,
       std::uint32_t incarnation, DecisionPage& decision, KeeperPage& keeper, const BetweenLinks& between = {})
      : bell(decision.bells[me].word), segment(spec, me, incarnation), peers(*MappedPeers::create(spec)),
        clock(decision_now), others(spec, me, segment.region.writable(), segment.block, decision, keeper, *peers) {
    const ContextPlace place{RtpuId(me), segment.region.writable().subspan(sizeof(SegmentHeader)),
                             &others,    nullptr,
                             &service,   &segment.block.head().running,
                             &segment.block.head().serving};
    auto made = HeapTaskSet::create(spec, components, place);
    EXPECT_TRUE(made.has_value()) << (made ? "" : made.error().message.c_str());
    tasks = *std::move(made);
    switching = std::make_unique<SwitchLinks>(*tasks, others, *peers, decision, me);
    if (between) in_between = between(me, *switching);
    edge = std::make_unique<RtpuControl>(spec, *tasks, others, service, decision, me, seconds(1));
    RunOptions options;
    options.policy = spec.rtpus[me].policy;
    options.guest = edge.get();
    options.switch_peers = in_between ? in_between.get() : switching.get();
    options.stop = &edge->rtpu_end().is_over();
    executive = std::make_unique<Executive>(*tasks, clock, job_clock, options);
    executive->start(keeper.origin);
    edge->begin();
    keeper.alive[me] = incarnation;
  }

  void serve() {
    while (!service.asked.empty()) {
      const TaskId task = service.asked.front();
      service.asked.pop_front();
      tasks->slow().run(task, job_clock);
      service.done.push_back(task);
      bell.ring();
    }
  }
  /// Ends all that the process has but its memory: its tasks close their devices.
  void end_process() {
    executive.reset();
    edge.reset();
    in_between.reset();
    switching.reset();
    tasks.reset();
  }
  State state(TaskId task) const { return segment.block.view().status(task).state; }
  double output(TaskId task) const {
    double value = 0;
    std::memcpy(&value, tasks->tasks()[task.index].group.published() + 1, sizeof value);
    return value;
  }

  static inline Nanoseconds decision_now{};
  Doorbell bell;
  OwnSegment segment;
  std::unique_ptr<MappedPeers> peers;
  VirtualClock clock;
  SteppedJobClock job_clock{clock};
  HandService service;
  PeerLinks others;
  std::unique_ptr<HeapTaskSet> tasks;
  std::unique_ptr<SwitchLinks> switching;
  std::shared_ptr<SwitchPeers> in_between;
  std::unique_ptr<RtpuControl> edge;
  std::unique_ptr<Executive> executive;
};

/// The application of `app` on one TestRtpu for each of its rtpus.
class TestRtpus {
 public:
  explicit TestRtpus(TestApplication& application, BetweenLinks between_links = {})
      : app(application), between(std::move(between_links)) {
    n = static_cast<std::uint32_t>(app.spec.rtpus.size());
    keeper.n_rtpus = n;
    rtpus.resize(n);
    for (std::uint32_t u = 0; u < n; ++u) start(u, 1);
    start_manager(1);
  }
  void start(std::uint32_t u, std::uint32_t incarnation) {
    TestRtpu::decision_now = now;
    rtpus[u] = std::make_unique<TestRtpu>(app.spec, app.components, u, incarnation, decision, keeper, between);
    for (std::uint32_t other = 0; other < n; ++other) {
      if (other == u || rtpus[other] == nullptr) continue;
      show(u, other);
      show(other, u);
    }
    if (manager != nullptr) show_manager(u);
  }
  void start_manager(std::uint32_t incarnation) {
    manager = std::make_unique<OwnSegment>(app.spec, n, incarnation);
    keeper.alive[n] = incarnation;
    inboxes.assign(n, Inbox());
    for (std::uint32_t u = 0; u < n; ++u) show_manager(u);
  }
  /// Reports the death of an rtpu, as the keeper does.
  void die(std::uint32_t u) {
    keeper.alive[u] = 0;
    change();
  }
  void change() {
    decision.changes.fetch_add(1);
    for (std::uint32_t u = 0; u < n; ++u) Doorbell(decision.bells[u].word).ring();
  }
  /// Lets `time` pass in steps of 100 us, one rtpu after the other; init and kill run at once.
  void run(Nanoseconds time) {
    for (const Nanoseconds end = now + time; now < end;) {
      now += microseconds(100);
      for (const auto& rtpu : rtpus) {
        if (keeper.alive[rtpu->segment.block.head().peer] == 0) continue;
        rtpu->serve();
        (void)rtpu->executive->run(now - keeper.origin);
      }
      collect();
    }
  }
  /// Sends a signal as the manager does.
  void send(Signal signal, std::vector<TaskId> tasks, std::uint64_t command = 0) {
    const std::uint32_t u = app.spec.tasks[tasks[0].index].rtpu.index;
    Outbox outbox(manager->block.outbox(u), &rtpus[u]->segment.block.progress(n), manager->block.head().incarnation);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      Post post;
      post.command = command;
      post.task = tasks[i];
      post.signal = signal;
      post.more = i + 1 < tasks.size();
      EXPECT_TRUE(outbox.is_followed() && outbox.try_post(post));
    }
    Doorbell(decision.bells[u].word).ring();
  }
  /// Orders a switch as the manager does; returns the number of the plan. `slow`: SwitchOrder::slow.
  std::uint16_t switch_to(std::uint32_t set, Nanoseconds lead = microseconds(300), Nanoseconds wait = seconds(1),
                          std::uint8_t slow = 0) {
    SwitchAgreement agreement(decision.switching, keeper.origin);
    SwitchOrder order;
    order.number = next_plan(agreement.plan().number);
    for (std::uint32_t u = 0; u < n; ++u)
      if (keeper.alive[u] != 0) order.members = static_cast<std::uint16_t>(order.members | 1u << u);
    order.after = set;
    order.target = tasks_of(app.spec, set);
    order.slow = slow;
    order.constants = constants_in_force();
    order.until = now + wait;
    order.lead = lead;
    for (const TaskSpec& task : app.tasks) {
      const TaskId id(static_cast<std::size_t>(&task - app.tasks.data()));
      if (keeper.alive[task.rtpu.index] != 0 && rtpus[task.rtpu.index]->state(id) == State::kOn) order.on.add(id);
    }
    agreement.announce(order);
    change();
    return order.number;
  }
  /// The constants that the manager knows from the last order.
  std::uint32_t constants_in_force() {
    SwitchAgreement agreement(decision.switching, keeper.origin);
    const PlanWord plan = agreement.plan();
    const auto last = agreement.order(plan, app.spec.sets.size(), app.spec.tasks.size());
    if (!last) return set_of_start(app.spec);
    return plan.phase == SwitchPhase::kCommitted ? last->constants_after() : last->constants;
  }
  bool is_over(std::uint16_t number) const {
    for (std::uint32_t u = 0; u < n; ++u)
      if (keeper.alive[u] != 0 && rtpus[u]->segment.block.head().switching.over != number) return false;
    return true;
  }
  const SwitchPart& part(std::uint32_t u) const { return rtpus[u]->segment.block.switch_part(); }
  void bring_up(const std::vector<TaskId>& tasks) {
    for (const TaskId task : tasks) {
      send(Signal::kSpawn, {task});
      run(milliseconds(1));
    }
    for (const TaskId task : tasks) send(Signal::kOn, {task});
    run(milliseconds(1));
  }
  void collect() {
    for (std::uint32_t u = 0; u < n; ++u)
      for (Post post; inboxes[u].is_attached() && inboxes[u].take(post);) posts.push_back(post);
  }
  std::vector<Post> take(PostKind kind) {
    std::vector<Post> found;
    for (const Post& post : posts)
      if (post.kind == kind) found.push_back(post);
    posts.clear();
    return found;
  }
  bool flag_is_up() const {
    for (std::uint32_t u = 0; u < n; ++u)
      if (keeper.alive[u] != 0 && rtpus[u]->segment.block.head().flag != 0) return true;
    return manager->block.head().flag != 0;
  }

  TestApplication& app;
  BetweenLinks between;
  std::uint32_t n = 0;
  DecisionPage decision;
  KeeperPage keeper;
  std::vector<std::unique_ptr<TestRtpu>> rtpus;
  std::unique_ptr<OwnSegment> manager;
  std::vector<Inbox> inboxes;
  std::vector<Post> posts;
  Nanoseconds now;

 private:
  void show(std::uint32_t to, std::uint32_t of) {
    const TestRtpu& rtpu = *rtpus[of];
    EXPECT_TRUE(rtpus[to]->peers->offer(of, rtpu.segment.block.head().incarnation, rtpu.segment.region.descriptor()));
    Doorbell(decision.bells[to].word).ring();
  }
  void show_manager(std::uint32_t to) {
    EXPECT_TRUE(rtpus[to]->peers->offer(n, manager->block.head().incarnation, manager->region.descriptor()));
    inboxes[to] = Inbox(rtpus[to]->segment.block.outbox(n), manager->block.progress(to),
                        rtpus[to]->segment.block.head().incarnation);
    Doorbell(decision.bells[to].word).ring();
  }
};

}  // namespace chimera::testing
