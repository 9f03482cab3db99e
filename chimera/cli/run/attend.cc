// SPDX-License-Identifier: Apache-2.0
// A run whose tasks are in processes of their own, watched over the control protocol.
#include "chimera/cli/run/attend.h"

#include <algorithm>
#include <csignal>
#include <map>
#include <optional>
#include <utility>

#include "chimera/analysis/task_profile.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/blanks.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/live/channel.h"
#include "chimera/cli/print/not_ready.h"
#include "chimera/cli/run/control_line.h"
#include "chimera/cli/run/measure_line.h"
#include "chimera/cli/run/profile_report.h"
#include "chimera/cli/run/record_line.h"
#include "chimera/cli/run/run_report.h"
#include "chimera/cli/run/run_session.h"
#include "chimera/cli/run/script_text.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/process.h"
#include "chimera/platform/process_state.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/json.h"
#include "chimera/text/json_text.h"

namespace chimera::cli {
namespace {

constexpr Nanoseconds kLookEvery = milliseconds(100);  // for what has happened, and whether to stop
constexpr Nanoseconds kStartLook = milliseconds(5);
constexpr Nanoseconds kStartPatience = seconds(20), kStartAnswer = milliseconds(500);  // of a manager that starts
constexpr Nanoseconds kSwitchLimit = seconds(15);  // what is not committed within 10 s is aborted
constexpr std::size_t kEventsAtOnce = 1000;
constexpr Nanoseconds kLastOutput = seconds(1);  // half of the time that the keeper waits for the run client to finish
constexpr Nanoseconds kFilingLimit = milliseconds(500);  // until the disk has the last receipts
constexpr Nanoseconds kEndLimit = seconds(600);  // the keeper ends a process that takes too long: not judged here

Nanoseconds instant(const Json& json) { return json.is_number() ? Nanoseconds{json.as_int64()} : kNever; }

Seen seen_of(const Json& reading) {
  Seen seen;
  seen.is_written = truth_at(reading, "valid");
  seen.text = text_at(reading, "text");
  if (!seen.is_written) return seen;
  for (const ChannelNumber& number : numbers_of(reading["value"], "")) seen.numbers.push_back(number.value);
  return seen;
}

/// Tasks in processes of their own. Context: setup.
class RemoteTarget final : public RunTarget {
 public:
  RemoteTarget(const AttendRequest& request, std::vector<Measure> measures, RecordSink* sink, std::FILE* out,
               std::FILE* err)
      : request_(request),
        run_(request.run),
        sink_(sink),
        out_(out),
        err_(err),
        line_(request.socket),
        measured_(request.socket, std::move(measures)),
        page_(request.page == nullptr ? own_page_ : *request.page),
        is_resumed_(page_.has_begun != 0) {}

  /// Refuses when the tasks will not be ON.
  Result<void> start() override;
  int refuse(const Error& error) override;
  std::optional<RunEnd> advance(Nanoseconds until) override;
  Nanoseconds now() const override { return clock_.now() - started_; }
  Nanoseconds printed_until() const override { return is_resumed_ ? now() : Nanoseconds{}; }
  bool shows_values_at(RunEnd end) const override { return end == RunEnd::kStopped; }
  bool draws(Nanoseconds) override { return false; }
  std::vector<Reading> read(const std::vector<std::string>& names) override;
  void finish(RunReport& report) override;
  bool is_output_complete(const RunReport& report) override;

 private:
  Result<Json> await_status();
  Result<void> know_tasks(const Json& status);
  void print_grants(const Json& status);
  void poll_events();
  void on_event(const Json& event);
  void take_back_failure();  // that came behind the start
  void check_output();
  std::string finish_log() { return request_.log == nullptr ? "" : request_.log->finish(kFilingLimit); }
  void act_next();
  void act(const TimedAct& timed);
  void switch_to(const TimedAct& timed);
  void add_receipts(const Json& origin_ns, RunReport& report);
  std::vector<RtpuFate> rtpus_of(const Json& status) const;
  std::vector<TaskProfile> profiles(const Json& origin);
  std::optional<Json> await_end();
  void judge_end(RunReport& report, const Json& status);

