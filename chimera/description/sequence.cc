// SPDX-License-Identifier: Apache-2.0
// Reads the steps, judges their form, and writes them as the constants of one task.
#include "chimera/description/sequence.h"

#include <algorithm>

#include "chimera/description/draft.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/keys.h"
#include "chimera/description/yaml_words.h"

namespace chimera {
namespace {

constexpr std::array<std::string_view, 2> kTruthWords = {"false", "true"};
constexpr const char* kStop = "stop";
constexpr Nanoseconds kWithin = seconds(10);  // for a switch alone, if the step says nothing
constexpr Nanoseconds kBudget = microseconds(20);
constexpr const char* kExample = "write {switch: CONFIGURATION, until: 'closed == true', within: 10 s, else: stop}";

class StepReader {
 public:
  StepReader(const Node& node, std::size_t number, Report& report)
      : node_(node), what_("step " + std::to_string(number) + " of 'sequence'"), report_(report) {}

  DraftStep read(bool is_last, bool repeats) {
    DraftStep step;
    step.at = node_.at;
    step.within = kWithin;
    if (!expect(node_, Node::Kind::kMap, what_, report_)) return step;
    refuse_unknown_keys(node_, kStepKeys, what_, report_);
    if (const Node* to = node_.find("switch"))
      step.configuration = read_name(*to, said("switch"), report_).value_or(Word{});
    else
      refuse("key-missing", node_.at, "'switch' of " + what_ + " is missing", "switch", kExample);
    step.name = step.configuration;
    if (const Node* name = node_.find("name")) step.name = read_name(*name, said("name"), report_).value_or(Word{});
    if (const Node* until = node_.find("until")) step.until = read_condition(*until, said("until"), report_);
    if (const Node* name = node_.find("else")) step.otherwise = read_name(*name, said("else"), report_);
    step.wait = duration("for", {});
    step.within = duration("within", kWithin);
    step.confirm = truth("confirm");
    step.reentry = truth("reentry");
    judge_end(is_last, repeats);
    return step;
  }

 private:
  std::string said(std::string_view key) const { return "'" + std::string(key) + "' of " + what_; }
  void refuse(std::string_view rule, Place at, std::string message, std::string expected, std::string remedy) {
    report_.add({.rule = rule, .at = at, .message = std::move(message), .expected = std::move(expected),
                 .remedy = std::move(remedy)});
  }

  Nanoseconds duration(std::string_view key, Nanoseconds otherwise) {
    const Node* node = node_.find(key);
    if (node == nullptr) return otherwise;
    const auto time = read_duration(*node, said(key), report_);
    if (time && time->value.count == 0)
      refuse("sequence-wait", node->at, said(key) + " is 0 ns; expected more than 0", "more than 0",
             "a step takes time, so that no circle of steps runs without it");
    return time ? time->value : otherwise;
  }
  bool truth(std::string_view key) {
    const Node* node = node_.find(key);
    if (node == nullptr) return false;
    const auto index = read_choice(*node, kTruthWords, said(key), report_);
    return index && index->value == 1;
  }

  /// A step ends in a time that the text gives.
  void judge_end(bool is_last, bool repeats) {
    const bool has_until = node_.find("until") != nullptr, has_for = node_.find("for") != nullptr;
    if (has_until && has_for)
      refuse("sequence-step", node_.find("for")->at, what_ + " has 'until' and 'for'", "one of the two",
             "take one of the two out; 'within' limits the time of 'until'");
    if (!has_until && !has_for && (!is_last || repeats))
      refuse("sequence-wait", node_.at,
             what_ + " has neither 'until' nor 'for': it never ends, and nothing reaches the step behind it",
             "until or for", "write until: 'VARIABLE == VALUE', or for: 1 s; only the last step may stay");
    if (has_until && node_.find("within") == nullptr)
      refuse("sequence-wait", node_.find("until")->at,
             said("until") + " may never hold, and no 'within' limits the time: the step may have no way out", "within",
             "write within: 10 s, and else: the name of a step, or stop");
  }

