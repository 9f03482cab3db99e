// SPDX-License-Identifier: Apache-2.0
// Reads a description into a draft: one function for each key of a task, and one for the top level.
#include "chimera/description/draft.h"

#include <array>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/description/criticality.h"
#include "chimera/description/draft_link.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/keys.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {
namespace {

// In the order of OnMiss. `switch` is written as a map.
constexpr std::array<std::string_view, 9> kReactions = {"continue", "hold",   "skip", "abort", "demote",
                                                        "error",    "switch", "flag", "stop"};
constexpr std::array<std::string_view, 4> kFaultReactions = {"error", "flag", "stop", "switch"};  // as OnFault
constexpr std::array<std::string_view, 3> kRestartKeys = {"restart", "within", "then"};
constexpr std::array<std::string_view, 2> kServerKinds = {"deferrable", "sporadic"};              // as ServerKind
constexpr std::array<std::string_view, 2> kIsolations = {"shared", "process"};
constexpr std::array<std::string_view, 1> kSwitchKeys = {"switch"};
constexpr std::array<std::string_view, 2> kTruths = {"false", "true"};

/// A map from names to any values, as pairs; keys must be names.
std::vector<NamedNode> read_named(const Node& node, const std::string& what, Report& report) {
  std::vector<NamedNode> out;
  if (!expect(node, Node::Kind::kMap, what, report, true)) return out;
  for (std::size_t i = 0; i < node.keys.size(); ++i)
    if (check_name(node.keys[i], "a key of " + what, report)) out.push_back({node.keys[i], node.items[i]});
  return out;
}

using Read = void (*)(const Node&, const std::string& what, DraftTask&, Report&);

/// `{switch: CONFIGURATION}`; nullopt if the node has another form.
std::optional<Word> read_switch(const Node& node, const std::string& what, Report& report) {
  refuse_unknown_keys(node, kSwitchKeys, what, report);
  const Node* to = node.find("switch");
  return to != nullptr ? read_name(*to, "'switch' in " + what, report) : std::nullopt;
}

/// A word of `words`, or {switch: NAME}; the index and the name.
template <std::size_t N>
std::optional<std::size_t> read_reaction(const Node& node, const std::array<std::string_view, N>& words,
                                         const std::string& what, Word& configuration, Report& report) {
  constexpr auto is_switch = [](std::string_view word) { return word == "switch"; };
  if (node.is_map()) {
    const auto to = read_switch(node, what, report);
    if (!to) return std::nullopt;
    configuration = *to;
    for (std::size_t i = 0; i < N; ++i)
      if (is_switch(words[i])) return i;
  }
  if (node.is_scalar() && is_switch(node.text)) {
    report.add({.rule = "value-kind",
                .at = node.at,
                .message = what + ": 'switch' needs a configuration",
                .found = "switch",
                .expected = "{switch: CONFIGURATION}",
                .remedy = "write {switch: NAME} with the name of a configuration"});
    return std::nullopt;
  }
  const auto index = read_choice(node, words, what, report);
  return index ? std::optional(index->value) : std::nullopt;
}

std::optional<DraftReaction> reaction(const Node& node, const std::string& what, Report& report) {
  DraftReaction out{.kind = OnMiss::kContinue, .configuration = {}, .at = node.at};
  const auto index = read_reaction(node, kReactions, what, out.configuration, report);
  if (!index) return std::nullopt;
  out.kind = static_cast<OnMiss>(*index);
  return out;
}

/// `{restart: N, within: T, then: REACTION}`; nullopt, with a fault, if it is wrong.
std::optional<DraftOnFault> read_restart(const Node& node, const std::string& what, Report& report) {
  DraftOnFault out{.kind = OnFault::kRestart, .configuration = {}, .at = node.at, .restart = {}};
  refuse_unknown_keys(node, kRestartKeys, what, report);
  const Node *restart = node.find("restart"), *within = node.find("within"), *then = node.find("then");
  const auto most = read_whole(*restart, 1, kMostRestarts, "'restart' in " + what, report);
  if (within == nullptr || then == nullptr)
    report.add({.rule = "key-missing",
                .at = node.at,
                .message = std::string(within == nullptr ? "'within'" : "'then'") + " in " + what + " is missing",
                .expected = within == nullptr ? "within" : "then",
                .remedy = "write {restart: 3, within: 10 s, then: flag}"});
  const auto window = within != nullptr ? read_duration(*within, "'within' in " + what, report) : std::nullopt;
  std::optional<std::size_t> reaction;
  if (then != nullptr)
    reaction = read_reaction(*then, kFaultReactions, "'then' in " + what, out.configuration, report);
  if (!most || !window || !reaction) return std::nullopt;
  if (window->value.count == 0) {
    report.add({.rule = "time-range",
                .at = window->at,
                .message = "'within' in " + what + " is 0 ns; expected more than 0",
                .found = "0 ns",
                .expected = "more than 0"});
    return std::nullopt;
  }
  out.restart = {most->value, window->value, static_cast<OnFault>(*reaction)};
  return out;
}

void read_on_fault(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  if (node.is_map() && node.find("restart") != nullptr) {
    task.on_fault = read_restart(node, what, report);
    return;
  }
  DraftOnFault out{.kind = OnFault::kError, .configuration = {}, .at = node.at, .restart = {}};
  const auto index = read_reaction(node, kFaultReactions, what, out.configuration, report);
  if (!index) return;
  out.kind = static_cast<OnFault>(*index);
  task.on_fault = out;
}

void read_standby(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  DraftStandby out;
  if (!node.is_map()) {
    if (auto name = read_name(node, what, report)) task.standby_for = DraftStandby{*std::move(name), {}, {}};
    return;
  }
  refuse_unknown_keys(node, kStandbyKeys, what, report);
  const Node *name = node.find("task"), *stale = node.find("stale_after"), *hot = node.find("hot");
  if (name == nullptr)
    report.add({.rule = "key-missing",
                .at = node.at,
                .message = "'task' in " + what + " is missing",
                .expected = "task",
                .remedy = "write {task: NAME, stale_after: 20 ms, hot: true}"});
  if (stale != nullptr) out.stale_after = read_duration(*stale, "'stale_after' in " + what, report);
  if (hot != nullptr)
    if (const auto truth = read_choice(*hot, kTruths, "'hot' in " + what, report))
      out.hot = Located<bool>{truth->value == 1, truth->at};
  auto word = name != nullptr ? read_name(*name, "'task' in " + what, report) : std::nullopt;
  if (!word) return;
  out.task = *std::move(word);
  task.standby_for = std::move(out);
}

void read_alias(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  if (!expect(node, Node::Kind::kMap, what, report, true)) return;
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const Node& item = node.items[i];
    DraftAlias alias{.port = node.keys[i], .variables = {}, .is_list = item.is_list()};
    const std::string inner = "'" + alias.port.text + "' in " + what;
    if (!item.is_list()) {
      if (auto variable = read_name(item, inner, report)) alias.variables.push_back(std::move(*variable));
    } else {
      for (const Node& one : item.items)
        if (auto variable = read_name(one, inner, report)) alias.variables.push_back(std::move(*variable));
    }
    const std::size_t wanted = item.is_list() ? item.items.size() : 1;
    if (alias.variables.size() == wanted) task.alias.push_back(std::move(alias));
  }
}

