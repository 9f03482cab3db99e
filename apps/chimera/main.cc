// SPDX-License-Identifier: Apache-2.0
// The `chimera` command: words of the command line to the commands of chimera/desk.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/chimera/keep.h"
#include "apps/chimera/run_command.h"
#include "apps/chimera/shell_words.h"
#include "apps/chimera/sweep_command.h"
#include "apps/chimera/wrong_usage.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/desk/check.h"
#include "chimera/desk/list.h"
#include "chimera/desk/new.h"
#include "chimera/desk/schedule.h"
#include "chimera/desk/test_application.h"
#include "chimera/desk/test_component.h"
#include "chimera/platform/limits.h"
#include "chimera/platform/standard_output.h"
#include "chimera/text/nearest.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project

/// Everything the command line can say.
struct Words {
  bool json = false;
  desk::CheckOptions check;
  desk::ScheduleRequest schedule;
  SetWords set;
  std::string component;
  desk::TestOptions test;
  desk::CasesRequest cases;
  std::string cases_limit;
  desk::NewRequest made;
  bool in_c = false, for_hardware = false;
  RunWords run;
  SweepWords sweep;
  std::shared_ptr<ShellWords> shell;
};

int print(const desk::Output& output) {
  std::fputs(for_terminal(output.out).c_str(), stdout);
  (void)flush_and_look(stdout);  // in a file that takes both, what came first stands first
  std::fputs(for_terminal(output.err).c_str(), stderr);
  return output.code;
}

void add_check(CLI::App& app, Words& words) {
  CLI::App* c = app.add_subcommand("check", "Prove a description legal, or name every fault with its place");
  c->add_option("FILE", words.check.file, "the description")->required();
  c->add_flag("--json", words.json, "the report as one JSON object");
  add_set_option(*c, words.set);
  c->add_option("--graph", words.check.graph, "draw it instead: dot, svg or text")
      ->check(CLI::IsMember({"dot", "svg", "text"}));
  c->footer("Example: chimera check examples/01_puma_pid/puma_pid.yaml --graph svg > puma.svg");
}

