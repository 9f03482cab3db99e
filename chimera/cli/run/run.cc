// SPDX-License-Identifier: Apache-2.0
// A run whose tasks are in this process: in virtual time, or in real time for debugging.
#include "chimera/cli/run/run.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <map>
#include <utility>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/run/digest_text.h"
#include "chimera/cli/run/profile_report.h"
#include "chimera/cli/run/progress.h"
#include "chimera/cli/run/run_loop.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/cli/run/run_report.h"
#include "chimera/cli/run/run_session.h"
#include "chimera/cli/run/under_way.h"
#include "chimera/cli/run/watch_plot.h"
#include "chimera/control/receipt/receipt_json.h"
#include "chimera/control/receipt/receipt_text.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/record/tap_ring.h"

namespace chimera::cli {
namespace {

// Stored by a signal handler, loaded by the loops of the run (RunOptions::stop): pairs with nothing.
std::atomic<bool> stop_requested{false};

constexpr Nanoseconds kDrainEvery = milliseconds(10);
constexpr Nanoseconds kWatchEvery = milliseconds(100);  // of the run, to see whether it ended or a line is due
constexpr Nanoseconds kTellEvery = seconds(3);          // of wall time

/// Lines of progress, each over the one before; silent unless `err` is a terminal.
class ProgressLine {
 public:
  ProgressLine(const RunRequest& request, std::FILE* err)
      : all_(request.duration), err_(err), is_on_(request.virtual_time && is_terminal(::fileno(err))) {}