void read_tolerate(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  if (!expect(node, Node::Kind::kMap, what, report)) return;
  refuse_unknown_keys(node, kTolerateKeys, what, report);
  const auto part = [&](std::string_view key, std::uint32_t min) -> std::optional<Located<std::uint32_t>> {
    const std::string inner = "'" + std::string(key) + "' in " + what;
    const Node* value = node.find(key);
    if (value != nullptr) return read_whole(*value, min, 64, inner, report);
    report.add({.rule = "key-missing",
                .at = node.at,
                .message = inner + " is missing",
                .expected = std::string(key),
                .remedy = "write {misses: 1, of: 10}"});
    return std::nullopt;
  };
  const auto misses = part("misses", 1), of = part("of", 2);
  if (!misses || !of) return;
  if (misses->value >= of->value) {
    report.add({.rule = "number-bad",
                .at = misses->at,
                .message = what + ": " + std::to_string(misses->value) + " misses in " + std::to_string(of->value) +
                           " cycles; expected fewer misses than cycles",
                .found = std::to_string(misses->value),
                .expected = "below " + std::to_string(of->value)});
    return;
  }
  task.tolerate = DraftTolerate{node.at, misses->value, of->value};
}

void read_server(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  if (!expect(node, Node::Kind::kMap, what, report)) return;
  refuse_unknown_keys(node, kServerKeys, what, report);
  for (const std::string_view key : kServerKeys)
    if (node.find(key) == nullptr)
      report.add({.rule = "key-missing",
                  .at = node.at,
                  .message = "'" + std::string(key) + "' in " + what + " is missing",
                  .expected = std::string(key),
                  .remedy = "write {kind: deferrable, capacity: 1 ms, period: 10 ms}"});
  const Node *kind = node.find("kind"), *capacity = node.find("capacity"), *period = node.find("period");
  DraftServer server;
  server.at = node.at;
  bool fine = kind != nullptr && capacity != nullptr && period != nullptr;
  if (kind != nullptr) {
    const auto index = read_choice(*kind, kServerKinds, "'kind' in " + what, report);
    if (index) server.kind = static_cast<ServerKind>(index->value);
    fine = fine && index;
  }
  const auto take = [&](const Node* value, const char* key, Located<Nanoseconds>& to) {
    if (value == nullptr) return;
    const auto duration = read_duration(*value, "'" + std::string(key) + "' in " + what, report);
    if (duration) to = *duration;
    fine = fine && duration;
  };
  take(capacity, "capacity", server.capacity);
  take(period, "period", server.period);
  if (fine) task.server = server;
}