  const AttendRequest& request_;
  const RunRequest& run_;
  RecordSink* sink_;
  std::FILE* out_;
  std::FILE* err_;
  ControlLine line_;
  MeasureLine measured_;
  mutable LinuxClock clock_;
  TaskNames names_;
  std::vector<TimedAct> acts_;
  std::optional<RecordLine> records_;
  std::string grants_, refused_, switches_;
  FacePage own_page_;  // of one that has no predecessors
  FacePage& page_;
  const bool is_resumed_;         // an earlier run client, which died, had begun
  std::optional<Error> failure_;  // of the start
  Json failed_;                   // its event
  Nanoseconds started_ = kNever, next_look_;
  std::uint64_t next_event_ = 0;
  bool has_answered_ = false;  // the manager has answered once: only then its status at the end is awaited
  bool task_stopped_ = false;
  std::string stopped_by_;
  std::vector<NotOff> not_off_;
  std::map<std::string, Nanoseconds> restarted_;  // by rtpu, the last time: maybe before the start is known
};

Result<void> RemoteTarget::start() {
  Json last = Json::object();
  const Nanoseconds until = run_.start_limit == kNever ? kNever : clock_.now() + run_.start_limit;
  for (bool is_last = false; !is_last;) {
    ++page_.beats;
    is_last = stop_is_requested();  // also then: it may have started long ago
    auto status = await_status();
    if (!status) return status.error();
    // A failure before the start wins, even if the start event arrived in the same poll.
    started_ = instant((*status)["started_ns"]);
    poll_events();
    if (failure_ && started_ == kNever) {  // it may have started, and failed only then, since the status was asked
      if (status = await_status(); !status) return status.error();
      started_ = instant((*status)["started_ns"]);
      take_back_failure();
    }
    if (failure_) return *failure_;
    last = *status;
    if (started_ != kNever) {
      print_grants(*status);
      page_.has_begun = 1;
      next_look_ = is_resumed_ ? clock_.now() : started_;
      return know_tasks(*status);
    }
    if (clock_.now() >= until) {
      const std::string why =
          formatted("not ON after %g s (--start-limit): ", to_seconds(run_.start_limit)) + not_ready(*status);
      return Error{ErrorCode::kRefused, std::string_view(why), {}};
    }
    clock_.wait_until(clock_.now() + kStartLook);
  }
  const std::string why = "ended before its tasks were ON: " + not_ready(last);
  return Error{ErrorCode::kRefused, std::string_view(why), {}};
}

/// Waits for a manager that starts, unless the run is ended: it may never come.
Result<Json> RemoteTarget::await_status() {
  const Nanoseconds until = clock_.now() + kStartPatience;
  for (;;) {
    const bool is_ended = stop_is_requested(), is_last = is_ended || clock_.now() >= until;
    ++page_.beats;
    auto status = line_.ask("status", Json::object(), kStartAnswer);
    if (status) has_answered_ = true;
    if (status || status.error().code != ErrorCode::kSystem) return status;
    if (is_ended && !has_answered_) return Error{ErrorCode::kRefused, {"ended before its manager answered"}, {}};
    if (is_last) return status;
    clock_.wait_until(clock_.now() + kStartLook);
  }
}

Result<void> RemoteTarget::know_tasks(const Json& status) {
  names_ = TaskNames::of(status);
  if (!run_.at.empty()) {
    const auto described = line_.ask("describe", Json::object());
    if (!described) return described.error();
    names_.add_configurations(*described);
  }
  auto acts = parse_script(run_.at, names_.spec());
  if (!acts) return acts.error();
  acts_ = *std::move(acts);
  if (const auto begun = measured_.begin(started_); !begun) return begun;
  if (sink_ == nullptr) return {};
  sink_->begin(names_.spec(), instant(status["origin_ns"]), kNever);
  records_.emplace(request_.socket, names_);
  return records_->subscribe(RecordLine::From::kOldest);
}

/// The lines of a warning behind each other.
std::string in_one_line(std::string grant) {
  for (std::size_t at; (at = grant.find("\n  ")) != grant.npos;) grant.replace(at, 3, "; ");
  return grant;
}

void RemoteTarget::print_grants(const Json& status) {
  const Json& rtpus = status["rtpus"];
  for (const Json& rtpu : rtpus) {
    const std::string grant = for_terminal(text_at(rtpu, "grant"));
    const std::string name = rtpus.size() == 1 ? "" : text_at(rtpu, "name") + ": ";
    append_joined(grants_, "; ", name + in_one_line(grant));
    if (!run_.json && !is_resumed_) std::fprintf(out_, "%s%s\n", name.c_str(), grant.c_str());
  }
  if (!run_.json && is_resumed_)
    std::fprintf(out_, "(the process that prints this died of %s and was replaced)\n",
                 std::string(signal_text(page_.last_signal).view()).c_str());
  else if (!run_.json && run_.duration == kNever)
    std::fputs("running until Ctrl-C; `chimera top` in another terminal shows the tasks\n", out_);
  std::fflush(out_);
}

/// Before the start a task that cannot be made, or an `on` refused, is the end of it.
void RemoteTarget::poll_events() {
  for (bool is_all = false; !is_all;) {
    const auto answer = line_.ask("events", {{"since", next_event_}, {"limit", kEventsAtOnce}});
    if (!answer) return;
    is_all = (*answer)["events"].size() < kEventsAtOnce;
    for (const Json& event : (*answer)["events"]) on_event(event);
  }
  page_.events_seen = std::max<std::uint64_t>(page_.events_seen, next_event_);
}

/// Reports once that standard output or the log is lost; the run goes on.
void RemoteTarget::check_output() {
  if (request_.log != nullptr) request_.log->report_loss(err_);
  const int why = request_.outlet == nullptr ? 0 : request_.outlet->why_lost();
  if (why == 0 || page_.lost_output != 0) return;
  page_.lost_output = why;
  std::fprintf(err_, "standard output is lost (%s): the run goes on, and its exit code is 1\n", why_lost_text(why));
  if (request_.keeper > 0) (void)signal_parent(request_.keeper, SIGUSR2);
}

void RemoteTarget::take_back_failure() {
  if (instant(failed_["at_ns"]) < started_) return;
  failure_.reset();
  const std::uint64_t next = next_event_;
  on_event(failed_);
  next_event_ = next;
}

void RemoteTarget::on_event(const Json& event) {
  next_event_ = event["number"].as_uint64() + 1;
  const std::string kind = text_at(event, "kind"), text = text_at(event, "text");
  const std::string task = text_at(event, "task");
  const bool is_refusal = kind == "refused" || kind == "fault" || kind == "rtpu-given-up";
  if (is_refusal && instant(event["at_ns"]) < started_ && !failure_)
    failed_ = event, failure_ = Error{ErrorCode::kRefused, std::string_view(text), std::string_view(task)};
  else if (kind == "refused")
    refused_ += refused_line(instant(event["at_ns"]) - started_, task, text);
  if (kind == "rtpu-restarted" && event["rtpu"].is_string())
    restarted_[event["rtpu"].as_string()] = instant(event["at_ns"]);
  const bool is_news = next_event_ > page_.events_seen;
  if (is_news && request_.log != nullptr) request_.log->add(event);
  if (kind == "note" && !run_.json && is_news) std::fprintf(out_, "%s\n", note_line(task, text).c_str());
  if (kind == "not-off") not_off_.push_back({task, text});
  if ((kind == "switch" && !text.ends_with(": begun")) || kind == "bump") switches_ += text + "\n";
  if (kind != "stop" || task_stopped_) return;
  task_stopped_ = true;
  stopped_by_ = task;
}

/// Carries out the next act. An act that an earlier run client began before it died is not repeated.
void RemoteTarget::act_next() {
  const TimedAct& timed = acts_[page_.acts_begun++];
  act(timed);
  ++page_.acts_done;
}

void RemoteTarget::switch_to(const TimedAct& timed) {
  const auto names = [this](const TaskBits& tasks) {
    Json list = Json::array();
    for (std::size_t t = 0; t < names_.tasks.size(); ++t)
      if (tasks.has(TaskId(t))) list.push_back(names_.tasks[t]);
    return list;
  };
  Json asked = Json::object();
  if (!timed.has_lists()) asked["configuration"] = timed.text.substr(timed.text.rfind(' ') + 1);
  if (timed.lists.plus != TaskBits{}) asked["on"] = names(timed.lists.plus);
  if (timed.lists.minus != TaskBits{}) asked["off"] = names(timed.lists.minus);
  const auto answer = line_.ask("switch", asked, kSwitchLimit);
  if (!answer) {
    const std::string what = timed.has_lists() ? trimmed(timed.text.substr(timed.text.find(':') + 1)) : "";
    refused_ += refused_line(now(), what, answer.error().message.c_str());
  } else if (text_at(*answer, "end") == "nothing-to-do") {
    const std::string to = text_at(*answer, "to");
    const std::string what = to.empty() ? "these tasks are" : "'" + to + "' is";
    switches_ += "switch at " + seconds_text(now()) + " s: " + what + " in force, nothing to do\n";
  }
}

void RemoteTarget::act(const TimedAct& timed) {
  const ScriptAct& act = timed.act;
  if (act.kind == ScriptAct::Kind::kSwitch) return switch_to(timed);
  const bool is_set = act.kind == ScriptAct::Kind::kSet;
  const bool is_signal = act.kind == ScriptAct::Kind::kSignal;
  const std::string task = is_signal ? names_.tasks[act.task.index] : "";
  const bool is_ring = is_signal && act.signal == Signal::kWakeup;
  const auto answer = is_ring     ? line_.ask("ring", {{"tasks", {task}}})
                      : is_signal ? line_.ask("signal", {{"signal", signal_name(act.signal)}, {"tasks", {task}}})
                      : is_set    ? line_.ask("set", {{"values", {{timed.variable, timed.value}}}})
                                  : line_.ask("flag", {{"up", act.kind == ScriptAct::Kind::kRaiseFlag}});
  if (answer) return;
  const std::string what = is_signal ? std::string(is_ring ? "ring" : signal_name(act.signal)) + " " + task
                           : is_set  ? "set " + timed.variable
                                     : "flag";
  refused_ += refused_line(now(), what, answer.error().message.c_str());
}

std::vector<Reading> RemoteTarget::read(const std::vector<std::string>& names) {
  Json values;
  if (!names.empty())
    if (const auto answer = line_.ask("get", {{"variables", names}}); answer) values = (*answer)["values"];
  std::vector<Reading> readings;
  for (const std::string& name : names) {
    const Json& reading = std::as_const(values)[name];
    readings.push_back({seen_of(reading), text_at(reading, "unit", "1"), reading["value"].dump()});
  }
  return readings;
}

std::optional<RunEnd> RemoteTarget::advance(Nanoseconds until) {
  const bool is_last = until == run_.duration;
  const Nanoseconds end = until == kNever ? kNever : started_ + until;
  for (;;) {
    const std::size_t next_act = page_.acts_begun;
    const Nanoseconds act_at = next_act < acts_.size() ? started_ + acts_[next_act].act.at : kNever;
    const Nanoseconds next = std::min({next_look_, act_at, end});
    ++page_.beats;
    while (clock_.now() < next && !stop_is_requested()) {
      const bool measures = measured_.is_needed();
      const Nanoseconds turn = records_ && measures ? std::min(next, clock_.now() + milliseconds(10)) : next;
      if (records_) records_->poll(turn, *sink_);
      if (measures) measured_.poll(turn);
      if (!records_ && !measures) clock_.wait_until(next);
    }
    if (stop_is_requested()) return RunEnd::kStopped;
    if (next == act_at) act_next();
    if (next == end && !is_last) return std::nullopt;  // the values are shown first
    if (next == next_look_) {
      poll_events();
      check_output();
      next_look_ += kLookEvery;
    }
    if (task_stopped_) return RunEnd::kTaskStopped;
    if (next == end) return RunEnd::kTime;
  }
}

std::vector<RtpuFate> RemoteTarget::rtpus_of(const Json& status) const {
  std::vector<RtpuFate> rtpus;
  for (const Json& json : status["rtpus"]) {
    RtpuFate rtpu{text_at(json, "name"),
                  static_cast<std::uint64_t>(whole_at(json, "restarts")),
                  kNever, truth_at(json, "given_up"), {}, text_at(json, "not_real_time")};
    if (const auto at = restarted_.find(rtpu.name); at != restarted_.end() && started_ != kNever)
      rtpu.restarted = at->second - started_;
    rtpus.push_back(std::move(rtpu));
  }
  return rtpus;
}

std::vector<TaskProfile> RemoteTarget::profiles(const Json& origin) {
  const auto answer = line_.ask("profile", Json::object());
  if (!answer) return {};
  const auto tasks = read_profiles((*answer)["tasks"], instant(origin));
  return tasks ? *tasks : std::vector<TaskProfile>();
}

/// An rtpu that lives and does not run counts too: its tasks may be ON.
bool any_lives(const Json& status) {
  const Json& rtpus = status["rtpus"];
  return std::any_of(rtpus.begin(), rtpus.end(),
                     [](const Json& rtpu) { return truth_at(rtpu, "alive") || rtpu["hang"].is_string(); });
}

/// Asks the keeper to turn the tasks off and kill them, and reads all events until then. Returns the status after it.
std::optional<Json> RemoteTarget::await_end() {
  if (request_.keeper > 0) (void)signal_parent(request_.keeper, SIGUSR1);
  if (!has_answered_) return std::nullopt;
  auto after = line_.ask("status", Json::object());
  for (const Nanoseconds until = clock_.now() + kEndLimit; after && any_lives(*after) && clock_.now() < until;) {
    clock_.wait_until(clock_.now() + kStartLook);
    after = line_.ask("status", Json::object());
  }
  poll_events();
  return after ? std::optional<Json>(*after) : std::nullopt;
}

/// Takes what the last methods of the tasks left: what fails there belongs to the run.
void RemoteTarget::judge_end(RunReport& report, const Json& before) {
  std::vector<RtpuFate> rtpus = rtpus_of(before);
  std::vector<std::uint64_t> faults;
  for (const TaskProfile& task : report.profiles) faults.push_back(task.faults.count);
  const auto after = await_end();
  const auto ended = after ? profiles(before["origin_ns"]) : std::vector<TaskProfile>();
  for (std::size_t t = 0; t < std::min(ended.size(), report.profiles.size()); ++t) {
    TaskProfile& task = report.profiles[t];  // cycles and misses are those up to the end of the run
    task.faults = ended[t].faults;
    for (const int method : {CHIMERA_OFF, CHIMERA_KILL, CHIMERA_ERROR})
      task.profile.execution[method] = ended[t].profile.execution[method];
  }
  for (std::size_t r = 0; after && r < rtpus.size(); ++r) {
    const Json& was = before["rtpus"][r];
    const Json end = (*after)["rtpus"][r]["last_end"];
    const bool is_new = truth_at(was, "alive") && end.is_string() && end != was["last_end"];
    if (is_new && end != "ended with status 0") rtpus[r].bad_end = end.as_string();
  }
  report.verdict = judge_run({report.profiles, faults, rtpus, report.is_flag_up, run_.strict, not_off_});
  if (page_.deaths > 0)
    report.verdict.remarks.push_back("the process that prints and ends the run died " + counted(page_.deaths, "time"));
  if (const std::uint32_t lost = page_.acts_begun - page_.acts_done; lost > 0)
    report.verdict.failures.push_back(
        "it is not known whether " + std::to_string(lost) +
        " of the acts of --at were carried out: the process that asked for them died");
  if (ended.empty() && !names_.tasks.empty())
    report.verdict.failures.emplace_back("the manager did not answer at the end: how the tasks ended is not known");
  if (const std::string loss = finish_log(); !loss.empty()) report.verdict.failures.push_back(loss);
  const Nanoseconds until = clock_.now() + kFilingLimit;
  for (bool is_last = !after; !is_last; clock_.wait_until(clock_.now() + kStartLook)) {
    const auto answer = line_.ask("receipts", {{"last", 1}});
    const auto unfiled = static_cast<std::uint64_t>(answer ? whole_at(*answer, "unfiled") : 0);
    is_last = unfiled == 0 || clock_.now() >= until;
    if (unfiled > 0 && is_last)
      report.verdict.failures.push_back(counted(unfiled, "receipt was", "receipts were") + " not filed: " +
                                        text_at(*answer, "fault", "the disk does not answer"));
  }
}

/// Prints the refusal. The tasks that were made are turned off and killed nevertheless, and that is judged.
int RemoteTarget::refuse(const Error& error) {
  const CommandResult output = file_refusal(error, run_.json);
  std::fputs(output.out.c_str(), out_);
  std::fputs(output.err.c_str(), err_);
  std::fflush(out_);
  (void)await_end();
  (void)finish_log();
  for (const NotOff& one : not_off_) std::fprintf(err_, "FAILED: %s: %s\n", one.task.c_str(), one.text.c_str());
  return output.code;
}

/// Adds switches and takeovers of the run that began at `origin_ns`. The manager returns the last 200.
void RemoteTarget::add_receipts(const Json& origin_ns, RunReport& report) {
  const auto answer = line_.ask("receipts", {{"last", 200}});
  if (!answer) return;
  std::uint64_t n = 0, last = 0;
  for (const Json& receipt : (*answer)["receipts"]) {
    if (receipt["origin_ns"] != origin_ns) continue;
    append_joined(report.receipts, ", ", receipt.dump());
    ++n;
    last = std::max(last, receipt["number"].as_uint64());
  }
  report.receipts_left_out = last - n;
}

void RemoteTarget::finish(RunReport& report) {
  const auto status = line_.ask("status", Json::object());
  if (status) report.profiles = profiles((*status)["origin_ns"]);
  report.is_flag_up = status && truth_at((*status)["flag"], "up");
  poll_events();
  report.subsystem = names_.subsystem;
  report.executor = grants_;
  report.origin = started_;
  const bool is_orphan = request_.keeper > 0 && parent_process_id() != request_.keeper;
  report.stopped_by = is_orphan ? "its keeper died" : stopped_by_;
  report.refused = refused_;
  report.switches = switches_;
  if (status) add_receipts((*status)["origin_ns"], report);
  measured_.finish(started_ + report.ran, !is_resumed_, report);
  if (records_) records_->finish(*sink_);
  judge_end(report, status ? *status : Json::object());
}

bool RemoteTarget::is_output_complete(const RunReport& report) {
  if (request_.outlet == nullptr) return true;
  request_.outlet->finish(kLastOutput);
  check_output();
  if (page_.lost_output != 0) std::fputs(report.verdict.text().c_str(), err_);  // the verdict must reach the user
  return page_.lost_output == 0;
}

}  // namespace

int attend(const AttendRequest& request, RecordSink* sink, std::FILE* out, std::FILE* err) {
  std::vector<Expectation> expectations;
  std::vector<Measure> measures;
  for (std::size_t i = 0; i < request.run.expect.size(); ++i) {
    const std::string& text = request.run.expect[i];
    if (auto measure = Measure::with_bound(text, request.bounds[i]); measure && !measure->is_end_of_variable())
      measures.push_back(*std::move(measure));
    else if (auto expectation = Expectation::with_bound(text, request.bounds[i]); expectation)
      expectations.push_back(*std::move(expectation));
  }
  RemoteTarget target(request, std::move(measures), sink, out, err);
  return RunSession(request.run, std::move(expectations), target, out, err).run();
}

}  // namespace chimera::cli
