// SPDX-License-Identifier: Apache-2.0
// `chimera run`, its hidden half `attend`, which a keeper starts, and `idle`.
#include <grp.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "apps/chimera/commands.h"
#include "apps/chimera/keep.h"
#include "apps/chimera/option_values.h"
#include "apps/chimera/record_files.h"
#include "chimera/analysis/recorded_profile.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/run/attend.h"
#include "chimera/cli/print/outlet.h"
#include "chimera/cli/run/own_process.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/platform/file.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/platform/standard_streams.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::kRefused;
using cli::kUsage;
using cli::Option;
using cli::WordKind;
using Repeats = cli::Option::Repeats;

namespace {

/// The options of the process that prints a run, which `run` and `attend` share.
const std::vector<Option>& printing_options() {
  static const std::vector<Option> kOptions = {
      {.name = "--for", .value = "DURATION", .help = "how long, such as '10 s'; without it until Ctrl-C"},
      {.name = "--start-limit",
       .value = "DURATION",
       .help = "real time: tasks that are not ON after this long end the run (with --for 10 s, else no limit)",
       .manual = "Real time: when tasks are not ON after this long, the run ends with exit code 1 and names what was "
                 "under way. 10 s with `--for`, else no limit."},
      {.name = "--at",
       .value = "ACT",
       .help = "a timed act: '2 s: off pid', '3 s: flag up', '4 s: set kp 100 N.m/rad', '5 s: switch torque', "
               "'6 s: switch --on pid', '7 s: die servo'; may be repeated",
       .manual = "A timed act, such as '2 s: off pid', '3 s: flag up' or '4 s: set kp 100 N.m/rad'. The signals are "
                 "spawn, on, off, kill, clear, reinit, and ring for an event; what is set is an operator variable; a "
                 "switch makes exactly the tasks of a configuration ON without losing a cycle, or those that `switch "
                 "--on TASK... --off TASK...` leads to, as in `chimera switch`; `die` ends an rtpu like the "
                 "death of its process, and no process restarts it (`--virtual` with tasks on several). May be "
                 "repeated.",
       .repeats = Repeats::kManyEach},
      {.name = "--watch",
       .value = "VARIABLE",
       .help = "print these state variables while it runs",
       .manual = "Prints these state variables while it runs.",
       .repeats = Repeats::kManyEach},
      {.name = "--every",
       .value = "DURATION",
       .help = "how often --watch prints (1 s); of --svg and --csv: the shortest period",
       .manual = "How often `--watch` prints (1 s). The default of `--svg` and `--csv` is the shortest period."},
      {.name = "--expect",
       .value = "COMPARISON",
       .help = "what must hold at the end, such as 'error_now <= 2 mrad', or of the run: 'max |u| <= 1 V'; may be "
               "repeated",
       .manual = "What must hold at the end, such as 'error_now <= 2 mrad' or '|error| < 1 deg'; or of the whole run, "
                 "as in cases and `sweep`: 'max |u| <= 1 V', 'settling error <= 2 mrad within 0.5 s'. May be "
                 "repeated.",
       .repeats = Repeats::kManyEach},
      {.name = "--trace",
       .value = "FILE",
       .help = "write a Chrome trace to this file (ui.perfetto.dev opens it)",
       .kind = WordKind::kFile},
      {.name = "--log",
       .value = "FILE",
       .help = "real time: add every event to this file as it comes, a line with date and user",
       .kind = WordKind::kFile},
      {.name = "--profile",
       .value = "FILE",
       .help = "at the end save the profile of every task into this file, for `chimera schedule --profile`",
       .manual = "At the end saves the profile of every task into this file, for `chimera schedule --profile` "
                 "(docs/formats/profile.md).",
       .kind = WordKind::kFile},
      {.name = "--strict",
       .help = "a missed deadline, dropped release, fault, restart or the flag up at the end is exit code 1",
       .manual = "A run that was not clean is a failure: a missed deadline, a dropped release, a fault, a restart, or "
                 "the flag up at the end."},
      {.name = "--timeline",
       .value = "DURATION",
       .help = "at the end print one letter for each unit of time, such as '1 ms'",
       .manual = "At the end prints one letter for each unit of time, such as '1 ms'."}};
  return kOptions;
}

const std::vector<Option>& virtual_options() {
  static const std::vector<Option> kOptions = {
      {.name = "--virtual",
       .help = "in virtual time: as fast as it goes, the same result every time",
       .manual =
           "In virtual time: as fast as it goes, the same result every time; every rtpu has a processor of "
           "its own, all on one clock. Needs `--for`. When standard error is "
           "a terminal, a long run prints its progress there."},
      {.name = "--svg",
       .value = "FILE",
       .help = "virtual time: draw what --watch names to this file instead of printing it, a point for each --every",
       .kind = WordKind::kFile},
      {.name = "--csv",
       .value = "FILE",
       .help = "virtual time: write what --watch names to this file, a line for each --every",
       .kind = WordKind::kFile},
      {.name = "--digest",
       .value = "FILE",
       .help = "virtual time: write hashes of values and faults to this file, by second and task; jobs take no time",
       .manual = "Virtual time: writes hashes of all published values and faults to this file, by second and task, to "
                 "compare with another machine (docs/formats/digest.md). Jobs then take no time, whatever their "
                 "budgets and components say.",
       .kind = WordKind::kFile},
      {.name = "--preemptive", .help = "virtual time: schedule preemptively, whatever the file says of an rtpu"},
      {.name = "--seed",
       .value = "N",
       .help = "virtual time: draw execution times from [min, budget] with this seed",
       .kind = WordKind::kNumber},
      {.name = "--quantum",
       .value = "DURATION",
       .help = "virtual time, laxity policies: compare again this often (1 ms)"}};
  return kOptions;
}

const std::vector<Option>& real_time_options() {
  static const std::vector<Option> kOptions = {
      {.name = "--priority",
       .value = "N",
       .help = "real time: SCHED_FIFO priority; 0 runs as an ordinary process (80)",
       .kind = WordKind::kNumber,
       .most = 99},
      {.name = "--cpu", .value = "RTPU=N", .help = "place this rtpu on CPU N, not on that of the file; may be repeated",
       .repeats = Repeats::kManyEach},
      {.name = "--may-miss",
       .value = "TASK",
       .help = "real time: run although this task is not guaranteed to keep its deadlines; may be repeated",
       .manual = "Real time: run although TASK is not guaranteed to keep its deadlines (`chimera schedule` says why). "
                 "Without it such a set is refused, unless the task says `on_miss: abort` or `tolerate`. May be "
                 "repeated.",
       .repeats = Repeats::kManyEach},
      {.name = "--isolation",
       .value = "HOW",
       .help = "real time: 'process', or 'none': all in this process, to debug",
       .manual = "Real time: with `process` every rtpu in a process of its own, or, to debug, with `none` all tasks in "
                 "one loop in this process, on the CPU and by the policy of the first rtpu. Without processes there is "
                 "no control protocol.",
       .kind = WordKind::kOneOf,
       .words = "process none"},
      {.name = "--flash",
       .help = "real time: build the images of boards, and start them in QEMU",
       .manual = "Real time: builds the image of each rtpu with `target` under build/boards, and starts it in QEMU, at "
                 "the other end of its `link`, until the run ends. If QEMU has no such board, or the `link` names a "
                 "device, load the image with your programmer, and run without `--flash`."},
      {.name = "--observe-group",
       .value = "GROUP",
       .help = "real time: members of this group may observe: read states, values and events",
       .kind = WordKind::kGroup},
      {.name = "--operate-group",
       .value = "GROUP",
       .help = "real time: they may also send signals and set values",
       .kind = WordKind::kGroup},
      {.name = "--configure-group",
       .value = "GROUP",
       .help = "real time: they may do everything",
       .kind = WordKind::kGroup}};
  return kOptions;
}

bool read_group(const Call& call, const char* option, std::optional<std::uint32_t>& to) {
  const std::string name = call.value(option);
  if (name.empty()) return true;
  if (const group* found = ::getgrnam(name.c_str()); found != nullptr) return to = found->gr_gid, true;
  std::fprintf(stderr, "%s: no group '%s' on this machine\n", option, name.c_str());
  return false;
}

/// Better now than after an hour.
bool may_save(const std::string& path) {
  if (path.empty()) return true;
  const auto may = may_write_recorded_profile(path);
  if (!may) std::fprintf(stderr, "%s: %s\n", path.c_str(), may.error().message.c_str());
  return static_cast<bool>(may);
}

/// A run as asked for, and the unit of its timeline.
struct AskedRun {
  cli::RunRequest run;
  Nanoseconds unit;

