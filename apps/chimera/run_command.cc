// SPDX-License-Identifier: Apache-2.0
#include "apps/chimera/run_command.h"

#include <grp.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "apps/chimera/keep.h"
#include "apps/chimera/record_files.h"
#include "chimera/analysis/recorded_profile.h"
#include "chimera/desk/outlet.h"
#include "chimera/desk/output.h"
#include "chimera/desk/own_process.h"
#include "chimera/desk/run_plan.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_pages.h"
#include "chimera/platform/standard_output.h"
#include "chimera/units/quantity.h"

using namespace chimera;  // NOLINT: a main() of this project

namespace {

/// What the face of a run does, and so what both commands know.
void add_face_options(CLI::App* command, RunWords& words) {
  command->add_option("--for", words.duration, "how long, such as '10 s'; without it until Ctrl-C");
  command->add_option("--start-limit", words.start_limit,
                      "real time: tasks that are not ON after this long end the run (with --for 10 s, else no limit)");
  command->add_option("--at", words.run.at,
                      "a timed act: '2 s: off pid', '3 s: flag up', '4 s: set kp 100 N.m/rad'; may be repeated");
  command->add_option("--watch", words.run.watch, "print these state variables while it runs");
  command->add_option("--every", words.every, "how often --watch prints (1 s)");
  command->add_option("--expect", words.run.expect, "at the end must hold: 'error <= 2 mrad'; may be repeated");
  add_file_option(*command, "--trace", words.trace, "write a Chrome trace to this file (ui.perfetto.dev opens it)");
  add_file_option(*command, "--profile", words.run.profile,
                  "at the end save the profile of every task into this file, for `chimera schedule --profile`");
  command->add_flag("--strict", words.run.strict,
                    "a missed deadline, dropped release, fault, restart or the flag up at the end is exit code 1");
  command->add_option("--timeline", words.timeline,
                      "at the end print one letter for each unit of time, such as '1 ms'");
}

bool read_group(const std::string& name, const char* option, std::optional<std::uint32_t>& to) {
  if (name.empty()) return true;
  if (const group* found = ::getgrnam(name.c_str()); found != nullptr) return to = found->gr_gid, true;
  std::fprintf(stderr, "%s: no group '%s' on this machine\n", option, name.c_str());
  return false;
}

bool read_times(RunWords& words, Nanoseconds& unit) {
  desk::RunRequest& r = words.run;
  return read_duration(words.duration, "--for", r.duration) &&
         read_duration(words.start_limit, "--start-limit", r.start_limit) &&
         read_duration(words.every, "--every", r.every) && read_duration(words.quantum, "--quantum", r.quantum) &&
         read_duration(words.timeline, "--timeline", unit) && read_seed(words.seed, r.seed);
}

/// Better now than after an hour.
bool may_save(const std::string& path) {
  if (path.empty()) return true;
  const auto may = may_write_recorded_profile(path);
  if (!may) std::fprintf(stderr, "%s: %s\n", path.c_str(), may.error().message.c_str());
  return static_cast<bool>(may);
}

bool read_run(RunWords& words, Nanoseconds& unit) {
  desk::RunRequest& r = words.run;
  if (!read_times(words, unit)) return false;
  r.one_process = words.isolation == "none";
  const char* wrong = nullptr;
  if (!r.svg.empty() && (!r.virtual_time || r.watch.empty()))
    wrong = "--svg needs --virtual and --watch; `chimera scope` draws what runs in real time";
  if (!r.virtual_time && (r.preemptive || r.seed || !words.quantum.empty()))
    wrong = "--preemptive, --seed and --quantum belong to --virtual";
  if (r.virtual_time && r.duration == kNever) wrong = "--virtual needs --for: virtual time has no end of its own";
  if (!words.start_limit.empty() && (r.virtual_time || r.one_process))
    wrong = "--start-limit belongs to real time with a process for each unit";
  if (!words.timeline.empty() && r.duration == kNever) wrong = "--timeline needs --for";
  if (!words.timeline.empty() && r.json) wrong = "--timeline and --json exclude each other";
  if (wrong != nullptr) std::fprintf(stderr, "%s\n", wrong);
  return wrong == nullptr;
}

/// The words for `attend`, as they stood on the command line of `run`.
std::vector<std::string> words_for_face(const RunWords& words) {
  std::vector<std::string> made;
  const auto add = [&made](const char* option, const std::string& value) {
    if (!value.empty()) made.push_back(std::string(option) + "=" + value);
  };
  add("--for", words.duration);
  add("--start-limit", words.start_limit);
  add("--every", words.every);
  add("--trace", words.trace);
  add("--profile", words.run.profile);
  add("--timeline", words.timeline);
  for (const std::string& text : words.run.at) add("--at", text);
  for (const std::string& name : words.run.watch) add("--watch", name);
  for (const std::string& text : words.run.expect) add("--expect", text);
  if (words.run.json) made.push_back("--json");
  if (words.run.strict) made.push_back("--strict");
  return made;
}

constexpr Nanoseconds kStartLimit = seconds(10);  // of a run that has an end
constexpr Nanoseconds kLastLines = milliseconds(500);

int print_refusal(const Error& error) {
  std::fputs(desk::error_line(error).c_str(), stderr);
  return desk::kRefused;
}

/// Runs `body` with what writes the trace and the timeline; with null when neither is wanted.
template <class Body>
int with_records(const RunWords& words, Nanoseconds unit, std::FILE* out, Body body) {
  if (words.trace.empty() && words.timeline.empty()) return body(nullptr);
  RecordFiles files(words.trace, unit, words.run.duration);
  if (!files.is_open()) {
    std::fprintf(stderr, "%s: cannot be written: %s\n", words.trace.c_str(), files.why().c_str());
    return desk::kRefused;
  }
  const int code = body(&files);
  return files.finish(out, stderr) ? code : desk::kRefused;
}

}  // namespace

