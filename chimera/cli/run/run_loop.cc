// SPDX-License-Identifier: Apache-2.0
// Runs an application in slices: in virtual time on one rtpu or on several, or by the real-time executive in this
// process.
#include "chimera/cli/run/run_loop.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

#include "chimera/cli/run/run_verdict.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/thread.h"
#include "chimera/runtime/executive/counter_clock.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/asked_set.h"
#include "chimera/runtime/hosted/background_writer.h"
#include "chimera/runtime/hosted/descriptor_events.h"
#include "chimera/runtime/hosted/refusal_text.h"
#include "chimera/runtime/virtual/virtual_executor.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"

namespace chimera::cli {
namespace {

std::string signal_line(const RefusedSignal& refused, const Task& task, const ApplicationSpec& spec,
                        Nanoseconds origin) {
  const std::string name(task.spec->name);
  std::string why = task.faults.last.text;
  if (refused.why == Refusal::kState) why = std::string("not legal in state ") + state_name(refused.state);
  const bool is_ring = refused.signal == Signal::kWakeup;
  if (is_ring && !task.spec->has_doorbell()) why = "it has no server";
  if (refused.why == Refusal::kIllegalSet) why = "the tasks that would be ON are not a legal set";
  if (refused.why == Refusal::kNotYet) why = "it is not ready yet; ask again";
  if (refused.why == Refusal::kRival) why = "another task that is created has its resource";
  if (refused.why == Refusal::kKeptOff) why = "a task sent it, and an operator turned " + name + " OFF";
  if (refused.why == Refusal::kSwitch) why = under_way_text(spec, refused.set);
  const std::string signal = is_ring ? "ring" : signal_name(refused.signal);
  return refused_line(refused.at - origin, signal + " " + name, why);
}

// "switch --on pid, asked for by task watch: u would have two producers: pid and lqr".
std::string lists_line(const RefusedLists& refused, const ApplicationSpec& spec, Nanoseconds origin) {
  const bool is_of_task = refused.request.by.is_valid();
  const std::string by = is_of_task ? ", asked for by " + control::asked_by(refused.request, spec) : "";
  return refused_line(refused.at - origin, "switch " + lists_text(refused.request.lists, spec) + by, refused.why);
}

}  // namespace

std::vector<std::string> refused_lines(RunLoop& loop, std::span<const Task* const> tasks, const AskedSets& asked,
                                       const ApplicationSpec& spec) {
  std::vector<std::pair<Nanoseconds, std::string>> found;
  for (const RefusedSignal& refused : loop.refused())
    found.emplace_back(refused.at, signal_line(refused, *tasks[refused.task.index], spec, loop.origin()));
  for (const RefusedLists& refused : asked.refused())
    found.emplace_back(refused.at, lists_line(refused, spec, loop.origin()));
  std::ranges::stable_sort(found, {}, [](const auto& one) { return one.first; });
  std::vector<std::string> lines;
  for (auto& [at, line] : found) lines.push_back(std::move(line));
  return lines;
}

std::string who_stopped(std::span<const Task* const> tasks) {
  for (const Task* task : tasks)
    if ((task->spec->on_miss == OnMiss::kStop && task->profile.missed > task->profile.tolerated) ||
        (task->spec->on_overrun == OnMiss::kStop && task->profile.overrun > 0) ||
        (task->spec->on_fault == OnFault::kStop && task->state == State::kError))
      return std::string(task->spec->name);
  return {};
}

namespace {

/// The rtpu that one context in virtual time follows.
const RtpuSpec& followed_rtpu(const Configuration& configuration) {
  return configuration.rtpus()[configuration.tasks().empty() ? 0 : configuration.tasks()[0].rtpu];
}

/// "virtual time, preemptive, seed 3"; with several contexts each rtpu that has tasks.
std::string virtual_time_text(Application& application, const RunRequest& request) {
  const auto how = [&request](const RtpuSpec& rtpu) {
    return std::string(request.preemptive || rtpu.preemptive ? "preemptive" : "non-preemptive");
  };
  std::string text = "virtual time";
  const VirtualPeers* const peers = application.peers();
  if (peers == nullptr) text += ", " + how(followed_rtpu(application.configuration()));
  for (std::size_t r = 0; peers != nullptr && r < peers->spec().rtpus.size(); ++r)
    if (const RtpuSpec& rtpu = peers->spec().rtpus[r]; peers->tasks(RtpuId(r)) != nullptr)
      text += ", " + std::string(rtpu.name) + ": " + how(rtpu);
  if (!request.digest.empty()) text += ", jobs take no time";
  return request.seed ? text + ", seed " + std::to_string(*request.seed) : text;
}

VirtualOptions virtual_options(const RunRequest& request, bool is_preemptive) {
  if (!request.digest.empty()) return {is_preemptive, JobTimes::none(), request.quantum};
  return {is_preemptive, request.seed, request.quantum};
}

/// `Executor` runs one context, or a context for each rtpu.
template <class Executor>
class VirtualLoop final : public RunLoop {
 public:
  template <class Tasks>
  VirtualLoop(Tasks& tasks, bool is_preemptive, Application& application, const RunRequest& request,
              const RunOptions& options)
      : duration_(request.duration),
        description_(virtual_time_text(application, request)),
        executor_(tasks, options, virtual_options(request, is_preemptive)) {}

