// SPDX-License-Identifier: Apache-2.0
// Asks for the variables of the task `sequence`, and finds the number of a step by its name.
#include "chimera/cli/live/sequence_command.h"

#include <algorithm>
#include <string>
#include <vector>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/fields.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"

namespace chimera::cli {
namespace {

constexpr const char* kSequenceNames[] = {"sequence_steps", "sequence_step", "sequence_state", "sequence_waited"};

// In the order of `sequence_state`.
constexpr const char* kSequenceStates[] = {"paused",      "switches", "runs", "waits for Go",
                                           "interrupted", "failed",   "done", "begins"};

constexpr std::int64_t kDone = 6;

std::vector<std::string> steps_of(const Json& answer) {
  std::vector<std::string> names;
  const Json& value = answer["values"]["sequence_steps"]["value"];
  if (value.is_array())
    for (const Json& name : value) names.push_back(name.is_string() ? std::string(name.as_string()) : "");
  return names;
}

std::int64_t sequence_number(const Json& answer, const char* name) { return whole_of(answer["values"][name], "value"); }

CommandResult wrong_words(const std::string& message, bool json) {
  return refused(Error{ErrorCode::kBadInput, std::string_view(message), {}}, json, kUsage);
}

/// The number of the step that is named or numbered, from 1; 0: none.
std::size_t step_named(const std::vector<std::string>& steps, const std::string& word) {
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] == word || std::to_string(i + 1) == word) return i + 1;
  return 0;
}

/// The words of a step that runs or switches: "waits for q >= 1 rad, 1.5 s of 3 s".
std::string wait_text(const std::string& state, const Json& step, const std::string& waited) {
  const std::string until = text_of(step, "until"), time = text_of(step, "for");
  const bool runs = state == "runs";
  const std::string limit = runs && until.empty() ? time : text_of(step, "within");
  const std::string of = waited + (limit.empty() ? "" : " of " + plain_line(limit));
  return runs && !until.empty() ? "waits for " + plain_line(until) + ", " + of : state + " for " + of;
}

}  // namespace

std::string sequence_text(const Json& answer, const Json& described) {
  const std::vector<std::string> steps = steps_of(answer);
  const auto present = static_cast<std::size_t>(sequence_number(answer, "sequence_step"));
  const auto state = static_cast<std::size_t>(sequence_number(answer, "sequence_state"));
  const std::string word = state < std::size(kSequenceStates) ? kSequenceStates[state] : "?";
  std::string text = present == 0 ? word + "\n" : "";
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool is_present = i + 1 == present;
    text += (is_present ? "> " : "  ") + std::to_string(i + 1) + ' ' + plain_line(steps[i]);
    const std::string waited = text_of(answer["values"]["sequence_waited"], "text");
    const bool waits = word == "runs" || word == "switches";
    if (is_present) text += "  " + (waits ? wait_text(word, described["sequence"]["steps"][i], waited) : word);
    text += '\n';
  }
  return text;
}

CommandResult sequence(Session& session, const Call& call, const Screen&) {
  const control::RpcResponse answer = session.ask("get", {{"variables", Json(std::vector<std::string>(
                                                              std::begin(kSequenceNames), std::end(kSequenceNames)))}});
  if (!answer.is_good()) return refused(answer, call.json);
  const std::string act = call.operand(0), word = call.operand(1);
  if (act.empty())
    return answered(answer, call.json, [&session](const Json& values) {
      const control::RpcResponse described = session.ask("describe");
      return sequence_text(values, described.is_good() ? *described.result : Json());
    });
  if ((act != "go" && act != "pause") || (act == "pause" && !word.empty()))
    return wrong_words("sequence: found '" + join(call.operands, " ") + "', expected go, go STEP or pause", call.json);
  const std::vector<std::string> steps = steps_of(*answer.result);
  std::size_t go = 0;
  if (act == "go" && word.empty()) {
    const bool is_done = sequence_number(*answer.result, "sequence_state") == kDone;
    const std::int64_t present = is_done ? 1 : sequence_number(*answer.result, "sequence_step");
    go = static_cast<std::size_t>(std::max<std::int64_t>(present, 1));
  }
  if (act == "go" && !word.empty() && (go = step_named(steps, word)) == 0)
    return wrong_words("sequence: " + no_such("step", word, steps), call.json);
  const control::RpcResponse set = session.ask("set", {{"values", {{"sequence_go", static_cast<std::int64_t>(go)}}}});
  return answered(set, call.json, [](const Json& done) {
    const std::int64_t step = whole_of(done["values"]["sequence_go"], "value");
    return step == 0 ? std::string("paused\n") : "goes to step " + std::to_string(step) + "\n";
  });
}

}  // namespace chimera::cli