  /// Reads the options that both commands share. False after printing that one cannot be read.
  bool read_printing(const Call& call) {
    run.at = call.values("--at");
    run.watch = call.values("--watch");
    run.expect = call.values("--expect");
    run.profile = call.value("--profile");
    run.log = call.value("--log");
    run.strict = call.has("--strict");
    run.json = call.json;
    if (call.has("--seed")) read_number(call, "--seed", run.seed.emplace());
    return read_duration(call, "--for", run.duration) && read_duration(call, "--start-limit", run.start_limit) &&
           read_duration(call, "--every", run.every) && read_duration(call, "--quantum", run.quantum) &&
           read_duration(call, "--timeline", unit);
  }
  bool read(const Call& call);
};

bool AskedRun::read(const Call& call) {
  run.file = call.operand(0);
  run.virtual_time = call.has("--virtual");
  run.one_process = call.value("--isolation") == "none";
  run.preemptive = call.has("--preemptive");
  run.may_miss = call.values("--may-miss");
  run.svg = call.value("--svg");
  run.csv = call.value("--csv");
  run.digest = call.value("--digest");
  run.settings = settings_of(call);
  for (const std::string& text : call.values("--cpu")) {
    const std::size_t equals = std::min(text.find('='), text.size());
    run.settings.push_back({"rtpus." + text.substr(0, equals) + ".cpu",
                            text.substr(std::min(equals + 1, text.size())), "--cpu " + text});
  }
  read_number(call, "--priority", run.priority);
  if (!read_printing(call)) return false;
  const char* wrong = nullptr;
  if (run.keeps_samples() && (!run.virtual_time || run.watch.empty()))
    wrong = "--svg and --csv need --virtual and --watch; `chimera scope` records what runs in real time";
  if (!run.virtual_time && (run.preemptive || run.seed || !call.value("--quantum").empty()))
    wrong = "--preemptive, --seed and --quantum belong to --virtual";
  if (!run.digest.empty() && !run.virtual_time) wrong = "--digest needs --virtual";
  if (!run.digest.empty() && run.seed)
    wrong = "--digest and --seed exclude each other: with --digest no job takes time";
  if (run.virtual_time && run.duration == kNever) wrong = "--virtual needs --for: virtual time has no end of its own";
  if (!call.value("--start-limit").empty() && (run.virtual_time || run.one_process))
    wrong = "--start-limit belongs to real time with a process for each rtpu";
  if (!run.log.empty() && (run.virtual_time || run.one_process))
    wrong = "--log belongs to real time with a process for each rtpu";
  if (call.has("--flash") && (run.virtual_time || run.one_process))
    wrong = "--flash belongs to real time with a process for each rtpu";
  if (!call.value("--timeline").empty() && run.duration == kNever) wrong = "--timeline needs --for";
  if (!call.value("--timeline").empty() && run.json) wrong = "--timeline and --json exclude each other";
  if (wrong != nullptr) std::fprintf(stderr, "%s\n", wrong);
  return wrong == nullptr;
}

/// The words for `attend`, as they stood on the command line of `run`.
std::vector<std::string> words_for_attend(const Call& call) {
  std::vector<std::string> words;
  for (const Option& option : printing_options()) {
    if (option.value == nullptr && call.has(option.name)) words.emplace_back(option.name);
    for (const std::string& value : call.values(option.name))
      if (!value.empty()) words.push_back(std::string(option.name) + "=" + value);
  }
  if (call.json) words.emplace_back("--json");
  return words;
}

constexpr Nanoseconds kStartLimit = seconds(10);  // of a run that has an end
constexpr Nanoseconds kLastLines = milliseconds(500);

int print_refusal(const Error& error) {
  std::fputs(cli::error_line(error).c_str(), stderr);
  return kRefused;
}

/// The open file of --log; -1 without one.
Result<OwnedDescriptor> log_of(const cli::RunRequest& run) {
  if (run.log.empty()) return OwnedDescriptor();
  return open_to_append(run.log);
}

/// Runs `body` with what writes the trace and the timeline; with null when neither is wanted.
template <class Body>
int with_records(const Call& call, const AskedRun& asked, std::FILE* out, Body body) {
  const std::string trace = call.value("--trace");
  if (trace.empty() && call.value("--timeline").empty()) return body(nullptr);
  RecordFiles files(trace, asked.unit, asked.run.duration);
  if (!files.is_open()) {
    std::fprintf(stderr, "%s: cannot be written: %s\n", trace.c_str(), files.why().c_str());
    return kRefused;
  }
  const int code = body(&files);
  return files.finish(out, stderr) ? code : kRefused;
}

int run(const Call& call, const Workplace& workplace) {
  AskedRun asked;
  KeepRequest kept;
  if (!asked.read(call) || !read_group(call, "--observe-group", kept.observe_group) ||
      !read_group(call, "--operate-group", kept.operate_group) ||
      !read_group(call, "--configure-group", kept.configure_group))
    return kUsage;
  if (!may_save(asked.run.profile) || !may_save(asked.run.svg) || !may_save(asked.run.csv) ||
      !may_save(asked.run.digest))
    return kRefused;
  if (const auto log = log_of(asked.run); !log) return print_refusal(log.error());
  if (!asked.run.virtual_time && !asked.run.one_process) {
    kept.run = asked.run;
    kept.flash = call.has("--flash");
    kept.face = words_for_attend(call);
    return keep(kept, workplace);
  }
  stop_run_at_signals();
  const auto body = [&] {
    return with_records(call, asked, stdout,
                        [&](cli::RecordSink* sink) { return cli::run(asked.run, workplace, sink, stdout, stderr); });
  };
  return cli::in_own_process(
      body, [&](const cli::BrokenRun& broken) { return cli::report_broken_run(asked.run, broken, stdout, stderr); });
}

int idle(const Call& call, const Workplace& workplace) {
  return keep_idle(call.has("--subsystem") ? call.value("--subsystem") : "idle", workplace);
}

/// The bounds of the expectations: "VALUE:FACTOR:OFFSET" (cli/run/expectation.h).
std::vector<cli::Bound> bounds_of(const Call& call) {
  std::vector<cli::Bound> bounds;
  for (const std::string& text : call.values("--bound")) {
    cli::Bound& bound = bounds.emplace_back();
    const char* at = text.data();
    for (double* number : {&bound.value, &bound.to_written.factor, &bound.to_written.offset}) {
      at = std::from_chars(at, text.data() + text.size(), *number).ptr;
      at += at < text.data() + text.size() ? 1 : 0;
    }
  }
  return bounds;
}

int attend(const Call& call, const Workplace&) {
  std::signal(SIGTERM, [](int) { cli::request_stop(); });
  sigset_t held;  // the keeper blocked it until this handler was set
  ::sigemptyset(&held);
  ::sigaddset(&held, SIGTERM);
  ::sigprocmask(SIG_UNBLOCK, &held, nullptr);
  AskedRun asked;
  const std::vector<cli::Bound> bounds = bounds_of(call);
  if (!asked.read_printing(call) || bounds.size() != asked.run.expect.size()) return kUsage;
  int parent = 0;
  read_number(call, "--parent", parent);
  if (!follow_parent(parent, SIGTERM)) return kRefused;
  if (call.value("--start-limit").empty() && !call.value("--for").empty()) asked.run.start_limit = kStartLimit;
  const auto page = SharedPages::open(kFacePageDescriptor, sizeof(FacePage));
  if (!page) return print_refusal(page.error());
  auto& done = *reinterpret_cast<FacePage*>(page->bytes().data());
  auto log_file = log_of(asked.run);
  if (!log_file) return print_refusal(log_file.error());
  cli::RunLog log(asked.run.log, *std::move(log_file));
  cli::Outlet outlet(STDOUT_FILENO);
  if (outlet.stream() == nullptr) return print_refusal({ErrorCode::kSystem, {"no memory to print"}, {}});
  const int code = with_records(call, asked, outlet.stream(), [&](cli::RecordSink* sink) {
    return cli::attend({call.value("--socket"), asked.run, bounds, parent, &done,
                        asked.run.log.empty() ? nullptr : &log, &outlet},
                       sink, outlet.stream(), stderr);
  });
  outlet.finish(kLastLines);  // of --timeline
  if (const int why = outlet.why_lost(); why != 0 && done.lost_output == 0)
    std::fprintf(stderr, "standard output is lost (%s)\n", why_lost_text(why));
  return done.lost_output == 0 && outlet.why_lost() == 0 ? code : kRefused;
}

}  // namespace