  Result<void> start() override { return executor_.start(); }
  std::optional<RunEnd> advance(Nanoseconds until) override {
    const bool last = until >= duration_;
    const RunEnd end = last ? executor_.run(duration_) : run_to(until);
    if (end == RunEnd::kTime && !last) return std::nullopt;
    return end;
  }
  Nanoseconds now() const override { return executor_.now() - executor_.origin(); }
  Nanoseconds origin() const override { return executor_.origin(); }
  void shut_down() override { executor_.shut_down(); }
  std::span<const RefusedSignal> refused() override {
    const auto refused = executor_.refused();
    refused_.assign(refused.begin(), refused.end());
    return refused_;
  }
  const SwitchReceipts& receipts() override { return executor_.receipts(); }
  std::string description() const override { return description_; }

 private:
  RunEnd run_to(Nanoseconds until) {
    if constexpr (requires { executor_.run_to(until); }) return executor_.run_to(until);
    else return executor_.run(until);
  }

  const Nanoseconds duration_;
  const std::string description_;
  Executor executor_;
  std::vector<RefusedSignal> refused_;
};

RunOptions in_real_time(RunOptions options, BackgroundWriter& writer, DescriptorEvents& events) {
  options.writer = &writer;
  options.events = &events;
  return options;
}

// The executive has a thread of its own; this side sleeps and looks on.
class RealTimeLoop final : public RunLoop {
 public:
  RealTimeLoop(Application& application, const RunRequest& request, const RunOptions& options)
      : request_(request), cpu_(static_cast<int>(application.configuration().rtpus()[0].cpu)), job_clock_(clock_),
        set_(application.tasks()),
        executive_(set_, clock_, job_clock_, in_real_time(options, application.background_writer(), events_)) {
    const auto rtpus = application.configuration().rtpus();
    if (rtpus.size() > 1)
      grant_ =
          "one process: all tasks in one loop, on the CPU and by the policy of '" + std::string(rtpus[0].name) + "'; ";
  }
  ~RealTimeLoop() override {
    if (thread_.joinable()) thread_.join();
  }

  Result<void> start() override {
    std::promise<Result<void>> started;
    auto answer = started.get_future();
    thread_ = std::thread([this, &started] {
      use_decimal_point();
      const RealtimeRequest wanted{request_.priority, cpu_, true};
      grant_ += enter_realtime(wanted).report.c_str();
      const Result<void> result = start_result(set_, executive_.start());
      started.set_value(result);
      ended_.set_value(result ? executive_.run(request_.duration) : RunEnd::kStopped);
    });
    return answer.get();
  }
  std::optional<RunEnd> advance(Nanoseconds until) override {
    const auto wait = std::chrono::nanoseconds((until - now()).count);
    if (end_.wait_for(wait) == std::future_status::timeout) return std::nullopt;
    ran_ = now();
    thread_.join();
    return end_.get();
  }
  Nanoseconds now() const override { return looking_on_.now() - executive_.origin(); }
  Nanoseconds origin() const override { return executive_.origin(); }
  void shut_down() override { executive_.shut_down(); }
  std::span<const RefusedSignal> refused() override { return executive_.refused(); }
  const SwitchReceipts& receipts() override { return executive_.receipts(); }
  std::string description() const override { return grant_; }

 private:
  const RunRequest& request_;
  int cpu_;
  CounterClock clock_;             // of the executive's thread
  mutable LinuxClock looking_on_;  // of this side
  ComputingClock job_clock_;
  TaskSet& set_;
  DescriptorEvents events_;
  Executive executive_;
  std::string grant_;
  std::promise<RunEnd> ended_;
  std::future<RunEnd> end_ = ended_.get_future();
  Nanoseconds ran_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<RunLoop> make_virtual_loop(Application& application, const RunRequest& request, RunOptions options) {
  const RtpuSpec& followed = followed_rtpu(application.configuration());
  options.policy = followed.policy;
  if (VirtualPeers* const peers = application.peers())
    return std::make_unique<VirtualLoop<VirtualRtpus>>(*peers, request.preemptive, application, request, options);
  const bool is_preemptive = request.preemptive || followed.preemptive;
  return std::make_unique<VirtualLoop<VirtualExecutor>>(application.tasks(), is_preemptive, application, request,
                                                        options);
}

std::unique_ptr<RunLoop> make_real_time_loop(Application& application, const RunRequest& request, RunOptions options) {
  options.policy = application.configuration().rtpus()[0].policy;
  return std::make_unique<RealTimeLoop>(application, request, options);
}

}  // namespace chimera::cli
