// SPDX-License-Identifier: Apache-2.0
// A preemptive context that switches among configurations repeatedly: the values that each job read, by its release.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/by_threads.h"

namespace chimera::toy::switch_by_threads {

/// A job of the reader: when it was released, and the value of u that it read.
struct Reading {
  Nanoseconds release;
  double u;
};

/// Records of a run. One run at a time.
struct Seen {
  std::vector<Reading> reader;
  std::vector<SwitchReceipt> receipts;  // their lists are not kept
  std::uint64_t lost = 0;               // of all tasks, in all switches
};
inline Seen seen;
inline Nanoseconds load;  // how long each job of the load computes

inline void compute(Nanoseconds time) {
  const Nanoseconds end = used_by_this_thread() + time;
  while (used_by_this_thread() < end) {
  }
}

struct Reader {
  In<double> u{"u", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle c) {
    *y = *u;
    if (seen.reader.size() < seen.reader.capacity()) seen.reader.push_back({c.now(), *u});
  }
};

struct Load {
  Out<double> done{"done", "1", initial = 0.0};
  void cycle(Cycle) {
    compute(load);
    *done = *done + 1;
  }
};

/// Each producer of u publishes its own number. No task may read the value that a producer writes in `off`.
struct One {
  Out<double> u{"u", "1", initial = 1.0};
  void on(Cycle) { *u = 1; }
  void cycle(Cycle) { *u = 1; }
  void off(Cycle) { *u = -1; }
};
struct Observer {
  In<double> y{"y", "1"};
  Out<double> z{"z", "1", initial = 0.0};
  void cycle(Cycle) { *z = *y; }
};
struct Two {
  In<double> z{"z", "1"};
  Out<double> u{"u", "1", initial = 2.0};
  void on(Cycle) { *u = 2; }
  void cycle(Cycle) { *u = 2; }
  void off(Cycle) { *u = -2; }
};

inline constexpr TaskId kReader{0u}, kLoad{1u}, kOne{2u}, kObserver{3u}, kTwo{4u};
inline const std::vector<TaskId> kSets[] = {{kReader, kLoad, kOne}, {kReader, kLoad, kObserver, kTwo}};
inline const NamedSet kNamedSets[] = {{"one", kSets[0]}, {"two", kSets[1]}};

/// `n` switches, there and back, each after a random time between a half and one and a half of `pause`. The load
/// drawn by `seed`. The load computes half of the time; a switch is over when the job has ended in which it came.
/// The run ends `rest` after the last one is asked for.
inline void run(const ProcessorPlace& place, Nanoseconds period, int n, Nanoseconds pause, unsigned seed,
                Nanoseconds rest) {
  seen = {};
  seen.reader.reserve(static_cast<std::size_t>(n + 2) * static_cast<std::size_t>(pause * 2 / period + 2));
  load = period * 2;
  testing::TestApplication app;
  app.add("reader", testing::component<Reader>("reader"), period);
  app.add("load", testing::component<Load>("load"), period * 4);
  app.add("one", testing::component<One>("one"), period);
  app.add("observer", testing::component<Observer>("observer"), period);
  app.add("two", testing::component<Two>("two"), period);
  for (TaskSpec& task : app.tasks) task.rtpu = RtpuId{0u};
  app.make(kSets[0], false);
  app.spec.sets = kNamedSets;
  ContextPlace context;
  context.preemptive = true;
  const auto set = *HeapTaskSet::create(app.spec, app.components, context);
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int64_t> pauses(pause.count / 2, pause.count * 3 / 2);
  std::vector<ScriptAct> acts;
  Nanoseconds at;
  for (int i = 0; i < n; ++i) {
    at += Nanoseconds{pauses(random)};
    acts.push_back({at, ScriptAct::Kind::kSwitch, Signal::kOn, TaskId()});
    acts.back().set = i % 2 == 0 ? 1 : 0;
  }
  RunOptions options;
  options.script = Script(acts);
  PreemptiveExecutor executor(*set, options, place);
  const auto go = [&] {
    EXPECT_TRUE(executor.start());
    EXPECT_EQ(executor.run(at + rest), RunEnd::kTime);
    executor.shut_down();  // closes the receipt of a switch that is still under way
  };
  if (place.ceiling > 0) at_the_ceiling(go);
  else go();
  for (const SwitchReceipt& receipt : executor.releases().receipts().all()) {
    seen.receipts.push_back(receipt);
    for (const TaskPart& part : receipt.tasks) seen.lost += part.lost;
    seen.receipts.back().tasks = {};
    seen.receipts.back().variables = {};
  }
}

/// Every job of the reader read the task that produces u at its release.
inline void expect_bindings_of_releases() {
  auto receipt = seen.receipts.begin();
  double now = 1;
  for (const Reading& reading : seen.reader) {
    for (; receipt != seen.receipts.end() && (receipt->end != SwitchEnd::kDone || reading.release >= receipt->at);
         ++receipt)
      if (receipt->end == SwitchEnd::kDone) now = receipt->after == 0 ? 1 : 2;
    ASSERT_EQ(reading.u, now) << "released at " << reading.release.count << " ns";
  }
}

/// Runs of ten switches until `enough` of them are done.
inline void run_until_done(const ProcessorPlace& place, Nanoseconds period, Nanoseconds pause, int enough) {
  int done = 0;
  Nanoseconds longest;
  for (unsigned runs = 0; done < enough; ++runs) {
    ASSERT_LT(pause * 10 * runs, kHangLimit) << "hangs";
    run(place, period, 10, pause, runs, pause * 2);
    ASSERT_EQ(seen.receipts.size(), 10u);
    expect_bindings_of_releases();
    for (const SwitchReceipt& receipt : seen.receipts) {
      if (receipt.end != SwitchEnd::kDone) continue;
      ++done;
      longest = std::max(longest, receipt.at - receipt.asked);
    }
    std::printf("%llu cycles lost in run %u\n", static_cast<unsigned long long>(seen.lost), runs);
  }
  record_duration("longest_switch", longest);
}

}  // namespace chimera::toy::switch_by_threads