FileCommand run_row() {
  FileCommand row{
      .words = {.name = "run",
                .help = "Run an application in real time, or in virtual time",
                .operands = "FILE",
                .least = 1,
                .most = 1,
                .operand_kind = WordKind::kDescription,
                .operand_help = "the description",
                .json = "the result as one JSON object",
                .footer = "At the end, for each task: mean and max execution time of a cycle, the longest response "
                          "(release to\nend), jitter (latest start minus earliest, each after its release), deadlines "
                          "missed, releases dropped,\nfaults.\nThe last lines say whether it was clean, and what was "
                          "not.\nExit code 0 only if the run came to its end, every --expect holds, no task was in "
                          "ERROR at the end, no\n`off` or `kill` failed then, no rtpu was given up; with "
                          "--strict only if all was clean; 2: wrong usage.",
                .example =
                    "chimera run examples/02_cruise_control/cruise_control.yaml --virtual --for '60 s' --watch vz",
                .manual = "Runs the application of FILE and prints the profile of every task.",
                .outlives_reader = true},
      .carry_out = run};
  std::vector<Option>& options = row.words.options;
  options.push_back(
      set_option("This value instead of the file's, judged by the same rules. VAR is an operator "
                 "variable, a constant of the file, or TASK.CONSTANT for a constant that one task has for "
                 "itself. May be repeated."));
  options.insert(options.end(), printing_options().begin(), printing_options().end());
  options.insert(options.end(), virtual_options().begin(), virtual_options().end());
  options.insert(options.end(), real_time_options().begin(), real_time_options().end());
  return row;
}

FileCommand idle_row() {
  return {
      .words = {.name = "idle",
                .help = "Start an empty server for editors and tools",
                .options = {{.name = "--subsystem", .value = "NAME", .help = "its name (idle)"}},
                .json = nullptr,
                .footer = "Ends by Ctrl-C or `chimera end`.",
                .example = "chimera idle &",
                .manual = "Runs a subsystem with nothing loaded: it serves `check`, `schedule` and `library` of the "
                          "control protocol to editors and pages, until Ctrl-C or `chimera end`.",
                .is_rare = true,
                .outlives_reader = true},
      .carry_out = idle};
}

FileCommand attend_row() {
  FileCommand row{
      .words = {.name = "attend",
                .help = "The process that prints a run; started by `chimera run`",
                .options = {{.name = "--socket", .value = "PATH", .is_required = true},
                            {.name = "--parent", .value = "PID", .kind = WordKind::kNumber, .is_required = true},
                            {.name = "--bound", .value = "NUMBER", .repeats = Repeats::kManyEach}},
                .json = "",
                .is_hidden = true,
                .outlives_reader = true},
      .carry_out = attend};
  row.words.options.insert(row.words.options.end(), printing_options().begin(), printing_options().end());
  return row;
}
