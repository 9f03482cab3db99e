// SPDX-License-Identifier: Apache-2.0
// `chimera sweep`: a description in virtual time over lists of values.
#include "chimera/cli/batch/sweep.h"

#include <cstdio>

#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::kUsage;
using cli::WordKind;
using Repeats = cli::Option::Repeats;

namespace {

int sweep(const Call& call, const Workplace& workplace) {
  cli::SweepRequest request;
  request.over = call.values("--over");
  request.limit = seconds(600);
  request.csv = call.value("--csv");
  request.svg = call.value("--svg");
  request.json = call.json;
  request.each.measures = call.values("--measure");
  request.each.expect = call.values("--expect");
  read_number(call, "--jobs", request.jobs);
  cli::RunRequest& run = request.each.run;
  run.file = call.operand(0);
  run.at = call.values("--at");
  run.preemptive = call.has("--preemptive");
  if (!read_duration(call, "--for", run.duration) || !read_duration(call, "--every", request.each.every) ||
      !read_duration(call, "--quantum", run.quantum) || !read_duration(call, "--limit", request.limit))
    return kUsage;
  if (call.has("--seed")) read_number(call, "--seed", run.seed.emplace());
  if (request.each.measures.empty() && request.each.expect.empty()) {
    std::fputs("chimera sweep: name what to look at: --measure 'max |error|', or --expect 'error <= 2 mrad'\n", stderr);
    return kUsage;
  }
  run.virtual_time = true;
  run.settings = settings_of(call);
  stop_run_at_signals();
  return cli::sweep(request, workplace, stdout, stderr);
}

std::vector<cli::Option> swept_options() {
  return {
      {.name = "--over",
       .value = "LIST",
       .help = "'kp = 1, 2, 5 N.m/rad' or 'kp = [0.5:0.5:5] N.m/rad' (first, step, last); repeated: all combinations",
       .manual = "'kp = 1, 2, 5 N.m/rad', or 'kp = [0.5:0.5:5] N.m/rad' (first, step, last). A value without a unit "
                 "has that of the last one. At most 100000 runs. May be repeated.",
       .repeats = Repeats::kOneEach,
       .is_required = true},
      {.name = "--for",
       .value = "DURATION",
       .help = "how long each run is, such as '10 s'",
       .manual = "How long each run is.",
       .is_required = true},
      {.name = "--measure",
       .value = "MEASURE",
       .help = "a column: 'q', 'max |error|', 'min v', 'mean v', 'rms tau[2]', 'settling error <= 2 mrad'; may be "
               "repeated",
       .manual = "A column: 'q', 'max |error|', 'min v', 'mean v', 'rms tau[2]', 'settling error <= 2 mrad' "
                 "(docs/formats/cases.md). May be repeated.",
       .repeats = Repeats::kOneEach},
      {.name = "--expect",
       .value = "EXPECTATION",
       .help = "must hold in every run: 'error <= 2 mrad' at the end, 'max |error| <= 9 mrad', 'settling error <= 2 "
               "mrad within 1 s'; may be repeated",
       .manual = "Must hold in every run: 'error <= 2 mrad' at the end, 'max |error| <= 9 mrad', 'settling error <= "
                 "2 mrad within 1 s'. May be repeated.",
       .repeats = Repeats::kOneEach},
      set_option("This value in every run, as of `run`.")};
}

std::vector<cli::Option> run_options() {
  return {{.name = "--at",
           .value = "ACT",
           .help = "a timed act of every run, as of `run`; may be repeated",
           .manual = "A timed act of every run, as of `run`.",
           .repeats = Repeats::kOneEach},
          {.name = "--every",
           .value = "DURATION",
           .help = "distance of the samples that are measured; else the shortest period",
           .manual = "Distance of the samples that are measured; without it the shortest period."},
          {.name = "--jobs",
           .value = "N",
           .help = "runs at a time; else as many as there are processors",
           .manual = "Runs at a time; without it as many as there are processors. The table is the same.",
           .kind = WordKind::kNumber,
           .least = 1,
           .most = 1024},
          {.name = "--limit",
           .value = "DURATION",
           .help = "wall-clock time for each run; a run that takes longer has failed (10 min)"},
          {.name = "--preemptive", .help = "schedule preemptively", .manual = "Schedules preemptively."},
          {.name = "--seed",
           .value = "N",
           .help = "draw execution times from [min, budget], the same in every run",
           .manual = "Draws execution times from [min, budget], the same in every run.",
           .kind = WordKind::kNumber},
          {.name = "--quantum",
           .value = "DURATION",
           .help = "laxity policies: compare again this often (1 ms)",
           .manual = "Laxity policies compare again this often (1 ms)."},
          {.name = "--csv",
           .value = "FILE",
           .help = "write the table to this file, with exact numbers",
           .manual = "Writes the table to this file, with exact numbers.",
           .kind = WordKind::kFile},
          {.name = "--svg",
           .value = "FILE",
           .help = "draw every measure over the first list to this file",
           .manual = "Draws every measure over the first list to this file.",
           .kind = WordKind::kFile}};
}

std::vector<cli::Option> sweep_options() {
  std::vector<cli::Option> options = swept_options();
  for (const cli::Option& option : run_options()) options.push_back(option);
  return options;
}

}  // namespace

FileCommand sweep_row() {
  return {
      .words = {.name = "sweep",
                .help = "Run a description in virtual time over lists of values",
                .operands = "FILE",
                .least = 1,
                .most = 1,
                .operand_kind = WordKind::kDescription,
                .operand_help = "the description",
                .options = sweep_options(),
                .json = "the table as one JSON object",
                .footer = "One row a run, the first list varying slowest. A run that is refused, crashes or hangs is "
                          "a row that\nsays so. Exit code 0: every run came to its end and every --expect holds.",
                .example = "chimera sweep examples/01_puma_pid/puma_pid.yaml --over 'kd = [10:10:60] N.m.s/rad' "
                           "--for '2 s' --measure 'max error_now'",
                .manual = "Runs FILE in virtual time over lists of values, all combinations, side by side, each in "
                          "a process of its own, and prints a table: a row a run, the first list varying slowest. "
                          "A run that is refused, crashes or hangs is a row that says so. Exit code 0: every run "
                          "came to its end and every `--expect` holds.",
                .outlives_reader = true},
      .carry_out = sweep};
}
