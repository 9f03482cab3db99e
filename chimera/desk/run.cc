// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/run.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <utility>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/desk/profile_report.h"
#include "chimera/desk/progress.h"
#include "chimera/desk/run_loop.h"
#include "chimera/desk/run_plan.h"
#include "chimera/desk/run_report.h"
#include "chimera/desk/under_way.h"
#include "chimera/desk/watch_plot.h"
#include "chimera/platform/standard_output.h"
#include "chimera/platform/terminal.h"
#include "chimera/runtime/tap_ring.h"

namespace chimera::desk {
namespace {

std::atomic<bool> stop_requested{false};

constexpr Nanoseconds kDrainEvery = milliseconds(10);
constexpr Nanoseconds kWatchEvery = milliseconds(100);  // of the run, to see whether it ended or a line is due
constexpr Nanoseconds kTellEvery = seconds(3);          // of wall time

/// Lines of progress, each over the one before; silent unless somebody can see them.
class ProgressLine {
 public:
  ProgressLine(const RunRequest& request, std::FILE* err)
      : all_(request.duration), err_(err), is_on_(request.virtual_time && is_terminal(::fileno(err))) {}

  bool is_on() const noexcept { return is_on_; }
  void look(Nanoseconds done) {
    const Nanoseconds wall = spent();
    if (wall < next_) return;
    std::fprintf(err_, "\r%s\033[K", progress_text(done, all_, wall).c_str());
    std::fflush(err_);
    next_ = wall + kTellEvery;
    has_written_ = true;
  }
  void wipe() {
    if (has_written_) std::fputs("\r\033[K", err_);
    has_written_ = false;
  }

 private:
  Nanoseconds spent() const {
    return Nanoseconds{std::chrono::nanoseconds(std::chrono::steady_clock::now() - begin_).count()};
  }
  Nanoseconds all_, next_ = kTellEvery;
  std::FILE* err_;
  bool is_on_;
  bool has_written_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// One run with everything that is watched and expected of it.
class Session {
 public:
  Session(const RunRequest& request, const RunPlan& plan, Application application, RecordSink* sink, std::FILE* out,
          std::FILE* err)
      : request_(request), plan_(plan), application_(std::move(application)), sink_(sink), out_(out), err_(err) {}

  Result<void> start();
  RunEnd run();
  int report(RunEnd end);

 private:
  void drain();
  void tell_notes();
  void watch_line(Nanoseconds at);
  bool write_plot() const;