  const Node& node_;
  const std::string what_;
  Report& report_;
};

Node scalar_at(std::string text, Place at) {
  Node node;
  node.kind = Node::Kind::kScalar;
  node.at = at;
  node.text = std::move(text);
  return node;
}

Node list_at(Place at) {
  Node node;
  node.kind = Node::Kind::kList;
  node.at = at;
  return node;
}

std::string truth_text(bool truth) { return std::string(kTruthWords[truth ? 1 : 0]); }
std::string time_text(Nanoseconds time) { return std::to_string(time.count) + " ns"; }

/// The number of the step that `name` names, or nothing after a fault.
std::optional<std::size_t> find_step(const DraftSequence& sequence, const DraftStep& from, Report& report) {
  const Word& name = *from.otherwise;
  std::optional<std::size_t> found;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < sequence.steps.size(); ++i) {
    const DraftStep& step = sequence.steps[i];
    names.push_back(step.name.text);
    if (step.name.text != name.text) continue;
    if (found)
      report.add({.rule = "sequence-step", .at = name.at,
                  .message = "'else' of " + sequence.say(from) + " names '" + name.text + "', and so are " +
                             sequence.say(sequence.steps[*found]) + " and " + sequence.say(step) + " called",
                  .found = name.text, .expected = "the name of one step",
                  .remedy = "write name: in one of the two"});
    found = i;
  }
  if (found) return found;
  const std::vector<std::string_view> views(names.begin(), names.end());
  report.add({.rule = "sequence-step", .at = name.at,
              .message = "'else' of " + sequence.say(from) + " names the step '" + name.text + "', which is not there",
              .found = name.text, .expected = listed(names) + ", or stop", .nearest = closest(name.text, views),
              .remedy = closest(name.text, views).empty() ? "there are: " + listed(names) + ", or stop" : ""});
  return found;
}

/// Writes the steps as the constants of the task.
class TaskWriter {
 public:
  TaskWriter(const DraftSequence& sequence, Report& report) : sequence_(sequence), report_(report) {}

  void write(DraftTask& task) {
    Node configurations = list_at(sequence_.at), levels = list_at(sequence_.at), steps = list_at(sequence_.at);
    DraftAlias values{.port = {"value", sequence_.at}, .variables = {}, .is_list = true};
    for (const DraftStep& step : sequence_.steps) {
      configurations.items.push_back(scalar_at(step.configuration.text, step.configuration.at));
      steps.items.push_back(step_node(step, values.variables.size()));
      if (!step.until) continue;
      values.variables.push_back(step.until->variable);
      levels.items.push_back(level_of(step.until->value));
    }
    task.alias.push_back(std::move(values));
    const auto give = [&](const char* port, Node node) {
      task.constants.push_back({{port, sequence_.at}, std::move(node)});
    };
    give("configuration", std::move(configurations));
    give("step", std::move(steps));
    give("repeat", scalar_at(truth_text(sequence_.repeat), sequence_.at));
    if (!levels.items.empty()) give("level", std::move(levels));
  }

 private:
  // A level is a number in the unit of its variable; rule_sequence.cc refuses a truth value for a number.
  static Node level_of(const Node& value) {
    Node level = value;
    for (std::size_t i = 0; i < kTruthWords.size(); ++i)
      if (level.text == kTruthWords[i]) level.text = std::to_string(i);
    return level;
  }

  Node step_node(const DraftStep& step, std::size_t input) {
    Node node;
    node.kind = Node::Kind::kMap;
    node.at = step.at;
    const auto put = [&](const char* field, std::string text) {
      node.keys.push_back({field, step.at});
      node.items.push_back(scalar_at(std::move(text), step.at));
    };
    std::string otherwise = "-1";
    if (step.otherwise && step.otherwise->text != kStop)
      if (const auto to = find_step(sequence_, step, report_)) otherwise = std::to_string(*to);
    put("name", step.name.text);
    put("within", time_text(step.within));
    put("wait", time_text(step.wait));
    put("input", step.until ? std::to_string(input) : "-1");
    put("element", std::to_string(step.until ? step.until->element.value_or(0) : 0));
    put("relation", std::to_string(step.until ? static_cast<int>(step.until->comparison) : 0));
    put("otherwise", otherwise);
    put("confirm", truth_text(step.confirm));
    put("reentry", truth_text(step.reentry));
    return node;
  }

