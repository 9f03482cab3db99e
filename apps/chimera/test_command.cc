// SPDX-License-Identifier: Apache-2.0
// `chimera test`: components alone, or the cases of a folder.
#include <algorithm>
#include <cstdio>
#include <initializer_list>

#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"
#include "chimera/cli/batch/test_application.h"
#include "chimera/cli/batch/test_component.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::kUsage;
using cli::WordKind;
using Repeats = cli::Option::Repeats;

namespace {

int usage(const std::string& what) { return print({"", "chimera test: " + what + "\n", kUsage}); }

int test_cases(const Call& call, const Workplace& workplace) {
  cli::CasesRequest request{.places = call.operands,
                            .only = call.values("--case"),
                            .limit = seconds(600),
                            .junit = call.value("--junit"),
                            .json = call.json};
  read_number(call, "--jobs", request.jobs);
  if (!read_duration(call, "--limit", request.limit)) return kUsage;
  stop_run_at_signals();
  return cli::test_application(request, workplace, stdout, stderr);
}

int test_components(const Call& call, const Workplace& workplace) {
  cli::TestOptions options{.components = call.operands,
                           .all = call.has("--all"),
                           .setup = call.value("--setup"),
                           .inputs = call.value("--inputs"),
                           .names = call.values("--names"),
                           .json = call.json};
  read_number(call, "--seed", options.seed);
  read_number(call, "--cycles", options.cycles);
  return print(cli::test_components(options, workplace));
}

int test(const Call& call, const Workplace& workplace) {
  const auto is_given = [&call](std::initializer_list<const char*> options) {
    return std::any_of(options.begin(), options.end(), [&call](const char* option) { return call.has(option); });
  };
  const std::vector<std::string>& what = call.operands;
  if (!call.has("--all") && what.empty()) return usage("name a component, a folder with NAME.cases.yaml, or --all");
  const auto library = workplace.library();
  const auto places =
      library ? std::count_if(what.begin(), what.end(),
                              [&](const std::string& word) { return cli::is_place_of_cases(word, *library); })
              : 0;
  if (places == 0) {
    if (is_given({"--case", "--junit", "--jobs", "--limit"}))
      return usage("--case, --junit, --jobs and --limit belong to a folder with NAME.cases.yaml");
    return test_components(call, workplace);
  }
  if (places != static_cast<std::ptrdiff_t>(what.size())) return usage("components and folders are two calls");
  if (is_given({"--setup", "--inputs", "--names", "--seed", "--cycles"}))
    return usage("--setup, --inputs, --names, --seed and --cycles belong to a component; a case has keys of its own");
  return test_cases(call, workplace);
}

std::vector<cli::Option> test_options() {
  return {
      {.name = "--all", .help = "every installed component", .excludes = "WHAT"},
      {.name = "--setup",
       .value = "FILE",
       .help = "description of the task; left out: NAME.test.yaml beside the component",
       .manual = "The description of the task; left out: NAME.test.yaml beside the component, else one that is "
                 "made up.",
       .kind = WordKind::kFile},
      {.name = "--inputs",
       .value = "FILE",
       .help = "recording (CSV); left out: NAME.test.csv beside the component, else generated",
       .manual = "A recording, CSV as csv_log writes it; left out: NAME.test.csv beside the component, else "
                 "generated inputs.",
       .kind = WordKind::kFile},
      {.name = "--names",
       .value = "LIST",
       .help = "what in[0], in[1], ... of the recording are",
       .manual = "What in[0], in[1], ... of the recording are, with commas between.",
       .repeats = Repeats::kManyEach,
       .separator = ','},
      {.name = "--seed", .value = "NUMBER", .help = "of generated inputs; 1 when left out", .kind = WordKind::kNumber},
      {.name = "--cycles",
       .value = "NUMBER",
       .help = "of generated inputs; 1000 when left out",
       .kind = WordKind::kNumber,
       .least = 20,
       .most = 100'000},
      {.name = "--case",
       .value = "NAME",
       .help = "a folder: only the cases of this name; may be repeated",
       .manual = "A folder: only the cases of this name. May be repeated.",
       .repeats = Repeats::kOneEach},
      {.name = "--junit",
       .value = "FILE",
       .help = "a folder: write the report for a build machine (JUnit XML)",
       .manual = "A folder: writes the report for a build machine (JUnit XML).",
       .kind = WordKind::kFile},
      {.name = "--jobs",
       .value = "N",
       .help = "a folder: cases at a time; else as many as there are processors",
       .manual = "A folder: cases at a time; without it as many as there are processors.",
       .kind = WordKind::kNumber,
       .least = 1,
       .most = 1024},
      {.name = "--limit", .value = "DURATION", .help = "a folder: wall-clock time for each case (10 min)"}};
}

}  // namespace

FileCommand test_row() {
  return {
      .words = {.name = "test",
                .help = "Test components alone, or the applications of a folder, in virtual time",
                .operands = "[WHAT...]",
                .most = cli::kAnyNumber,
                .operand_kind = WordKind::kTestable,
                .operand_help = "a component, the path of a shared object, a folder with NAME.cases.yaml, or such a "
                                "file",
                .options = test_options(),
                .json = "the reports as one JSON object",
                .footer = "A component runs three times in a process of its own; docs/formats/component-test.md has "
                          "the setup.\nA folder: every case of every NAME.cases.yaml in it and below; "
                          "docs/formats/cases.md has the keys.\nA bare word that is both a component and a folder "
                          "is the component: write 'NAME/' for the folder.\n"
                          "Exit code 0: all pass, 1: one fails, or there is no test, 2: wrong usage.",
                .example = "chimera test pid_joint --inputs run.csv\nchimera test . --junit report.xml",
                .manual = "Runs each component WHAT (a name, or the path of a shared object, also one without "
                          "source) alone in virtual time, three times, each in a process of its own, and judges "
                          "what it does: its ports against its descriptor, its outputs, what a cycle asks of the "
                          "heap and of the system, whether the same inputs give the same outputs, how it comes back "
                          "from faults and bad inputs, what kill leaves. Its execution time is measured. What the "
                          "component cannot do without stands in NAME.test.yaml beside it. The exit code is 1 when "
                          "one fails. Of a folder WHAT (or a file): every case of every NAME.cases.yaml in it and "
                          "below, in virtual time; docs/formats/cases.md has the keys. A bare word that is both a "
                          "component and a folder is the component: write NAME/ for the folder.",
                .outlives_reader = true},
      .carry_out = test};
}