  const RunRequest& request_;
  const RunPlan& plan_;
  Application application_;
  RecordSink* sink_;
  std::FILE* out_;
  std::FILE* err_;
  std::unique_ptr<TapRing> ring_;
  std::optional<Tap> tap_;
  TapReader reader_;
  std::unique_ptr<RunLoop> loop_;
  std::vector<Probe> watched_;
  WatchPlot plot_;
  std::vector<std::uint64_t> notes_told_;  // by task
  Nanoseconds ran_;
};

Result<void> Session::start() {
  RunOptions options;
  options.policy = followed_rtpu(plan_.configuration, request_.virtual_time).policy;
  options.script = Script(plan_.acts);
  options.stop = &stop_requested;
  if (sink_ != nullptr) {
    ring_ = std::make_unique<TapRing>();
    options.tap = &tap_.emplace(*ring_);
    reader_ = TapReader(*ring_);
  }
  loop_ = request_.virtual_time ? make_virtual_loop(application_, request_, options)
                                : make_real_time_loop(application_, request_, options);
  if (auto started = loop_->start(); !started) return started;
  // Now that extents are known.
  for (const std::string& name : request_.watch) watched_.push_back(*application_.probe(name));
  if (!request_.json) std::fprintf(out_, "%s\n", loop_->description().c_str());
  if (request_.virtual_time) tell_notes();  // else the loop runs by now: they are told at the end
  if (sink_ != nullptr) sink_->begin(application_.tasks().spec(), loop_->origin(), loop_->origin());
  return {};
}

// What components have to say beside their values, once each.
void Session::tell_notes() {
  const auto tasks = application_.tasks().tasks();
  notes_told_.resize(tasks.size());
  for (const Task& task : tasks) {
    if (std::exchange(notes_told_[task.id.index], task.faults.notes) == task.faults.notes || request_.json) continue;
    std::fprintf(out_, "%s\n", note_line(task.spec->name, task.faults.note).c_str());
  }
}

void Session::drain() {
  if (sink_ == nullptr) return;
  TapRecord records[512];
  for (std::size_t n; (n = reader_.read(records)) > 0;) sink_->take({records, n});
}

void Session::watch_line(Nanoseconds at) {
  if (!request_.svg.empty()) return plot_.take(at, watched_);
  if (watched_.empty() || request_.json) return;
  std::string line = "t " + [at] {
    char text[32];
    std::snprintf(text, sizeof text, "%.3f s", to_seconds(at));
    return std::string(text);
  }();
  std::vector<std::byte> value;
  for (const Probe& probe : watched_)
    line += "  " + probe.name + " " + (probe.read(value) ? value_text(probe.form, value) : "not written yet");
  std::fprintf(out_, "%s\n", plain_line(line).c_str());
  (void)flush_and_look(out_);
}

bool Session::write_plot() const {
  if (request_.svg.empty()) return true;
  std::ofstream file(request_.svg, std::ios::binary);
  file << draw::svg(plot_.plot(plan_.configuration.subsystem()));
  if (file.flush()) return true;
  std::fprintf(err_, "%s: cannot be written: %s\n", request_.svg.c_str(), std::strerror(errno));
  return false;
}

RunEnd Session::run() {
  Nanoseconds next_watch = watched_.empty() ? kNever : request_.every;
  ProgressLine progress(request_, err_);
  for (Nanoseconds at;;) {
    const Nanoseconds next_drain = sink_ == nullptr ? kNever : at + kDrainEvery;
    const bool looks_up = !request_.virtual_time || progress.is_on();
    const Nanoseconds patience = looks_up ? at + kWatchEvery : kNever;
    const Nanoseconds next = std::min({next_watch, next_drain, patience, request_.duration});
    const std::optional<RunEnd> end = loop_->advance(next);
    drain();
    at = next;
    if (progress.is_on() && !end) progress.look(at);
    if (end || next == next_watch) progress.wipe();
    if (end || next == next_watch) watch_line(end && *end != RunEnd::kTime ? loop_->now() : next);
    if (next == next_watch) next_watch += request_.every;
    if (end) {
      ran_ = std::min(loop_->now(), request_.duration);
      return *end;
    }
  }
}

int Session::report(RunEnd end) {
  RunReport report{.end = end,
                   .stopped_by = {},
                   .is_flag_up = application_.tasks().flag().is_up(),
                   .ran = ran_,
                   .subsystem = plan_.configuration.subsystem(),
                   .executor = loop_->description(),
                   .refused = {},
                   .profiles = {},
                   .origin = loop_->origin(),
                   .variables = {},
                   .expectations = {},
                   .verdict = {}};
  for (const Expectation& expectation : plan_.expectations)
    report.judge(expectation, application_.probe(expectation.variable())->look());
  std::vector<std::byte> value;
  for (const Probe& probe : watched_)
    report.variables.push_back(
        {probe.name, probe.form.unit, probe.read(value) ? value_json(probe.form, value) : "null"});
  const std::vector<State> states = states_of(application_.tasks());
  if (end == RunEnd::kTaskStopped) report.stopped_by = who_stopped(application_.tasks());
  for (const RefusedSignal& r : loop_->refused())
    report.refused += refused_line(r, application_.tasks().tasks()[r.task.index], loop_->origin());
  const Nanoseconds now = loop_->now();
  std::vector<std::uint64_t> faults_before;
  for (const Task& task : application_.tasks().tasks()) faults_before.push_back(task.faults.count);
  under_way().running = 0;  // of the run, which is over
  under_way().is_ending = true;
  loop_->shut_down();
  under_way().is_ending = false;
  under_way().running = under_way().serving = 0;
  // What `off` and `kill` cost, and their faults, too.
  report.profiles = profiles_of(application_.tasks(), states, application_.configuration(), now);
  report.verdict = judge_run({report.profiles, faults_before, {}, report.is_flag_up, request_.strict});
  if (sink_ != nullptr) {
    drain();
    sink_->end(reader_.lost(), 0);
  }
  tell_notes();
  print(report, request_.json, out_);
  (void)flush_and_look(out_);
  return write_plot() && save_profile(report, request_.profile, err_) ? report.code() : kRefused;
}

}  // namespace

void request_stop() noexcept { stop_requested = true; }

bool stop_is_requested() noexcept { return stop_requested; }

int run(const RunRequest& request, const Workplace& workplace, RecordSink* sink, std::FILE* out, std::FILE* err) {
  int code = kRefused;
  const auto plan = plan_run(request, workplace, out, err, &code);
  if (!plan) return code;
  auto application = Application::load(plan->configuration, plan->library);
  if (!application) return refuse_run(request, application.error(), out, err);
  Session session(request, *plan, *std::move(application), sink, out, err);
  if (auto started = session.start(); !started) return refuse_run(request, started.error(), out, err);
  return session.report(session.run());
}

}  // namespace chimera::desk