template <auto Member>
void read_time(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  task.*Member = read_duration(node, what, report);
}

template <auto Member>
void read_map(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  task.*Member = read_named(node, what, report);
}

template <auto Member, std::uint32_t kMax>
void read_number(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  task.*Member = read_whole(node, 0, kMax, what, report);
}

void read_criticality(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  if (const auto index = read_choice(node, kCriticalities, what, report))
    task.criticality = Located<std::uint32_t>{static_cast<std::uint32_t>(index->value), index->at};
}

void read_component(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  task.component = read_name(node, what, report).value_or(Word{});
}

void read_isolation(const Node& node, const std::string& what, DraftTask& task, Report& report) {
  if (const auto index = read_choice(node, kIsolations, what, report))
    task.own_process = Located<bool>{index->value == 1, index->at};
}

// One per key of kTaskKeys, in its order.
constexpr std::array<Read, kTaskKeys.size()> kReaders = {
    read_component,
    [](const Node& n, const std::string& w, DraftTask& t, Report& r) { t.rtpu = read_name(n, w, r); },
    [](const Node& n, const std::string& w, DraftTask& t, Report& r) { t.rate = read_rate(n, w, r); },
    read_time<&DraftTask::deadline>,
    read_time<&DraftTask::offset>,
    read_time<&DraftTask::budget>,
    read_time<&DraftTask::min_time>,
    read_criticality,
    read_number<&DraftTask::user_priority, 255>,
    read_alias,
    read_map<&DraftTask::constants>,
    read_map<&DraftTask::resources>,
    read_map<&DraftTask::initial>,
    [](const Node& n, const std::string& w, DraftTask& t, Report& r) { t.on_miss = reaction(n, w, r); },
    [](const Node& n, const std::string& w, DraftTask& t, Report& r) { t.on_overrun = reaction(n, w, r); },
    read_number<&DraftTask::max_consecutive, 1'000'000>,
    read_tolerate,
    read_server,
    read_time<&DraftTask::stale_after>,
    read_standby,
    read_on_fault,
    read_map<&DraftTask::max_step>,
    [](const Node& n, const std::string& w, DraftTask& t, Report& r) {
      t.stack_bytes = read_bytes(n, 16 << 10, 64 << 20, w, r);
    },
    read_isolation,
    read_number<&DraftTask::safe_after, 1'000'000>,
};

