// SPDX-License-Identifier: Apache-2.0
// Turns the records of the test runs of a component into judgements, one line each.
#include "chimera/component_test/judge.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "chimera/base/hosted/wording.h"
#include "chimera/component_test/judge_values.h"
#include "chimera/platform/forked_child.h"

namespace chimera::component_test {
namespace {

constexpr const char* kMethodNames[] = {"init", "reinit", "on", "cycle", "sync", "off", "kill", "error", "clear"};

// Mean of the middle half: as robust as the median, and finer than the steps of the clock.
double middle_mean(std::vector<std::int64_t> times) {
  if (times.empty()) return 0;
  std::ranges::sort(times);
  const std::size_t skipped = times.size() / 4, taken = times.size() - 2 * skipped;
  double sum = 0;
  for (std::size_t i = skipped; i < skipped + taken; ++i) sum += static_cast<double>(times[i]);
  return sum / static_cast<double>(taken);
}

struct Judge {
  const Trial& trial;
  const Circumstances& about;
  TrialReport report{};

  void say(const char* name, Finding finding, const std::string& text) {
    report.judgements.push_back({name, finding, text});
  }
  void ok(const char* name, const std::string& text) { say(name, Finding::kOk, text); }
  void fails(const char* name, const std::string& text) { say(name, Finding::kFails, text); }
  void not_judged(const char* name, const std::string& text) { say(name, Finding::kNotJudged, text); }

  bool has_resources() const {
    return std::ranges::any_of(about.component.ports,
                               [](const PortDescriptor& port) { return port.kind == CHIMERA_RESOURCE; });
  }
  static bool is_completed(const RowRecord& row) {
    return row.is_run && static_cast<Answer>(row.answer) == Answer::kOk;
  }
  std::size_t completed() const {
    return static_cast<std::size_t>(std::ranges::count_if(trial.counted.rows(), is_completed));
  }

  /// False: the test ended too early to be judged.
  bool start() {
    const Record& record = trial.counted.record();
    if (record.refusal[0] != '\0') return fails("start", record.refusal), false;
    if (record.stage < Stage::kRows) return fails("start", how_it_ended(trial.counted_end, record)), false;
    std::string methods;
    for (std::size_t m = 0; m < CHIMERA_METHODS; ++m)
      if (about.component.methods[m]) append_joined(methods, " ", kMethodNames[m]);
    ok("start", counted(about.component.ports.size(), "port") + " as the descriptor says; methods " + methods);
    return true;
  }

  void cycles() {
    const Record& record = trial.counted.record();
    if (const std::string how = how_it_ended(trial.counted_end, record); !how.empty()) return fails("cycles", how);
    const std::size_t done = completed();
    const std::string first = record.rejected == 0
                                  ? ""
                                  : ", the first with " + in_double_quotes(record.first_text) + " in cycle " +
                                        std::to_string(record.first_rejected);
    if (record.rejected > 0 && about.inputs.are_recorded())
      return fails("cycles", counted(record.rejected, "cycle") + " of " + std::to_string(about.inputs.rows()) +
                                 " ended in a fault" + first);
    if (done == 0)
      return fails("cycles", "none of " + std::to_string(about.inputs.rows()) + " was completed" + first +
                                 "; NAME.test.yaml and --inputs give it something to work on");
    const std::string refused =
        record.rejected == 0 ? "" : "; " + counted(record.rejected, "was", "were") + " refused" + first;
    ok("cycles", counted(done, "cycle") + " completed" + refused);
  }

  void outputs() {
    const Record& record = trial.counted.record();
    if (record.unsafe > 0)
      return fails("outputs", counted(record.unsafe, "publication was", "publications were") +
                                  " refused, the first with " + in_double_quotes(record.unsafe_text));
    const auto rows = trial.counted.rows();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!is_completed(rows[i])) continue;
      const auto why = first_unsound(about.configuration, about.component, record.counts, trial.counted.outputs(i),
                                     rows[i].valid, true);
      if (why) return fails("outputs", *why + " in cycle " + std::to_string(i));
    }
    if (completed() == 0) return not_judged("outputs", "no cycle was completed");
    ok("outputs", "written, finite and within their ranges in every cycle");
  }