  bool is_on() const noexcept { return is_on_; }
  void show(Nanoseconds done) {
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

/// Tasks in this process. Context: setup.
class LocalTarget final : public RunTarget {
 public:
  LocalTarget(const RunRequest& request, const RunPlan& plan, Application application, RecordSink* sink, std::FILE* out,
              std::FILE* err)
      : request_(request),
        plan_(plan),
        application_(std::move(application)),
        sink_(sink),
        out_(out),
        err_(err),
        progress_(request, err),
        measures_(plan.measures) {}

  Result<void> start() override;
  int refuse(const Error& error) override { return refuse_run(request_, error, out_, err_); }
  std::optional<RunEnd> advance(Nanoseconds until) override;
  Nanoseconds now() const override { return loop_->now(); }
  bool shows_values_at(RunEnd) const override { return true; }
  bool draws(Nanoseconds at) override;
  std::vector<Reading> read(const std::vector<std::string>& names) override;
  void finish(RunReport& report) override;
  bool is_output_complete(const RunReport& report) override;

 private:
  void drain();
  void print_notes();
  std::vector<RtpuFate> fates();
  Nanoseconds sample_every() const {
    const Nanoseconds shortest = sample_distance({}, request_.duration, application_.spec());
    return request_.virtual_time ? shortest : std::max(shortest, milliseconds(1));
  }

  const RunRequest& request_;
  const RunPlan& plan_;
  Application application_;
  RecordSink* sink_;
  std::FILE* out_;
  std::FILE* err_;
  ProgressLine progress_;
  std::unique_ptr<TapRing> ring_;
  std::optional<Tap> tap_;
  TapReader reader_;
  HeapMemory memory_;
  DigestText digest_text_;
  std::optional<Digest> digest_;
  AskedSets asked_{application_.spec(), request_.one_process && !request_.virtual_time};
  std::unique_ptr<RunLoop> loop_;
  Nanoseconds at_;  // to which it has come, since the start
  std::map<std::string, Probe> probes_;
  std::vector<Probe> drawn_;
  WatchPlot plot_;
  std::vector<std::uint64_t> notes_told_;  // by task
  std::vector<Measure> measures_;
  Nanoseconds next_sample_ = kNever;  // of the measures
};

Result<void> LocalTarget::start() {
  RunOptions options;
  options.script = Script(plan_.acts);
  options.asked = &asked_;
  options.stop = &stop_requested;
  if (sink_ != nullptr) {
    ring_ = std::make_unique<TapRing>();
    options.tap = &tap_.emplace(*ring_);
    reader_ = TapReader(*ring_);
  }
  if (!request_.digest.empty())
    options.digest = &digest_.emplace(application_.spec().tasks.size(), digest_text_, memory_);
  loop_ = request_.virtual_time ? make_virtual_loop(application_, request_, options)
                                : make_real_time_loop(application_, request_, options);
  if (auto started = loop_->start(); !started) return started;
  // Now that extents are known.
  if (request_.keeps_samples())
    for (const std::string& name : request_.watch) drawn_.push_back(*application_.probe(name));
  for (Measure& measure : measures_)
    if (auto bound = measure.bind(application_); !bound) return bound;
  if (!measures_.empty()) next_sample_ = sample_every();
  if (!request_.json) std::fprintf(out_, "%s\n", loop_->description().c_str());
  if (request_.virtual_time) print_notes();  // in real time the loop already runs: notes come at the end
  if (sink_ != nullptr) sink_->begin(application_.spec(), loop_->origin(), loop_->origin());
  return {};
}

// The fates of rtpus that the script let die, or that a standby had killed because their tasks were silent.
std::vector<RtpuFate> LocalTarget::fates() {
  std::vector<RtpuFate> fates;
  const VirtualPeers* const peers = application_.peers();
  for (std::size_t r = 0; peers != nullptr && r < application_.spec().rtpus.size(); ++r)
    if (peers->died(RtpuId(r)) != kNever)
      fates.push_back({.name = std::string(application_.spec().rtpus[r].name),
                       .died = peers->died(RtpuId(r)) - loop_->origin()});
  if (!request_.virtual_time)
    fates.push_back({.name = std::string(application_.spec().rtpus[0].name),
                     .not_real_time = not_real_time(loop_->description()).c_str()});
  std::ranges::stable_sort(fates, {}, [](const RtpuFate& fate) { return fate.died.count; });
  return fates;
}

// Prints the notes of components, each once.
void LocalTarget::print_notes() {
  const auto tasks = application_.all_tasks();
  notes_told_.resize(tasks.size());
  for (const Task* task : tasks) {
    if (std::exchange(notes_told_[task->id.index], task->faults.notes) == task->faults.notes || request_.json) continue;
    std::fprintf(out_, "%s\n", note_line(task->spec->name, task->faults.note).c_str());
  }
}

void LocalTarget::drain() {
  if (sink_ == nullptr) return;
  TapRecord records[512];
  for (std::size_t n; (n = reader_.read(records)) > 0;) sink_->on_records({records, n});
}

std::optional<RunEnd> LocalTarget::advance(Nanoseconds until) {
  const bool looks_up = !request_.virtual_time || progress_.is_on();
  for (;;) {
    const Nanoseconds next_drain = sink_ == nullptr ? kNever : at_ + kDrainEvery;
    const Nanoseconds patience = looks_up ? at_ + kWatchEvery : kNever;
    const Nanoseconds next = std::min({until, next_drain, patience, next_sample_});
    const std::optional<RunEnd> end = loop_->advance(next);
    drain();
    at_ = next;
    if (next == next_sample_ || end) {
      for (Measure& measure : measures_) measure.add_sample(end ? std::min(loop_->now(), request_.duration) : at_);
      if (!measures_.empty()) next_sample_ = at_ + sample_every();
    }
    if (progress_.is_on() && !end) progress_.show(at_);
    if (!end && next != until) continue;
    progress_.wipe();
    return end;
  }
}

bool LocalTarget::draws(Nanoseconds at) {
  if (!request_.keeps_samples()) return false;
  plot_.add_sample(at, drawn_);
  return true;
}

std::vector<Reading> LocalTarget::read(const std::vector<std::string>& names) {
  std::vector<Reading> readings;
  std::vector<std::byte> value;
  for (const std::string& name : names) {
    if (!probes_.contains(name)) probes_.emplace(name, *application_.probe(name));
    const Probe& probe = probes_.at(name);
    readings.push_back({probe.sample(), probe.form.unit, probe.read(value) ? value_json(probe.form, value) : "null"});
  }
  return readings;
}

void LocalTarget::finish(RunReport& report) {
  for (const Measure& measure : measures_) {
    RunReport::Judged judged{measure.text(), {}, false};
    judged.holds = measure.holds(judged.said);
    report.expectations.push_back(std::move(judged));
  }
  report.is_flag_up = application_.is_flag_up();
  report.subsystem = plan_.configuration.subsystem();
  report.executor = loop_->description();
  report.origin = loop_->origin();
  const auto tasks = application_.all_tasks();
  const std::vector<State> states = application_.states();
  if (report.end == RunEnd::kTaskStopped) report.stopped_by = who_stopped(tasks);
  for (const std::string& line : refused_lines(*loop_, tasks, asked_, application_.spec())) report.refused += line;
  const Nanoseconds now = loop_->now();
  std::vector<std::uint64_t> faults_before;
  for (const Task* task : tasks) faults_before.push_back(task->faults.count);
  if (digest_) digest_->end();  // without `off` and `kill` at the end
  under_way().running = 0;  // of the run, which is over
  under_way().is_ending = true;
  loop_->shut_down();
  under_way().is_ending = false;
  under_way().running = under_way().serving = 0;
  for (const SwitchReceipt& receipt : loop_->receipts().all()) {  // a switch that the end aborted is among them
    const ApplicationSpec& spec = application_.spec();
    report.switches += control::receipt_text(receipt, spec, loop_->origin());
    const std::string json = control::receipt_json(receipt, spec, loop_->origin());
    if (!json.empty()) append_joined(report.receipts, ", ", json);
  }
  report.receipts_left_out = loop_->receipts().left_out();
  // The profiles contain the cost and the faults of `off` and `kill`, too.
  report.profiles = profiles_of(tasks, states, application_.configuration(), now);
  const std::vector<RtpuFate> units = fates();
  report.verdict = judge_run({report.profiles, faults_before, units, report.is_flag_up, request_.strict});
  if (sink_ != nullptr) {
    drain();
    sink_->end(reader_.lost(), 0);
  }
  print_notes();
}

bool LocalTarget::is_output_complete(const RunReport& report) {
  const auto is_written = [&](const std::string& path, const auto& text) {
    if (path.empty()) return true;
    std::ofstream file(path, std::ios::binary);
    file << text();
    if (file.flush()) return true;
    std::fprintf(err_, "%s: cannot be written: %s\n", path.c_str(), std::strerror(errno));
    return false;
  };
  const bool is_drawn = is_written(request_.svg, [&] { return draw::svg(plot_.plot(report.subsystem)); });
  const bool is_listed = is_written(request_.csv, [&] { return plot_.csv(); });
  return is_written(request_.digest, [&] { return digest_text_.text(application_.spec()); }) && is_drawn && is_listed;
}

}  // namespace

void request_stop() noexcept { stop_requested = true; }

bool stop_is_requested() noexcept { return stop_requested; }

int run(const RunRequest& asked, const Workplace& workplace, RecordSink* sink, std::FILE* out, std::FILE* err) {
  int code = kRefused;
  const auto plan = plan_run(asked, workplace, out, err, &code);
  if (!plan) return code;
  RunRequest request = asked;
  if (request.keeps_samples())
    request.every = sample_distance(request.every, request.duration, plan->configuration.spec());
  const auto contexts = request.virtual_time ? Application::Contexts::kByRtpu : Application::Contexts::kOne;
  auto application = Application::load(plan->configuration, plan->library, contexts);
  if (!application) return refuse_run(request, application.error(), out, err);
  LocalTarget target(request, *plan, *std::move(application), sink, out, err);
  return RunSession(request, plan->expectations, target, out, err).run();
}

}  // namespace chimera::cli
