// SPDX-License-Identifier: Apache-2.0
// `chimera run --virtual` of a description whose tasks are on several rtpus.
#include <set>

#include "chimera/cli/run/run.h"
#include "chimera/cli/run/testing/test_application.h"

namespace chimera::cli::several_rtpus_test {
namespace {

/// The rtpu of each kind of record.
class Tracks final : public RecordSink {
 public:
  void begin(const ApplicationSpec&, Nanoseconds, Nanoseconds) override {}
  void on_records(std::span<const TapRecord> records) override {
    for (const TapRecord& r : records)
      if (r.kind == TapKind::kRun) runs.insert({r.rtpu, r.task.index});
  }
  void end(std::uint64_t lost, std::uint64_t) override { EXPECT_EQ(lost, 0u); }

  std::set<std::pair<std::uint32_t, std::uint32_t>> runs;  // rtpu and task
};

struct Said {
  int code = -1;
  std::string out, err;
};

std::string taken(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
  std::fclose(file);
  return text;
}

// A ramp on one rtpu, read on another one. The ramp's job ends 2 ms after its release.
constexpr const char* kRamp = R"(subsystem: ramp
rtpus: {first: {cpu: 0}, spare: {cpu: 0}, second: {cpu: 1, executor: preemptive, policy: rm}}
tasks:
  source: {component: t_source, rtpu: first, rate: 100 Hz, budget: 2 ms}
  ages: {component: t_ages, rtpu: second, rate: 1 kHz, budget: 100 us}
  counter: {component: t_counter, rtpu: second, rate: 1 kHz, budget: 500 us}
configurations: {all: [source, ages, counter], less: [counter]}
start: all
)";

Said said_by(RunRequest request, const std::string& text = kRamp, RecordSink* sink = nullptr) {
  const TestFile file(text);
  request.file = file.path();
  request.virtual_time = true;
  if (request.duration == kNever) request.duration = milliseconds(40);
  std::FILE* out = std::tmpfile();
  std::FILE* err = std::tmpfile();
  Said said;
  said.code = run(request, test_place(), sink, out, err);
  said.out = taken(out);
  said.err = taken(err);
  return said;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

RunRequest with_act(const char* act) {
  RunRequest request;
  request.at = {act};
  return request;
}

TEST(SeveralRtpus, RunEachOnItsProcessor) {
  RunRequest request;
  request.expect = {"y >= 0.0399", "age >= 7 ms", "valid >= 1", "count >= 40"};
  request.watch = {"x", "age"};
  request.every = milliseconds(11);
  Tracks tracks;
  const Said said = said_by(request, kRamp, &tracks);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_TRUE(has(said.out, "virtual time, first: non-preemptive, second: preemptive\n")) << said.out;
  EXPECT_TRUE(has(said.out, "t 0.011 s  x 0.01  age 0.008 s\n")) << said.out;
  EXPECT_TRUE(has(said.out, "clean: no deadline missed")) << said.out;
  const std::set<std::pair<std::uint32_t, std::uint32_t>> each = {{0, 0}, {2, 1}, {2, 2}};
  EXPECT_EQ(tracks.runs, each);
  EXPECT_EQ(said_by(request).out, said.out) << "each run gives equal bytes";
}

TEST(SeveralRtpus, TheReportNamesTheRtpuOfEachTask) {
  RunRequest request;
  request.json = true;
  request.preemptive = true;
  request.seed = 7;
  const Said said = said_by(request);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_TRUE(has(said.out, "\"executor\": \"virtual time, first: preemptive, second: preemptive, seed 7\""))
      << said.out;
  EXPECT_TRUE(has(said.out, "\"task\": \"source\", \"component\": \"t_source\", \"rtpu\": \"first\"")) << said.out;
  EXPECT_TRUE(has(said.out, "\"task\": \"ages\", \"component\": \"t_ages\", \"rtpu\": \"second\"")) << said.out;
}

TEST(SeveralRtpus, ActsReachEveryRtpu) {
  RunRequest request = with_act("15 ms: off source");
  request.expect = {"illegal >= 1", "x >= 0.02", "x <= 0.02"};
  const Said said = said_by(request);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_TRUE(has(said.out, "the illegal-configuration flag is up\n")) << said.out;
  EXPECT_TRUE(has(said.out, "source   OFF ")) << said.out;
}

TEST(SeveralRtpus, TheOthersGoOnWhenOneDies) {
  RunRequest request = with_act("11 ms: die first");  // its second job is under way
  request.at.push_back("20 ms: on source");
  request.expect = {"x <= 0.01", "age >= 36 ms", "illegal >= 1", "count >= 40"};
  const Said said = said_by(request);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_TRUE(has(said.out, "source   ERROR               1 ")) << said.out;
  EXPECT_TRUE(has(said.out, "first died at 0.011 s and is not restarted")) << said.out;
  EXPECT_TRUE(has(said.out, "refused at 0.020 s: on source: not legal in state ERROR")) << said.out;
  EXPECT_FALSE(has(said.out, "FAILED")) << said.out;
  request.strict = true;
  EXPECT_EQ(said_by(request).code, kRefused);
}

TEST(SeveralRtpus, AnActThatCannotBeDoneIsRefusedBeforeAnythingRuns) {
  const auto refusal = [](const char* act, const std::string& text = kRamp) {
    const Said said = said_by(with_act(act), text);
    EXPECT_EQ(said.code, kUsage) << act;
    EXPECT_TRUE(has(said.err, "--at '")) << said.err;
    return said.err.substr(said.err.find("--at '"));
  };
  EXPECT_EQ(refusal("5 ms: die secnd"), "--at '5 ms: die secnd': no rtpu 'secnd'; did you mean 'second'?\n");
  EXPECT_EQ(refusal("5 ms: die spare"), "--at '5 ms: die spare': no task is on that rtpu\n");
  EXPECT_EQ(refusal("5 ms: die main", kCounterText),
            "--at '5 ms: die main': an rtpu dies in virtual time only (--virtual), where tasks are on several rtpus\n");
}

TEST(SeveralRtpus, SwitchToAnotherConfigurationTogether) {
  const Said said = said_by(with_act("5 ms: switch less"));
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_TRUE(has(said.out, "\nswitch 1 at 0.005 s from 'all' to 'less' after ")) << said.out;
  EXPECT_TRUE(has(said.out, ": 0 tasks arrive, 2 leave, 0 cycles lost\n")) << said.out;
}

TEST(SeveralRtpus, SwitchToTheSetThatNamedTasksLeadTo) {
  RunRequest request = with_act("5 ms: switch --off ages");
  request.at.insert(request.at.end(), {"15 ms: switch --off counter --on source", "20 ms: switch --on ages",
                                       "24 ms: switch --on ages", "25 ms: switch --off source ages",
                                       "30 ms: switch --off source --on ages"});
  const Said said = said_by(request);
  EXPECT_EQ(said.code, kOk) << said.out << said.err;
  EXPECT_TRUE(has(said.out, "\nrefused at 0.025 s: switch --off source ages: no task would be ON\n"
                            "refused at 0.030 s: switch --on ages --off source: x would have no producer\n"
                            "switch 1 at 0.005 s from 'all' to other tasks after ")) << said.out;
  EXPECT_TRUE(has(said.out, "\nswitch 2 at 0.015 s to other tasks after ")) << said.out;
  EXPECT_TRUE(has(said.out, "\nswitch 3 at 0.020 s to other tasks after ")) << said.out;
  EXPECT_TRUE(has(said.out, "\nswitch at 0.024 s: these tasks are in force, nothing to do\n")) << said.out;
}

}  // namespace
}  // namespace chimera::cli::several_rtpus_test