  const DraftSequence& sequence_;
  Report& report_;
};

/// Reads the keys beside `steps`.
void read_frame(const Node& node, DraftSequence& sequence, DraftTask& task, Report& report) {
  refuse_unknown_keys(node, kSequenceKeys, "'sequence'", report);
  const auto said = [](std::string_view key) { return "'" + std::string(key) + "' in 'sequence'"; };
  if (const Node* rate = node.find("rate")) task.rate = read_rate(*rate, said("rate"), report);
  if (const Node* rtpu = node.find("rtpu")) task.rtpu = read_name(*rtpu, said("rtpu"), report);
  if (const Node* budget = node.find("budget")) task.budget = read_duration(*budget, said("budget"), report);
  if (const Node* repeat = node.find("repeat"))
    if (const auto truth = read_choice(*repeat, kTruthWords, said("repeat"), report))
      sequence.repeat = truth->value == 1;
}

void read_steps(const Node& node, DraftSequence& sequence, Report& report) {
  if (!expect(node, Node::Kind::kList, "the steps of 'sequence'", report)) return;
  const std::size_t n = node.items.size();
  if (n == 0 || n > kMaxSteps)
    report.add({.rule = "count-limit", .at = node.at,
                .message = "'sequence' has " + std::to_string(n) + " steps; expected 1 to " + std::to_string(kMaxSteps),
                .found = std::to_string(n), .expected = "1 to " + std::to_string(kMaxSteps),
                .remedy = n == 0 ? kExample : "take steps out, or combine configurations"});
  for (std::size_t i = 0; i < n && i < kMaxSteps; ++i)
    sequence.steps.push_back(StepReader(node.items[i], i + 1, report).read(i + 1 == n, sequence.repeat));
}

void join(Draft& draft, DraftTask task) {
  const Word member{kSequenceTask, task.name.at};
  const auto names = [](const Word& word) { return word.text == kSequenceTask; };
  for (DraftSet& set : draft.configurations)
    if (std::ranges::none_of(set.tasks, names) && !set.tasks.empty()) set.tasks.push_back(member);
  const auto is_go = [](const NamedNode& node) { return node.name.text == "sequence_go"; };
  if (std::ranges::none_of(draft.operators, is_go))
    draft.operators.push_back({{"sequence_go", task.name.at}, scalar_at("1", task.name.at)});
  draft.tasks.push_back(std::move(task));
}

}  // namespace

const DraftStep& DraftSequence::step_of_input(std::size_t input) const noexcept {
  const DraftStep* found = &steps.front();
  for (const DraftStep& step : steps)
    if (step.until && input-- == 0) found = &step;
  return *found;
}

std::string DraftSequence::say(const DraftStep& step) const {
  const std::string name = step.name.empty() ? "" : " '" + step.name.text + "'";
  return "step " + std::to_string(&step - steps.data() + 1) + name;
}

void read_sequence(const Word& key, const Node& node, Draft& draft, Report& report) {
  const std::size_t before = report.errors();
  DraftTask task;
  task.name = task.component = {kSequenceTask, key.at};
  task.budget = Located<Nanoseconds>{kBudget, key.at};
  DraftSequence sequence;
  sequence.at = key.at;
  sequence.has_keys = node.is_map();
  const Node* steps = node.is_map() ? node.find("steps") : &node;
  if (steps != nullptr && steps->is_list()) sequence.written = *steps;
  if (node.is_map()) read_frame(node, sequence, task, report);
  if (steps != nullptr) read_steps(*steps, sequence, report);
  else
    report.add({.rule = "key-missing", .at = node.at, .message = "'steps' in 'sequence' is missing",
                .expected = "steps", .remedy = "write sequence: {repeat: true, steps: [...]}, or the list alone"});
  for (const DraftTask& each : draft.tasks)
    if (each.name.text == kSequenceTask)
      report.add({.rule = "name-illegal", .at = each.name.at,
                  .message = "task 'sequence' has the name of the task that runs the key 'sequence'",
                  .found = kSequenceTask, .expected = "another name", .remedy = "rename the task"});
  if (draft.tasks.size() == kMaxTasks)
    report.add({.rule = "count-limit", .at = key.at,
                .message = "'sequence' is one task more than the " + std::to_string(kMaxTasks) + " of one file",
                .expected = "fewer tasks", .remedy = "split the application into subsystems"});
  if (report.errors() == before) TaskWriter(sequence, report).write(task);
  else draft.is_partial = true;
  if (report.errors() == before) join(draft, std::move(task));
  else draft.is_partial = true;
  draft.sequence = std::move(sequence);
}

Json sequence_json(const std::optional<DraftSequence>& sequence) {
  if (!sequence) return {};
  Json steps = Json::array();
  for (const Node& step : sequence->written.items) {
    const auto words = [&step](std::string_view key) {
      const Node* value = step.find(key);
      if (value == nullptr || value->is_none()) return Json();
      return Json(value->is_scalar() ? value->text : written_text(*value));
    };
    Json made = {{"number", steps.size() + 1}};
    for (const char* key : {"name", "switch", "until", "for", "within", "else"}) made[key] = words(key);
    for (const char* key : {"confirm", "reentry"}) made[key] = words(key) == Json(kTruthWords[1]);
    steps.push_back(std::move(made));
  }
  return {{"line", sequence->at.line},
          {"path", sequence->has_keys ? "sequence/steps" : "sequence"},
          {"repeat", sequence->repeat},
          {"steps", std::move(steps)}};
}

}  // namespace chimera
