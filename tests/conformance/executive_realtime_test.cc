// SPDX-License-Identifier: Apache-2.0
// The executive on the Linux clock: every release of every task runs or is counted, and values only go forward. Which
// job comes next is proved on the stepped twin of the clock (executors_test.cc, twins_test.cc).
#include <gtest/gtest.h>

#include "chimera/base/testing/await.h"
#include "chimera/runtime/executive/counter_clock.h"
#include "tests/conformance/by_threads.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

TEST(ExecutiveRealtime, RunsOrCountsEveryReleaseOfEveryTask) {
  constexpr std::pair<const char*, int> kTasks[] = {{"fast", 2}, {"middle", 5}, {"slow", 10}};  // and their periods, ms
  Application app;
  app.add("fast", milliseconds(2), microseconds(100));
  app.add("middle", milliseconds(5), microseconds(200), "fast");
  app.add("slow", milliseconds(10), microseconds(300), "middle");
  TaskSet& set = app.build();
  CounterClock clock;
  ComputingClock job_clock(clock);
  Executive executive(set, clock, job_clock, {});
  const auto all_have_run = [&] {
    return std::all_of(std::begin(kTasks), std::end(kTasks),
                       [&](const auto& task) { return app.task(task.first).profile.cycles >= 10; });
  };
  at_the_ceiling([&] {
    ASSERT_TRUE(executive.start());
    for (Nanoseconds until = milliseconds(50); until < kHangLimit && !all_have_run(); until += milliseconds(50))
      EXPECT_EQ(executive.run(until), RunEnd::kTime);
    executive.shut_down();
  });
  for (const auto& [name, period] : kTasks) {
    const std::vector<Call> jobs = app.calls_of(name, Method::kCycle);
    EXPECT_GE(jobs.size(), 10u) << name;
    expect_every_release(jobs, milliseconds(period));
    for (std::size_t i = 1; i < jobs.size(); ++i) EXPECT_GE(jobs[i].in, jobs[i - 1].in) << name;
    record_duration(std::string(name) + "_longest_response", app.task(name).profile.response.max);
  }
}

}  // namespace
}  // namespace chimera::toy
