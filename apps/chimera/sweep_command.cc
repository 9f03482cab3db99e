// SPDX-License-Identifier: Apache-2.0
#include "apps/chimera/sweep_command.h"

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "chimera/desk/output.h"

using namespace chimera;  // NOLINT: a main() of this project

void add_sweep(CLI::App& app, SweepWords& words) {
  CLI::App* s = app.add_subcommand("sweep", "Run a description in virtual time over lists of values");
  desk::MeasuredRequest& each = words.sweep.each;
  s->add_option("FILE", each.run.file, "the description")->required();
  const auto add_texts = [s](const char* name, std::vector<std::string>& texts, const char* help) {
    return s->add_option(name, texts, help)->allow_extra_args(false);
  };
  add_texts("--over", words.sweep.over,
            "'kp = 1, 2, 5 N.m/rad' or 'kp = [0.5:0.5:5] N.m/rad' (first, step, last); repeated: all combinations")
      ->required();
  s->add_option("--for", words.duration, "how long each run is, such as '10 s'")->required();
  add_texts(
      "--measure", each.measures,
      "a column: 'q', 'max |error|', 'min v', 'mean v', 'rms tau[2]', 'settling error <= 2 mrad'; may be repeated");
  add_texts("--expect", each.expect,
            "must hold in every run: 'error <= 2 mrad' at the end, 'max |error| <= 9 mrad', 'settling error <= 2 mrad "
            "within 1 s'; may be repeated");
  add_set_option(*s, words.set);
  add_texts("--at", each.run.at, "a timed act of every run, as of `run`; may be repeated");
  s->add_option("--every", words.every, "distance of the samples that are measured; else the shortest period");
  s->add_option("--jobs", words.sweep.jobs, "runs at a time; else as many as there are processors")
      ->check(CLI::Range(1, 1024));
  s->add_option("--limit", words.limit, "time on the wall for each run; one that takes longer has failed (10 min)");
  s->add_flag("--preemptive", each.run.preemptive, "schedule preemptively");
  s->add_option("--seed", words.seed, "draw execution times from [min, budget], the same in every run");
  s->add_option("--quantum", words.quantum, "laxity policies: compare again this often (1 ms)");
  add_file_option(*s, "--csv", words.sweep.csv, "write the table to this file, with exact numbers");
  add_file_option(*s, "--svg", words.sweep.svg, "draw every measure over the first list to this file");
  s->add_flag("--json", words.sweep.json, "the table as one JSON object");
  s->footer(
      "One row a run, the first list varying slowest. A run that is refused, crashes or hangs is a row that\n"
      "says so. Exit code 0: every run came to its end and every --expect holds.\n"
      "Example: chimera sweep examples/01_puma_pid/puma_pid.yaml --over 'kd = [10:10:60] N.m.s/rad' --for '2 s' "
      "--measure 'max error_now'");
}

int carry_out_sweep(SweepWords& words, const desk::Workplace& workplace) {
  desk::RunRequest& run = words.sweep.each.run;
  words.sweep.limit = seconds(600);
  if (!read_duration(words.duration, "--for", run.duration) ||
      !read_duration(words.every, "--every", words.sweep.each.every) ||
      !read_duration(words.quantum, "--quantum", run.quantum) ||
      !read_duration(words.limit, "--limit", words.sweep.limit) || !read_seed(words.seed, run.seed))
    return desk::kUsage;
  if (words.sweep.each.measures.empty() && words.sweep.each.expect.empty()) {
    std::fputs("chimera sweep: name what to look at: --measure 'max |error|', or --expect 'error <= 2 mrad'\n", stderr);
    return desk::kUsage;
  }
  run.virtual_time = true;
  run.settings = settings_of(words.set);
  std::signal(SIGINT, [](int) { desk::request_stop(); });
  std::signal(SIGTERM, [](int) { desk::request_stop(); });
  return desk::sweep(words.sweep, workplace, stdout, stderr);
}
