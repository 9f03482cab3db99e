// SPDX-License-Identifier: Apache-2.0
// Reads the top level of a description into a draft.
#include "chimera/description/draft.h"

#include <array>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/description/draft_task.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/keys.h"
#include "chimera/description/yaml_reader.h"

namespace chimera {
namespace {

constexpr std::array<std::string_view, 2> kExecutors = {"executive", "preemptive"};
constexpr std::array<std::string_view, 5> kPolicies = {"rm", "edf", "llf", "muf", "muf-laxity"};  // as Policy
constexpr std::size_t kMaxRtpus = 16;

void check_count(std::size_t found, std::size_t most, const char* what, Place at, Report& report) {
  if (found <= most) return;
  report.add({.rule = "count-limit",
              .at = at,
              .message = std::to_string(found) + ' ' + what + "; at most " + std::to_string(most) + " in one file",
              .found = std::to_string(found),
              .expected = "at most " + std::to_string(most),
              .nearest = {},
              .remedy = "split the application into subsystems"});
}

void read_version(const Node& node, Report& report) {
  if (node.is_scalar() && !node.quoted && node.text == "1") return;
  report.add({.rule = "version-unknown",
              .at = node.at,
              .message = "the version of the format is " + written(node) + "; this program reads version 1",
              .found = node.text,
              .expected = "1",
              .nearest = {},
              .remedy = {}});
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
        rtpu.cpu = read_whole(*cpu, 0, 1023, "'cpu' of " + what, report).value_or(rtpu.cpu);
      if (const Node* policy = item.find("policy"))
        if (const auto index = read_choice(*policy, kPolicies, "'policy' of " + what, report))
          rtpu.policy = {static_cast<Policy>(index->value), index->at};
      if (const Node* executor = item.find("executor"))
        if (const auto index = read_choice(*executor, kExecutors, "'executor' of " + what, report))
          rtpu.preemptive = {index->value == 1, index->at};
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

void read_configurations(const Node& node, Draft& draft, Report& report) {
  if (!expect(node, Node::Kind::kMap, "'configurations'", report, true)) return;
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    if (!check_name(node.keys[i], "the name of a configuration", report)) continue;
    const std::string what = "configuration '" + node.keys[i].text + "'";
    DraftSet set{.name = node.keys[i], .tasks = {}};
    if (expect(node.items[i], Node::Kind::kList, what, report, true))
      for (const Node& item : node.items[i].items)
        if (auto task = read_name(item, "a task of " + what, report)) set.tasks.push_back(std::move(*task));
    draft.configurations.push_back(std::move(set));
  }
}

void require(const Node& root, std::string_view key, const char* remedy, Report& report) {
  if (root.find(key) != nullptr) return;
  report.add({.rule = "key-missing",
              .at = root.at,
              .message = "the key '" + std::string(key) + "' is missing",
              .found = {},
              .expected = std::string(key),
              .nearest = {},
              .remedy = remedy});
}

Draft read_root(const Node& root, std::string_view file, Report& report) {
  Draft draft;
  draft.file = file;
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
  return draft;
}

ReadDescription unreadable(const std::string& path, std::string_view rule, std::string message, std::string remedy) {
  ReadDescription reading{std::nullopt, Report(path), {}};
  reading.report.add({.rule = rule,
                      .at = {},
                      .message = std::move(message),
                      .found = {},
                      .expected = {},
                      .nearest = {},
                      .remedy = std::move(remedy)});
  return reading;
}

}  // namespace

ReadDescription read_description(std::string_view text, std::string_view file) {
  ReadDescription reading{std::nullopt, Report(std::string(file)), std::string(text)};
  const std::optional<Node> root = read_yaml(text, reading.report);
  if (root && root->is_none())
    reading.report.add({.rule = "value-kind",
                        .at = {},
                        .message = "the file is empty; a description starts with 'subsystem: NAME'",
                        .found = {},
                        .expected = "a map",
                        .nearest = {},
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
