// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/run_plan.h"

#include "chimera/cli/files/testing/test_place.h"
#include "chimera/cli/run/run.h"

namespace chimera::cli {
namespace {

const std::string kTight =
    "subsystem: tight\n"
    "tasks:\n"
    "  a: {component: t_counter, rate: 100 Hz, budget: 600 us, deadline: 1 ms}\n"
    "  b: {component: t_counter, rate: 100 Hz, budget: 600 us, deadline: 1 ms, alias: {count: n, dt: b_dt,\n"
    "      now: b_now, deadline: b_deadline, cycles: b_cycles, dropped: b_dropped, illegal: b_illegal}}\n";

/// The text on standard error; "" when the run may begin.
std::string refusal(const std::string& text, RunRequest request = {}) {
  const TestFile file(text);
  request.file = file.path();
  request.priority = 0;
  std::FILE* out = std::tmpfile();
  std::FILE* err = std::tmpfile();
  const auto plan = plan_run(request, test_place(), out, err);
  std::string said;
  std::rewind(err);
  for (int c; (c = std::fgetc(err)) != EOF;) said += static_cast<char>(c);
  std::fclose(out);
  std::fclose(err);
  EXPECT_EQ(plan.has_value(), said.find("error") == std::string::npos) << said;
  return said;
}

RunRequest missing(std::vector<std::string> tasks) {
  RunRequest request;
  request.may_miss = std::move(tasks);
  return request;
}

TEST(RunPlan, RefusesHardTasksThatAreNotGuaranteedTheirDeadlines) {
  const std::string said = refusal(kTight);
  EXPECT_NE(said.find("task 'a' is not guaranteed to keep its deadline of 1 ms on CPU 0: a cycle may take 1.2 ms"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("--may-miss b runs it all the same"), std::string::npos) << said;
}

TEST(RunPlan, RunsTasksThatMayMissIfTheOptionNamesThem) {
  EXPECT_EQ(refusal(kTight, missing({"a", "b"})), "");
  EXPECT_EQ(refusal(kTight, missing({"a"})).find("task 'a' is not"), std::string::npos);
  EXPECT_EQ(refusal(kTight, missing({"a", "b", "see"})), "error: --may-miss: no task 'see'\n");
}

TEST(RunPlan, RefusesAnActAfterTheEndOfTheRun) {
  RunRequest request;
  request.virtual_time = true;
  request.duration = seconds(1);
  request.at = {"5 s: off counter"};
  EXPECT_NE(refusal(kCounterText, request)
                .find("error: --at '5 s: off counter': it comes after the end of the run, which --for gives\n"),
            std::string::npos)
      << refusal(kCounterText, request);
  request.at = {"1 s: off counter"};
  EXPECT_EQ(refusal(kCounterText, request), "");
}

TEST(RunPlan, TakesMeasuresInRealTimeToo) {
  RunRequest request;
  request.expect = {"end count >= 1", "max count <= 3", "settling |dt| <= 2 ms within 1 s"};
  EXPECT_EQ(refusal(kCounterText, request), "");
  request.expect = {"maxi count <= 3"};
  EXPECT_EQ(refusal(kCounterText, request).find("error: --expect 'maxi count <= 3': no measure 'maxi'"), 0u);
}

TEST(RunPlan, AnOptionThatFitsNoDescriptionIsWrongUsage) {
  const TestFile file(kCounterText);
  RunRequest request;
  request.file = file.path();
  request.virtual_time = true;
  request.expect = {"coun > 3"};
  std::FILE* out = std::tmpfile();
  int code = kOk;
  EXPECT_FALSE(plan_run(request, test_place(), out, out, &code));
  EXPECT_EQ(code, kUsage);
  request.file = "/nowhere/at/all.yaml";
  EXPECT_FALSE(plan_run(request, test_place(), out, out, &code));
  EXPECT_EQ(code, kRefused);
  std::fclose(out);
}

TEST(RunPlan, VirtualTimeRunsAnUnschedulableApplication) {
  RunRequest request;
  request.virtual_time = true;
  EXPECT_EQ(refusal(kTight, request), "");
}

TEST(RunPlan, PromisesLessWhereTheKernelLeavesLess) {
  const Library library = test_library();
  const TestFile file("subsystem: s\ntasks:\n  a: {component: t_counter, rate: 1 kHz, budget: 500 us}\n");
  const Verdict verdict = verify(read_description_file(file.path()), library);
  ASSERT_TRUE(verdict.configuration);
  EXPECT_TRUE(admit_below(*verdict.configuration, 0.95));
  const auto refused = admit_below(*verdict.configuration, 0.5);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where.view(), "cpu 0");
  EXPECT_EQ(refused.error().message.view(),
            "the budgets take 0.500 of the processor; of the 0.50 that the kernel leaves to real-time threads at most "
            "0.48 can be promised: set kernel.sched_rt_runtime_us to 950000, sched_rt_period_us to 1000000");
}

}  // namespace
}  // namespace chimera::cli
