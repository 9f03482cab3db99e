// SPDX-License-Identifier: Apache-2.0
// The `chimera` command: words of the command line to the commands of chimera/desk.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <CLI/CLI.hpp>

#include "apps/chimera/record_files.h"
#include "chimera/config/quantity.h"
#include "chimera/desk/check.h"
#include "chimera/desk/list.h"
#include "chimera/desk/new.h"
#include "chimera/desk/run.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project

/// Everything the command line can say.
struct Words {
  bool json = false;
  desk::CheckOptions check;
  std::string component;
  desk::NewRequest made;
  bool in_c = false;
  desk::RunRequest run;
  std::string duration, every, quantum, seed;
  std::string trace, timeline;
};

int print(const desk::Output& output) {
  std::fputs(output.out.c_str(), stdout);
  std::fputs(output.err.c_str(), stderr);
  return output.code;
}

void add_check(CLI::App& app, Words& words) {
  CLI::App* c = app.add_subcommand("check", "Prove a description legal, or name every fault with its place");
  c->add_option("FILE", words.check.file, "the description")->required();
  c->add_flag("--json", words.json, "the report as one JSON object");
  c->add_option("--graph", words.check.graph, "draw it instead: dot, svg or text")
      ->check(CLI::IsMember({"dot", "svg", "text"}));
  c->footer("Example: chimera check examples/01_puma_pid/puma_pid.yaml --graph svg > puma.svg");
}

void add_list(CLI::App& app, Words& words) {
  CLI::App* l = app.add_subcommand("list", "Name the installed components");
  l->add_flag("--json", words.json, "as one JSON object");
  l->footer("Components are looked for along CHIMERA_PATH, then beside the program.\nExample: chimera list");
  CLI::App* d = app.add_subcommand("describe", "Show the data sheet of a component");
  d->add_option("NAME", words.component, "the component")->required();
  d->add_flag("--json", words.json, "its descriptor");
  d->footer("Example: chimera describe pid_joint");
}

void add_run(CLI::App& app, Words& words) {
  CLI::App* r = app.add_subcommand("run", "Run an application in real time, or in virtual time");
  r->add_option("FILE", words.run.file, "the description")->required();
  r->add_option("--for", words.duration, "how long, such as '10 s'; without it until Ctrl-C");
  r->add_flag("--virtual", words.run.virtual_time, "in virtual time: as fast as it goes, the same result every time");
  r->add_flag("--preemptive", words.run.preemptive, "virtual time: schedule preemptively");
  r->add_option("--seed", words.seed, "virtual time: draw execution times from [min, budget]");
  r->add_option("--quantum", words.quantum, "virtual time, laxity policies: compare again this often (1 ms)");
  r->add_option("--priority", words.run.priority, "real time: SCHED_FIFO priority; 0 runs as an ordinary process (80)")
      ->check(CLI::Range(0, 99));
  r->add_option("--at", words.run.at, "a timed act: '2 s: off pid', '3 s: flag up'; may be repeated");
  r->add_option("--watch", words.run.watch, "print these state variables while it runs");
  r->add_option("--every", words.every, "how often --watch prints (1 s)");
  r->add_option("--expect", words.run.expect, "at the end must hold: 'error <= 2 mrad'; may be repeated");
  r->add_option("--trace", words.trace, "write a Chrome trace to this file (ui.perfetto.dev opens it)");
  r->add_option("--timeline", words.timeline, "at the end print one letter for each unit of time, such as '1 ms'");
  r->add_flag("--json", words.json, "the result as one JSON object");
  r->footer("Exit code 0 only if the run came to its end and every --expect holds.\n"
            "Example: chimera run examples/02_cruise_control/cruise_control.yaml --virtual --for '60 s' --watch vz");
}