  void allocations() {
    const Record& record = trial.counted.record();
    for (const std::uint32_t m : {CHIMERA_CYCLE, CHIMERA_SYNC, CHIMERA_ON, CHIMERA_OFF}) {
      const MethodRecord& method = record.methods[m];
      if (method.allocations > 0)
        return fails("allocations", std::string(kMethodNames[m]) + " allocates: at most " +
                                        counted(method.most_allocations, "block") + " in one call, " +
                                        std::to_string(method.allocations) + " in " +
                                        counted(method.calls, "call"));
    }
    ok("allocations", "none in " + counted(record.methods[CHIMERA_CYCLE].calls, "cycle") + ", on and off");
  }

  void system_calls() {
    const Record& record = trial.counted.record();
    if (!record.is_traced) return not_judged("system calls", "this machine lets no process trace its child");
    std::string text;
    // A switch of configurations runs on and off beside the cycles of other tasks.
    for (const std::uint32_t m : {CHIMERA_CYCLE, CHIMERA_SYNC, CHIMERA_ON, CHIMERA_OFF}) {
      const MethodRecord& method = record.methods[m];
      if (method.system_calls == 0) continue;
      append_joined(text, "; ", std::string(kMethodNames[m]) + ": at most " +
                                    std::to_string(method.most_system_calls) + " in one call, " +
                                    std::to_string(method.system_calls) + " in " + counted(method.calls, "call") +
                                    ", the first " + system_call_name(method.first_system_call));
    }
    if (text.empty()) return ok("system calls", "none in a cycle, on and off");
    if (!has_resources()) return fails("system calls", text + "; and the component has no resource port");
    const std::uint64_t of_cycle = record.methods[CHIMERA_CYCLE].most_system_calls;
    if (record.methods[CHIMERA_ON].most_system_calls > std::max<std::uint64_t>(of_cycle, 1))
      return fails("system calls", text + "; on runs beside the cycles of others: it makes no more than a cycle");
    ok("system calls", text + "; it uses a resource");
  }

  void repeatable() {
    if (about.has_partner) return not_judged("repeatable", "a partner answers it: two runs may differ");
    if (const std::string how = how_it_ended(trial.timed_end, trial.timed.record()); !how.empty())
      return fails("repeatable", "the second time: " + how);
    const auto first = trial.counted.rows(), second = trial.timed.rows();
    for (std::size_t i = 0; i < first.size(); ++i) {
      const auto a = trial.counted.outputs(i), b = trial.timed.outputs(i);
      if (first[i].answer == second[i].answer && first[i].state == second[i].state &&
          (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0))
        continue;
      return fails("repeatable", "the same inputs gave other outputs the second time, in cycle " + std::to_string(i));
    }
    ok("repeatable", "the same inputs gave the same outputs twice, to the bit");
  }

  /// False: the scenario ended in `stage`; the judgement `name` says so.
  bool reached(const char* name, Stage stage) {
    const Record& record = trial.troubled.record();
    if (record.stage > stage) return true;
    std::string how = how_it_ended(trial.troubled_end, record);
    if (how.empty()) how = record.refusal;
    if (record.stage == stage)
      fails(name, how);
    else
      not_judged(name, "the test ended before this");
    return false;
  }

  void faults() {
    if (!reached("faults", Stage::kFaults)) return;
    static constexpr const char* kReturns[] = {"", "went on", "on", "clear, on", "spawn, on", ""};
    std::string tried;
    for (std::size_t m = 0; m < CHIMERA_METHODS; ++m) {
      const Trouble& trouble = trial.troubled.record().faults[m];
      if (!trouble.is_tried || !trouble.has_happened) continue;
      const std::string after = std::string("after a fault in ") + kMethodNames[m];
      if (trouble.refused_clear && m != CHIMERA_CLEAR)
        return fails("faults", after + " clear returns false although the cause is gone");
      if (trouble.how == Return::kNot)
        return fails("faults", after + " it does not come back: " + in_double_quotes(trouble.text));
      if (!trouble.is_finite) return fails("faults", after + " its outputs are not finite");
      append_joined(tried, "; ",
                    std::string(kMethodNames[m]) + ": " + kReturns[static_cast<std::size_t>(trouble.how)]);
    }
    ok("faults", "came back after a fault in " + tried);
  }