bool read_duration(const std::string& text, const char* option, Nanoseconds& to) {
  if (text.empty()) return true;
  const auto value = parse_duration(text);
  if (value && value->count > 0) return to = *value, true;
  std::fprintf(stderr, "%s: %s\n", option, value ? "must be longer than 0" : value.error().message.c_str());
  return false;
}

bool read_seed(const std::string& text, std::optional<std::uint64_t>& to) {
  if (text.empty()) return true;
  char* end = nullptr;
  errno = 0;
  to = std::strtoull(text.c_str(), &end, 10);
  if (*end == '\0' && errno == 0 && text[0] != '-') return true;
  std::fprintf(stderr, "--seed: '%s' is not a whole number from 0 to 2^64-1\n", text.c_str());
  return false;
}

void add_file_option(CLI::App& app, const char* name, std::string& file, const char* help) {
  const CLI::Validator has_name([](std::string& given) { return std::string(given.empty() ? "names no file" : ""); },
                                "");
  app.add_option(name, file, help)->type_name("FILE")->check(has_name);
}

void add_set_option(CLI::App& app, SetWords& words) {
  app.add_option("--set", words,
                 "this value instead of the file's; VAR is an operator variable, a constant, or "
                 "TASK.CONSTANT; may be repeated")
      ->type_name("VAR VALUE")
      ->allow_extra_args(false);
}

std::vector<Setting> settings_of(const SetWords& words) {
  std::vector<Setting> settings;
  for (const auto& [name, value] : words) settings.push_back({name, value, "--set " + name + " '" + value + "'"});
  return settings;
}