void add_schedule(CLI::App& app, Words& words) {
  CLI::App* s = app.add_subcommand("schedule", "Prove that every task keeps its deadlines, or tell what would help");
  s->add_option("FILE", words.schedule.file, "the description")->required();
  add_set_option(*s, words.set);
  add_file_option(*s, "--profile", words.schedule.profile,
                  "execution times from this recorded profile, else from budgets");
  add_file_option(*s, "--svg", words.schedule.svg, "draw the worst window of each CPU into this file");
  s->add_option("--dispatch", words.schedule.dispatch,
                "judge all rtpus as 'preemptive' or 'executive'; else each as described")
      ->check(CLI::IsMember({"preemptive", "executive"}));
  s->add_flag("--json", words.json, "the analysis as one JSON object");
  s->footer(
      "Response: longest from release to end. Blocked: by a job that cannot be taken off. Copies: at each\n"
      "cycle, from tables of other rtpus or the operator. `run` starts only when every task keeps its deadline\n"
      "that does not say 'may miss'.\n"
      "Exit code 0: everything keeps its deadlines; 1: it does not.\n"
      "Example: chimera schedule examples/01_puma_pid/puma_pid.yaml --svg window.svg");
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

void add_test(CLI::App& app, Words& words) {
  CLI::App* t = app.add_subcommand("test", "Test components alone, or the applications of a folder, in virtual time");
  auto* names = t->add_option("WHAT", words.test.components,
                              "a component, the path of a shared object, a folder with NAME.cases.yaml, or such "
                              "a file");
  t->add_flag("--all", words.test.all, "every installed component")->excludes(names);
  t->add_option("--setup", words.test.setup, "description of the task; left out: NAME.test.yaml beside the component");
  t->add_option("--inputs", words.test.inputs,
                "recording (CSV); left out: NAME.test.csv beside the component, else generated");
  t->add_option("--names", words.test.names, "what in[0], in[1], ... of the recording are")->delimiter(',');
  t->add_option("--seed", words.test.seed, "of generated inputs; 1 when left out");
  t->add_option("--cycles", words.test.cycles, "of generated inputs; 1000 when left out")
      ->check(CLI::Range(20, 100000));
  t->add_option("--case", words.cases.only, "a folder: only the cases of this name; may be repeated")
      ->allow_extra_args(false);
  add_file_option(*t, "--junit", words.cases.junit, "a folder: write the report for a build machine (JUnit XML)");
  t->add_option("--jobs", words.cases.jobs, "a folder: cases at a time; else as many as there are processors")
      ->check(CLI::Range(1, 1024));
  t->add_option("--limit", words.cases_limit, "a folder: time on the wall for each case (10 min)");
  t->add_flag("--json", words.json, "the reports as one JSON object");
  t->footer(
      "A component runs three times in a process of its own; docs/formats/component-test.md has the setup.\n"
      "A folder: every case of every NAME.cases.yaml in it and below; docs/formats/cases.md has the keys.\n"
      "A bare word that is both a component and a folder is the component: write 'NAME/' for the folder.\n"
      "Exit code 0: all pass, 1: one fails, or there is no test, 2: wrong usage.\n"
      "Examples: chimera test pid_joint --inputs run.csv\n"
      "          chimera test . --junit report.xml");
}

int usage(const std::string& what) { return print({"", "chimera test: " + what + "\n", desk::kUsage}); }

int run_cases(Words& words, const desk::Workplace& workplace) {
  words.cases.places = words.test.components;
  words.cases.json = words.json;
  words.cases.limit = seconds(600);
  if (!read_duration(words.cases_limit, "--limit", words.cases.limit)) return desk::kUsage;
  std::signal(SIGINT, [](int) { desk::request_stop(); });
  std::signal(SIGTERM, [](int) { desk::request_stop(); });
  return desk::test_application(words.cases, workplace, stdout, stderr);
}

int run_tests(const CLI::App& app, Words& words, const desk::Workplace& workplace) {
  const auto is_given = [&app](std::initializer_list<const char*> options) {
    return std::any_of(options.begin(), options.end(), [&app](const char* o) { return app.count(o) > 0; });
  };
  words.test.json = words.json;
  const auto& what = words.test.components;
  if (!words.test.all && what.empty()) return usage("name a component, a folder with NAME.cases.yaml, or --all");
  const auto library = workplace.library();
  const auto places =
      library ? std::count_if(what.begin(), what.end(),
                              [&](const std::string& word) { return desk::is_place_of_cases(word, *library); })
              : 0;
  if (places == 0) {
    if (is_given({"--case", "--junit", "--jobs", "--limit"}))
      return usage("--case, --junit, --jobs and --limit belong to a folder with NAME.cases.yaml");
    return print(desk::test_components(words.test, workplace));
  }
  if (places != static_cast<std::ptrdiff_t>(what.size())) return usage("components and folders are two calls");
  if (is_given({"--setup", "--inputs", "--names", "--seed", "--cycles"}))
    return usage("--setup, --inputs, --names, --seed and --cycles belong to a component; a case has keys of its own");
  return run_cases(words, workplace);
}

void add_new(CLI::App& app, Words& words) {
  CLI::App* n = app.add_subcommand("new", "Make a project that builds and passes its tests at once");
  n->require_subcommand(1);
  CLI::App* c = n->add_subcommand("component", "One component and its test");
  c->add_option("NAME", words.made.name, "[a-z][a-z0-9_]*; also the name of the folder")->required();
  auto* in_c = c->add_flag("--c", words.in_c, "in C instead of C++");
  c->add_flag("--hardware", words.for_hardware, "a driver of a serial device, tested on a pseudo terminal")
      ->excludes(in_c);
  c->footer("Example: chimera new component low_pass");
  CLI::App* a = n->add_subcommand("app", "A description, a component of its own, and a script that runs it");
  a->add_option("NAME", words.made.name, "[a-z][a-z0-9_]*; also the name of the folder")->required();
  a->footer("Example: chimera new app pendulum");
}

desk::Output make_new(const CLI::App& app, Words& words) {
  if (app.get_subcommand("new")->got_subcommand("app"))
    words.made.kind = desk::NewKind::kApplication;
  else if (words.in_c)
    words.made.kind = desk::NewKind::kComponentInC;
  else if (words.for_hardware)
    words.made.kind = desk::NewKind::kHardwareComponent;
  return desk::new_project(words.made, desk::program_path());
}

int carry_out(CLI::App& app, Words& words) {
  const desk::Workplace workplace = desk::Workplace::around(desk::program_path());
  words.check.json = words.schedule.json = words.json;
  words.check.settings = words.schedule.settings = settings_of(words.set);
  if (app.got_subcommand("check")) return print(desk::check(words.check, workplace));
  if (app.got_subcommand("schedule")) return print(desk::schedule(words.schedule, workplace));
  if (app.got_subcommand("new")) return print(make_new(app, words));
  if (app.got_subcommand("list")) return print(desk::list(workplace, words.json));
  if (app.got_subcommand("describe")) return print(desk::describe_component(words.component, workplace, words.json));
  if (app.got_subcommand("sweep")) return carry_out_sweep(words.sweep, workplace);
  if (app.got_subcommand("test")) return run_tests(*app.get_subcommand("test"), words, workplace);
  const int code = carry_out_shell_command(app, *words.shell, workplace.unit_files);
  if (code >= 0) return code;
  if (app.got_subcommand("attend")) return carry_out_attend(words.run);
  if (app.got_subcommand("idle")) return keep_idle(words.run.idle_name, workplace);
  return carry_out_run(words.run, workplace);
}

std::vector<std::string> commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

int no_command(const std::string& word, const std::vector<std::string>& names) {
  const std::string near = nearest(word, names);
  const std::string hint = near.empty() ? "" : "; did you mean '" + near + "'?";
  std::fprintf(stderr, "no command '%s'%s; `chimera --help` lists them\n", word.c_str(), hint.c_str());
  return desk::kUsage;
}

/// What goes on although nobody reads what it prints; the other commands end with their reader, as `cat` does.
bool outlives_its_reader(const CLI::App& app) {
  return std::ranges::any_of(std::array{"run", "idle", "attend", "test", "sweep", "shell"},
                             [&app](const char* name) { return app.got_subcommand(name); });
}

std::terminate_handler tell_defect = nullptr;  // of the C++ library: says what was thrown, and leaves a core

bool memory_is_limited() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

/// The last words of a program that gets no memory, or no thread. Under a limit there may be no memory for an exception
/// either; without one it is a thread of a component that nobody joined, or the like.
[[noreturn]] void give_up() {
  const char* why = "out of memory: Cannot allocate memory";
  if (!std::current_exception() && !memory_is_limited()) tell_defect();
  try {
    if (std::current_exception()) throw;
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) tell_defect();
    why = "no thread can be started: Resource temporarily unavailable";
  } catch (const std::bad_alloc&) {
  } catch (...) {
    tell_defect();
  }
  std::fprintf(stderr, "chimera: %s\n", why);
  ::_exit(desk::kRefused);
}

int run_program(int argc, char** argv) {
  CLI::App app{"Real-time control software assembled from components: check it, run it, look at it."};
  app.require_subcommand(1);
  app.footer("`chimera COMMAND --help` has an example. Documents and examples: " +
             desk::Workplace::around(desk::program_path()).documents);
  app.set_version_flag("--version", CHIMERA_VERSION);
  Words words;
  add_check(app, words);
  add_schedule(app, words);
  add_run(app, words.run);
  add_sweep(app, words.sweep);
  add_list(app, words);
  add_test(app, words);
  add_new(app, words);
  words.shell = add_shell_commands(app);
  const std::vector<std::string> names = commands(app);
  if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end())
    return no_command(argv[1], names);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return tell_wrong_usage(app, e, argc, argv);
  }
  if (outlives_its_reader(app)) std::signal(SIGPIPE, SIG_IGN);  // seen as a failed write
  return carry_out(app, words);
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  if (const auto may = may_run_here(); !may) {
    std::fputs(desk::error_line(may.error()).c_str(), stderr);
    return desk::kRefused;
  }
  tell_defect = std::set_terminate(give_up);
  return report_lost_output(run_program(argc, argv));
}