void add_new(CLI::App& app, Words& words) {
  CLI::App* n = app.add_subcommand("new", "Make a project that builds and passes its tests at once");
  n->require_subcommand(1);
  CLI::App* c = n->add_subcommand("component", "One component and its test");
  c->add_option("NAME", words.made.name, "[a-z][a-z0-9_]*; also the name of the folder")->required();
  c->add_flag("--c", words.in_c, "in C instead of C++");
  c->footer("Example: chimera new component low_pass");
  CLI::App* a = n->add_subcommand("app", "A description, a component of its own, and a script that runs it");
  a->add_option("NAME", words.made.name, "[a-z][a-z0-9_]*; also the name of the folder")->required();
  a->footer("Example: chimera new app pendulum");
}

desk::Output make_new(const CLI::App& app, Words& words) {
  if (app.get_subcommand("new")->got_subcommand("app")) words.made.kind = desk::NewKind::kApplication;
  else if (words.in_c) words.made.kind = desk::NewKind::kComponentInC;
  return desk::new_project(words.made, desk::program_path());
}

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

bool read_run(Words& words, Nanoseconds& unit) {
  desk::RunRequest& r = words.run;
  r.json = words.json;
  r.one_process = true;
  if (!read_duration(words.duration, "--for", r.duration) || !read_duration(words.every, "--every", r.every) ||
      !read_duration(words.quantum, "--quantum", r.quantum) || !read_duration(words.timeline, "--timeline", unit) ||
      !read_seed(words.seed, r.seed))
    return false;
  const char* wrong = nullptr;
  if (!r.virtual_time && (r.preemptive || r.seed || !words.quantum.empty()))
    wrong = "--preemptive, --seed and --quantum belong to --virtual";
  if (r.virtual_time && r.duration == kNever) wrong = "--virtual needs --for: virtual time has no end of its own";
  if (!words.timeline.empty() && r.duration == kNever) wrong = "--timeline needs --for";
  if (!words.timeline.empty() && r.json) wrong = "--timeline and --json exclude each other";
  if (wrong != nullptr) std::fprintf(stderr, "%s\n", wrong);
  return wrong == nullptr;
}

int run_application(Words& words, const desk::Workplace& workplace) {
  Nanoseconds unit;
  if (!read_run(words, unit)) return desk::kUsage;
  std::signal(SIGINT, [](int) { desk::request_stop(); });
  std::signal(SIGTERM, [](int) { desk::request_stop(); });
  if (words.trace.empty() && words.timeline.empty()) return desk::run(words.run, workplace, nullptr, stdout, stderr);
  RecordFiles files(words.trace, unit, words.run.duration);
  if (!files.is_open()) {
    std::fprintf(stderr, "%s: cannot be written: %s\n", words.trace.c_str(), files.why().c_str());
    return desk::kRefused;
  }
  const int code = desk::run(words.run, workplace, &files, stdout, stderr);
  return files.finish(stdout, stderr) ? code : desk::kRefused;
}

int carry_out(CLI::App& app, Words& words) {
  const desk::Workplace workplace = desk::Workplace::around(desk::program_path());
  words.check.json = words.json;
  if (app.got_subcommand("check")) return print(desk::check(words.check, workplace));
  if (app.got_subcommand("new")) return print(make_new(app, words));
  if (app.got_subcommand("list")) return print(desk::list(workplace, words.json));
  if (app.got_subcommand("describe")) return print(desk::describe_component(words.component, workplace, words.json));
  return run_application(words, workplace);
}

bool is_command(const CLI::App& app, const std::string& word) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (command->get_name() == word) return true;
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Real-time control software assembled from components: check it, run it, look at it."};
  app.require_subcommand(1);
  app.set_version_flag("--version", CHIMERA_VERSION);
  Words words;
  add_check(app, words);
  add_run(app, words);
  add_list(app, words);
  add_new(app, words);
  if (argc > 1 && argv[1][0] != '-' && !is_command(app, argv[1])) {
    std::fprintf(stderr, "no command '%s'; `chimera --help` lists them\n", argv[1]);
    return desk::kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? desk::kOk : desk::kUsage;
  }
  return carry_out(app, words);
}