void add_run(CLI::App& app, RunWords& words) {
  CLI::App* r = app.add_subcommand("run", "Run an application in real time, or in virtual time");
  r->add_option("FILE", words.run.file, "the description")->required();
  add_set_option(*r, words.set);
  add_face_options(r, words);
  r->add_flag("--virtual", words.run.virtual_time, "in virtual time: as fast as it goes, the same result every time");
  add_file_option(*r, "--svg", words.run.svg,
                  "virtual time: draw what --watch names to this file instead of printing it");
  r->add_flag("--preemptive", words.run.preemptive, "virtual time: schedule preemptively");
  r->add_option("--seed", words.seed, "virtual time: draw execution times from [min, budget]");
  r->add_option("--quantum", words.quantum, "virtual time, laxity policies: compare again this often (1 ms)");
  r->add_option("--priority", words.run.priority, "real time: SCHED_FIFO priority; 0 runs as an ordinary process (80)")
      ->check(CLI::Range(0, 99));
  r->add_option("--may-miss", words.run.may_miss,
                "real time: run although this task is not guaranteed to keep its deadlines; may be repeated");
  r->add_option("--isolation", words.isolation, "real time: 'process', or 'none': all in this process, to debug")
      ->check(CLI::IsMember({"process", "none"}));
  r->add_option("--observe-group", words.observe_group, "real time: members of this group may look on");
  r->add_option("--operate-group", words.operate_group, "real time: they may also send signals and set values");
  r->add_option("--configure-group", words.configure_group, "real time: they may do everything");
  r->add_flag("--json", words.run.json, "the result as one JSON object");
  r->footer(
      "At the end, for each task: mean and max execution time of a cycle, the longest response (release to\n"
      "end), jitter (latest start minus earliest, each after its release), deadlines missed, releases dropped,\n"
      "faults.\n"
      "The last lines say whether it was clean, and what was not.\n"
      "Exit code 0 only if the run came to its end, every --expect holds, no task was in ERROR at the end, no\n"
      "`off` or `kill` failed then, no real-time unit was given up; with --strict only if all was clean; 2: wrong "
      "usage.\n"
      "Example: chimera run examples/02_cruise_control/cruise_control.yaml --virtual --for '60 s' --watch vz");
  CLI::App* i = app.add_subcommand("idle", "Start an empty server for editors and tools");
  i->add_option("--subsystem", words.idle_name, "its name (idle)");
  i->footer("Ends by Ctrl-C or `chimera end`.\nExample: chimera idle &");
  CLI::App* a = app.add_subcommand("attend", "The face of a run; started by it");
  a->group("");  // not for people
  a->add_option("--socket", words.socket)->required();
  a->add_option("--parent", words.parent)->required();
  a->add_option("--bound", words.bounds);
  a->add_flag("--json", words.run.json);
  add_face_options(a, words);
}

int carry_out_run(RunWords& words, const desk::Workplace& workplace) {
  Nanoseconds unit;
  KeepRequest kept;
  if (!read_run(words, unit) || !read_group(words.observe_group, "--observe-group", kept.observe_group) ||
      !read_group(words.operate_group, "--operate-group", kept.operate_group) ||
      !read_group(words.configure_group, "--configure-group", kept.configure_group))
    return desk::kUsage;
  if (!may_save(words.run.profile) || !may_save(words.run.svg)) return desk::kRefused;
  words.run.settings = settings_of(words.set);
  if (!words.run.virtual_time && !words.run.one_process) {
    kept.run = words.run;
    kept.face = words_for_face(words);
    return keep(kept, workplace);
  }
  std::signal(SIGINT, [](int) { desk::request_stop(); });
  std::signal(SIGTERM, [](int) { desk::request_stop(); });
  const auto run = [&] {
    return with_records(words, unit, stdout, [&](desk::RecordSink* sink) {
      return desk::run(words.run, workplace, sink, stdout, stderr);
    });
  };
  return desk::in_own_process(
      run, [&](const desk::BrokenRun& broken) { return desk::tell_broken(words.run, broken, stdout, stderr); });
}

int carry_out_attend(RunWords& words) {
  std::signal(SIGTERM, [](int) { desk::request_stop(); });
  std::signal(SIGPIPE, SIG_IGN);  // seen as a failed write
  sigset_t held;                  // by the keeper, until somebody listens
  ::sigemptyset(&held);
  ::sigaddset(&held, SIGTERM);
  ::sigprocmask(SIG_UNBLOCK, &held, nullptr);
  Nanoseconds unit;
  if (!read_times(words, unit) || words.bounds.size() != words.run.expect.size()) return desk::kUsage;
  if (!follow_parent(words.parent, SIGTERM)) return desk::kRefused;
  if (words.start_limit.empty() && !words.duration.empty()) words.run.start_limit = kStartLimit;
  const auto page = SharedPages::open(kFacePageDescriptor, sizeof(FacePage));
  if (!page) return print_refusal(page.error());
  auto& done = *reinterpret_cast<FacePage*>(page->bytes().data());
  desk::Outlet outlet(STDOUT_FILENO);
  if (outlet.stream() == nullptr) return print_refusal({ErrorCode::kSystem, {"no memory to print"}, {}});
  const int code = with_records(words, unit, outlet.stream(), [&](desk::RecordSink* sink) {
    return desk::attend({words.socket, words.run, words.bounds, words.parent, &done, &outlet}, sink, outlet.stream(),
                        stderr);
  });
  outlet.finish(kLastLines);  // of --timeline
  if (const int why = outlet.why_lost(); why != 0 && done.lost_output == 0)
    std::fprintf(stderr, "standard output is lost (%s)\n", why_lost_text(why));
  return done.lost_output == 0 && outlet.why_lost() == 0 ? code : desk::kRefused;
}