  void bad_inputs() {
    if (!reached("bad inputs", Stage::kBadInputs)) return;
    std::string tried;
    for (std::size_t kind = 0; kind < kBadInputs; ++kind) {
      const Trouble& trouble = trial.troubled.record().bad_inputs[kind];
      if (!trouble.is_tried || !trouble.has_happened) continue;
      const std::string after = std::string("after ") + spoilt_name(kind);
      if (trouble.refused_clear)
        return fails("bad inputs", after + " clear returns false although the inputs are good again");
      if (trouble.how == Return::kNot) return fails("bad inputs", after + " it does not come back");
      if (!trouble.is_finite)
        return fails("bad inputs", after + " its outputs are still not finite 100 good cycles later");
      append_joined(tried, "; ", std::string(spoilt_name(kind)) + ": " +
                                     (trouble.is_rejected ? "refused, " + in_double_quotes(trouble.text)
                                                          : "accepted; good outputs again once the inputs are good"));
    }
    if (tried.empty()) return not_judged("bad inputs", "it has no in-vars that could be bad");
    ok("bad inputs", tried);
  }

  void safe_state() {
    const SafeStateRecord& record = trial.troubled.record().safe_state;
    if (!reached("safe state", Stage::kSafeState)) return;
    if (!record.is_tried) return not_judged("safe state", "it has no output that is a safe state");
    if (record.cycles == 0)
      return fails("safe state", "not reached within 5 s of cycles under the illegal-configuration flag");
    if (!record.is_left) return fails("safe state", "still told 5 s of cycles after the flag went down");
    ok("safe state", "reached under the illegal-configuration flag in cycle " + std::to_string(record.cycles) +
                         ", and left when it is down");
  }

  void leftovers() {
    if (!reached("leftovers", Stage::kLeftovers)) return;
    const Record& record = trial.troubled.record();
    const Round& early = record.rounds[1];
    const Round& late = record.rounds[kRounds - 1];
    const auto grown = [&](const char* what, std::int64_t n, const std::string& which) {
      fails("leftovers", "every two rounds of spawn and kill leave " + std::to_string(n) + " " + what + which);
    };
    if (late.descriptors > early.descriptors)
      return grown("open descriptors", late.descriptors - early.descriptors,
                   std::string(", such as ") + record.left_open);
    if (late.threads > early.threads) return grown("threads", late.threads - early.threads, "");
    if (late.blocks > early.blocks) return grown("blocks of memory", late.blocks - early.blocks, "");
    ok("leftovers", "repeated spawn and kill leave no open descriptor, thread or memory");
  }

  void measure() {
    const Record& record = trial.timed.record();
    const double own = middle_mean({std::begin(record.measuring_ns), std::end(record.measuring_ns)});
    std::int64_t worst = 0;
    std::size_t cycles = 0;
    const auto rows = trial.timed.rows();
    for (const RowRecord& row : rows.subspan(rows.size() / 10)) {
      if (!is_completed(row)) continue;
      worst = std::max(worst, row.time_ns);
      ++cycles;
    }
    if (cycles == 0) return;
    const double typical = std::max(0.0, middle_mean(trial.times_ns) - own);
    report.measured = {cycles, typical, std::max(std::llround(typical), worst - std::llround(own))};
  }
};

}  // namespace

bool TrialReport::passes() const noexcept {
  return std::ranges::none_of(judgements, [](const JudgedProperty& one) { return one.verdict == Finding::kFails; });
}

std::string how_it_ended(const PlayEnd& end, const Record& record) {
  if (end.is_clean()) return record.refusal;
  const bool is_in_method = record.method < CHIMERA_METHODS;
  std::string where = is_in_method                    ? std::string(" in ") + kMethodNames[record.method]
                      : record.stage == Stage::kStart ? " in its constructor"
                                                      : " while it was loaded";
  if (is_in_method && record.stage == Stage::kRows) where += " " + std::to_string(record.row);
  if (end.has_hung) return "no progress, ended" + where;
  if (!end.process.by_signal) return "its process ended with code " + std::to_string(end.process.code) + where;
  return "killed by signal " + std::to_string(end.process.code) + " (" + ::strsignal(end.process.code) + ")" + where;
}

TrialReport judge(const Trial& trial, const Circumstances& about) {
  Judge judge{trial, about};
  judge.report.component = about.component.name;
  if (!judge.start()) return judge.report;
  judge.cycles();
  judge.outputs();
  judge.allocations();
  judge.system_calls();
  judge.repeatable();
  judge.faults();
  judge.bad_inputs();
  judge.safe_state();
  judge.leftovers();
  judge.measure();
  return judge.report;
}

}  // namespace chimera::component_test