/// Reads `name: node` of `tasks`. Parts that cannot be read are omitted, with a fault in `report`.
DraftTask read_task(const Word& name, const Node& node, Report& report) {
  DraftTask task;
  task.name = task.component = name;
  const std::string what = "task '" + name.text + "'";
  const std::size_t before = report.errors();
  if (!expect(node, Node::Kind::kMap, what, report, true)) {
    task.is_partial = true;
    return task;
  }
  refuse_unknown_keys(node, kTaskKeys, what, report);
  for (std::size_t i = 0; i < kTaskKeys.size(); ++i)
    if (const Node* value = node.find(kTaskKeys[i]); value != nullptr)
      kReaders[i](*value, "'" + std::string(kTaskKeys[i]) + "' of " + what, task, report);
  task.is_partial = report.errors() != before;
  return task;
}

constexpr std::array<std::string_view, 2> kExecutors = {"executive", "preemptive"};
constexpr std::size_t kMaxRtpus = 16;

void check_count(std::size_t found, std::size_t most, const char* what, Place at, Report& report) {
  if (found <= most) return;
  report.add({.rule = "count-limit",
              .at = at,
              .message = std::to_string(found) + ' ' + what + "; at most " + std::to_string(most) + " in one file",
              .found = std::to_string(found),
              .expected = "at most " + std::to_string(most),
              .remedy = "split the application into subsystems"});
}

void read_version(const Node& node, Report& report) {
  if (node.is_scalar() && !node.quoted && node.text == "1") return;
  report.add({.rule = "version-unknown",
              .at = node.at,
              .message = "the version of the format is " + written(node) + "; this program reads version 1",
              .found = node.text,
              .expected = "1"});
}

void read_rtpus(const Node& node, Draft& draft, Report& report) {
  if (!expect(node, Node::Kind::kMap, "'rtpus'", report, true)) return;
  check_count(node.keys.size(), kMaxRtpus, "rtpus", node.at, report);
  for (std::size_t i = 0; i < node.keys.size() && i < kMaxRtpus; ++i) {
    const Node& item = node.items[i];
    if (!check_name(node.keys[i], "the name of an rtpu", report)) continue;
    DraftRtpu rtpu{.name = node.keys[i], .cpu = {0, node.keys[i].at}, .policy = {Policy::kEdf, node.keys[i].at}};
    const std::string what = "rtpu '" + rtpu.name.text + "'";
    if (expect(item, Node::Kind::kMap, what, report, true)) {
      refuse_unknown_keys(item, kRtpuKeys, what, report);
      if (const Node* cpu = item.find("cpu"))
        rtpu.cpu = read_whole(*cpu, 0, kLastCpu, "'cpu' of " + what, report).value_or(rtpu.cpu);
      if (const Node* policy = item.find("policy"))
        if (const auto index = read_choice(*policy, kPolicyNames, "'policy' of " + what, report))
          rtpu.policy = {static_cast<Policy>(index->value), index->at};
      if (const Node* executor = item.find("executor"))
        if (const auto index = read_choice(*executor, kExecutors, "'executor' of " + what, report))
          rtpu.preemptive = {index->value == 1, index->at};
      read_board(item, rtpu, report);
    }
    draft.rtpus.push_back(std::move(rtpu));
  }
}

void read_tasks(const Node& node, Draft& draft, Report& report) {
  if (!expect(node, Node::Kind::kMap, "'tasks'", report)) return;
  check_count(node.keys.size(), kMaxTasks, "tasks", node.at, report);
  for (std::size_t i = 0; i < node.keys.size() && i < kMaxTasks; ++i) {
    if (!check_name(node.keys[i], "the name of a task", report))
      draft.is_partial = true;
    else
      draft.tasks.push_back(read_task(node.keys[i], node.items[i], report));
  }
}

void read_members(const Node& node, const std::string& what, DraftSet& set, Report& report) {
  if (!expect(node, Node::Kind::kList, what, report, true)) return;
  for (const Node& item : node.items)
    if (auto task = read_name(item, "a task of " + what, report)) set.tasks.push_back(std::move(*task));
}

// {tasks: [...], safe_when: ...}
void read_guarded_set(const Node& node, const std::string& what, DraftSet& set, Report& report) {
  refuse_unknown_keys(node, kSetKeys, what, report);
  if (const Node* tasks = node.find("tasks")) read_members(*tasks, "'tasks' of " + what, set, report);
  if (const Node* condition = node.find("safe_when"))
    set.safe_when = read_condition(*condition, "'safe_when' of " + what, report);
}

