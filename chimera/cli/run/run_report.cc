// SPDX-License-Identifier: Apache-2.0
// Prints the report of a run as text or JSON and derives its exit code.
#include "chimera/cli/run/run_report.h"

#include <algorithm>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/run/profile_report.h"
#include "chimera/text/json_text.h"

namespace chimera::cli {
namespace {

const char* word(RunEnd end) {
  switch (end) {
    case RunEnd::kTime: return "time";
    case RunEnd::kStopped: return "stopped";
    case RunEnd::kNothingLeft: return "nothing-left";
    case RunEnd::kTaskStopped: return "stopped-by-task";
  }
  return "?";
}

std::string sentence(const RunReport& report) {
  switch (report.end) {
    case RunEnd::kTime: return "";
    case RunEnd::kStopped:
      return ", ended " + (report.stopped_by.empty() ? "by the operator" : "because " + report.stopped_by);
    case RunEnd::kNothingLeft: return ", ended because no task was ON any more";
    case RunEnd::kTaskStopped:
      return ", ended by the reaction `stop` of " +
             (report.stopped_by.empty() ? "a task" : "task '" + report.stopped_by + "'");
  }
  return "";
}

void print_json(const RunReport& report, std::FILE* out) {
  const std::string variables = join(report.variables, ", ", [](const RunReport::Watched& v) {
    return json_string(v.name) + ": {\"unit\": " + json_string(v.unit) + ", \"value\": " + v.value + "}";
  });
  const std::string expectations = join(report.expectations, ", ", [](const RunReport::Judged& e) {
    return "{\"text\": " + json_string(e.text) + ", \"holds\": " + (e.holds ? "true" : "false") +
           ", \"said\": " + json_string(e.said) + "}";
  });
  std::fprintf(out,
               "{\"subsystem\": %s, \"executor\": %s, \"ran_ns\": %lld, \"ended\": \"%s\", \"flag\": %s, "
               "\"tasks\": %s, \"variables\": {%s}, \"expectations\": [%s], \"receipts\": [%s], "
               "\"receipts_left_out\": %llu, \"verdict\": %s}\n",
               json_string(report.subsystem).c_str(), json_string(report.executor).c_str(),
               static_cast<long long>(report.ran.count), word(report.end), report.is_flag_up ? "true" : "false",
               spaced_json(profile_json(report.profiles, report.origin)).c_str(), variables.c_str(),
               expectations.c_str(), report.receipts.c_str(), static_cast<unsigned long long>(report.receipts_left_out),
               report.verdict.json().c_str());
}

}  // namespace

void RunReport::judge(const Expectation& expectation, const Seen& seen) {
  Judged judged{expectation.text(), {}, false};
  judged.holds = expectation.holds(seen, judged.said);
  expectations.push_back(std::move(judged));
}

int RunReport::code() const {
  const bool all_hold =
      std::all_of(expectations.begin(), expectations.end(), [](const Judged& judged) { return judged.holds; });
  return all_hold && end != RunEnd::kTaskStopped && !verdict.is_failure() ? kOk : kRefused;
}

std::string note_line(std::string_view task, std::string_view note) {
  return plain_line(std::string(task) + ": note: " + std::string(note));
}

bool save_profile(const RunReport& report, const std::string& path, std::FILE* err) {
  if (path.empty()) return true;
  const auto written = write_recorded_profile(path, recorded(report.subsystem, report.profiles));
  if (!written) std::fprintf(err, "%s: %s\n", path.c_str(), written.error().message.c_str());
  return static_cast<bool>(written);
}

void print(const RunReport& report, bool json, std::FILE* out) {
  if (json) return print_json(report, out);
  std::string lines;
  for (const RunReport::Judged& e : report.expectations)
    lines += (e.holds ? "holds: " : "FAILS: ") + e.text + " (" + e.said + ")\n";
  std::string text = "ran " + seconds_text(report.ran) + " s" + sentence(report) + "\n";
  if (report.is_flag_up) text += "the illegal-configuration flag is up\n";
  text += report.refused + report.switches;
  if (report.receipts_left_out > 0)
    text += "and " + std::to_string(report.receipts_left_out) +
            " switches before the last, of which no receipt is kept\n";
  text += profile_table(report.profiles, report.ran, report.origin) + lines + report.verdict.text();
  std::fputs(for_terminal(text).c_str(), out);
}

}  // namespace chimera::cli