void read_configurations(const Node& node, Draft& draft, Report& report) {
  if (!expect(node, Node::Kind::kMap, "'configurations'", report, true)) return;
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    if (!check_name(node.keys[i], "the name of a configuration", report)) continue;
    const std::string what = "configuration '" + node.keys[i].text + "'";
    DraftSet set{.name = node.keys[i], .tasks = {}, .safe_when = {}};
    const Node& item = node.items[i];
    if (item.is_map()) read_guarded_set(item, what, set, report);
    else read_members(item, what, set, report);
    draft.configurations.push_back(std::move(set));
  }
}

void require(const Node& root, std::string_view key, const char* remedy, Report& report) {
  if (root.find(key) != nullptr) return;
  report.add({.rule = "key-missing",
              .at = root.at,
              .message = "the key '" + std::string(key) + "' is missing",
              .expected = std::string(key),
              .remedy = remedy});
}

Draft read_root(const Node& root, std::string_view file, Report& report) {
  Draft draft;
  draft.file = file;
  draft.keys = report.keys();
  const std::size_t before = report.errors();
  refuse_unknown_keys(root, kFileKeys, "the file", report);
  require(root, "subsystem", "write 'subsystem: NAME' as the first line", report);
  require(root, "tasks", "write 'tasks:' and a line 'NAME: {component: COMPONENT, rate: 100 Hz}' for each", report);
  if (const Node* node = root.find("version")) read_version(*node, report);
  if (const Node* node = root.find("subsystem"))
    draft.subsystem = read_name(*node, "'subsystem'", report).value_or(Word{});
  if (const Node* node = root.find("constants")) draft.constants = read_named(*node, "'constants'", report);
  if (const Node* node = root.find("operator")) draft.operators = read_named(*node, "'operator'", report);
  if (const Node* node = root.find("rtpus")) read_rtpus(*node, draft, report);
  if (const Node* node = root.find("configurations")) read_configurations(*node, draft, report);
  if (const Node* node = root.find("start")) draft.start = read_name(*node, "'start'", report);
  draft.is_partial = report.errors() != before;
  if (const Node* node = root.find("tasks")) read_tasks(*node, draft, report);
  for (std::size_t i = 0; i < root.keys.size(); ++i)
    if (root.keys[i].text == "sequence") read_sequence(root.keys[i], root.items[i], draft, report);
  return draft;
}

ReadDescription unreadable(const std::string& path, std::string_view rule, std::string message, std::string remedy) {
  ReadDescription reading{std::nullopt, Report(path), {}};
  reading.report.add({.rule = rule, .message = std::move(message), .remedy = std::move(remedy)});
  return reading;
}

}  // namespace

ReadDescription read_description(std::string_view text, std::string_view file) {
  ReadDescription reading{std::nullopt, Report(std::string(file)), std::string(text)};
  const std::optional<Node> root = read_yaml(text, reading.report);
  if (root && root->is_none())
    reading.report.add({.rule = "value-kind",
                        .message = "the file is empty; a description starts with 'subsystem: NAME'",
                        .expected = "a map",
                        .remedy = "'chimera new app NAME' writes one"});
  else if (root && expect(*root, Node::Kind::kMap, "the file", reading.report))
    reading.draft = read_root(*root, file, reading.report);
  reading.report.sort();
  return reading;
}

ReadDescription read_description_file(const std::string& path) {
  const auto text = read_ordinary(path, kMaxTextBytes + 1);
  if (!text)
    return unreadable(path, "file-unreadable", "the file " + std::string(text.error().message.view()),
                      text.error().code == ErrorCode::kRefused ? "a description is an ordinary file"
                                                               : "check the path and its rights");
  if (text->size() > kMaxTextBytes && text->find('\0') == std::string::npos)
    return unreadable(path, "text-size", "the file has more than " + std::to_string(kMaxTextBytes) + " bytes",
                      "split the application into subsystems");
  return read_description(*text, path);
}

}  // namespace chimera
