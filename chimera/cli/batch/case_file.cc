// SPDX-License-Identifier: Apache-2.0
// Reads a file of cases.
#include "chimera/cli/batch/case_file.h"

#include <filesystem>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/yaml_reader.h"

namespace chimera::cli {
namespace {

constexpr std::array<std::string_view, 2> kTruth = {"true", "false"};

/// A value of `set` in the words of a command line.
std::string flow_text(const Node& node) {
  if (node.is_scalar()) return node.text;
  const std::string text = join_n(node.items.size(), ", ", [&node](std::size_t i) {
    return (node.is_map() ? node.keys[i].text + ": " : "") + flow_text(node.items[i]);
  });
  return node.is_map() ? "{" + text + "}" : "[" + text + "]";
}

std::string place_text(const std::string& file, Place at) {
  return file + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
}

/// Reads the keys of one case.
class CaseReader {
 public:
  CaseReader(const std::string& file, const Word& name, Report& report)
      : file_(file), what_("case '" + name.text + "'"), at_(name.at), report_(report) {
    made_.name = name.text;
    made_.request.run.virtual_time = true;
  }

  Case read(const Node& node) {
    if (!expect(node, Node::Kind::kMap, what_, report_)) return made_;
    refuse_unknown_keys(node, kCaseKeys, what_, report_);
    RunRequest& run = made_.request.run;
    if (node.find("for") == nullptr) missing("for", "write 'for: 5 s', the virtual time that it lasts");
    duration(node, "for", run.duration);
    duration(node, "quantum", run.quantum);
    duration(node, "every", made_.request.every);
    truth(node, "strict", made_.strict);
    truth(node, "preemptive", run.preemptive);
    texts(node, "at", run.at);
    texts(node, "expect", made_.request.expect);
    if (const Node* seed = node.find("seed"))
      if (const auto value = read_whole(*seed, 0, UINT32_MAX, "'seed' of " + what_, report_)) run.seed = value->value;
    settings(node, run.settings);
    if (node.find("expect") == nullptr && !made_.strict)
      missing("expect", "write 'expect: [error <= 2 mrad]', or 'strict: true': else nothing is judged");
    return made_;
  }

 private:
  void missing(const char* key, const char* remedy) {
    report_.add({.rule = "key-missing",
                 .at = at_,
                 .message = what_ + ": the key '" + key + "' is missing",
                 .expected = key,
                 .remedy = remedy});
  }
  void duration(const Node& node, const char* key, Nanoseconds& to) {
    const Node* value = node.find(key);
    if (value == nullptr) return;
    const auto read = read_duration(*value, std::string("'") + key + "' of " + what_, report_);
    if (!read) return;
    to = read->value;
    if (to > Nanoseconds{}) return;
    report_.add({.rule = "quantity-bad",
                 .at = value->at,
                 .message = std::string("'") + key + "' of " + what_ + " must be longer than 0",
                 .found = value->text});
  }
  void truth(const Node& node, const char* key, bool& to) {
    if (const Node* value = node.find(key))
      if (const auto read = read_choice(*value, kTruth, std::string("'") + key + "' of " + what_, report_))
        to = read->value == 0;
  }
  void texts(const Node& node, const char* key, std::vector<std::string>& to) {
    const Node* list = node.find(key);
    const std::string what = std::string("'") + key + "' of " + what_;
    if (list == nullptr || !expect(*list, Node::Kind::kList, what, report_)) return;
    for (const Node& item : list->items)
      if (const auto text = read_text(item, what, report_)) to.push_back(text->text);
  }
  void settings(const Node& node, std::vector<Setting>& to) {
    const Node* map = node.find("set");
    if (map == nullptr || !expect(*map, Node::Kind::kMap, "'set' of " + what_, report_)) return;
    for (std::size_t i = 0; i < map->keys.size(); ++i) {
      const std::string value = flow_text(map->items[i]);
      to.push_back({map->keys[i].text, value,
                    place_text(file_, map->keys[i].at) + ": set " + map->keys[i].text + " '" + value + "'"});
    }
  }

  const std::string& file_;
  std::string what_;
  Place at_;
  Report& report_;
  Case made_;
};

std::string described_by(const std::string& file) {
  return file.substr(0, file.size() - kCaseFileEnding.size()) + ".yaml";
}

}  // namespace

CaseFile read_case_text(std::string_view text, const std::string& file, Report& report) {
  CaseFile made{file, described_by(file), {}};
  const std::optional<Node> root = read_yaml(text, report);
  if (!root || !expect(*root, Node::Kind::kMap, "the file", report)) return made;
  refuse_unknown_keys(*root, kCaseFileKeys, "the file", report);
  if (const Node* node = root->find("description"))
    if (const auto name = read_text(*node, "'description'", report))
      made.description = (std::filesystem::path(file).parent_path() / name->text).string();
  const Node* cases = root->find("cases");
  const bool has_cases = cases != nullptr && expect(*cases, Node::Kind::kMap, "'cases'", report);
  if (cases == nullptr || (has_cases && cases->keys.empty()))
    report.add({.rule = "key-missing",
                .at = root->at,
                .message = "there is no case",
                .expected = "cases",
                .remedy = "write 'cases:' and a line 'NAME: {for: 5 s, expect: [error <= 2 mrad]}' for "
                          "each"});
  for (std::size_t i = 0; has_cases && i < cases->keys.size(); ++i)
    if (check_name(cases->keys[i], "the name of a case", report))
      made.cases.push_back(CaseReader(file, cases->keys[i], report).read(cases->items[i]));
  for (Case& one : made.cases) one.request.run.file = made.description;
  report.sort();
  return made;
}

CaseFile read_case_file(const std::string& path, Report& report) {
  const auto text = read_ordinary(path, kMaxTextBytes + 1);
  if (text && text->size() <= kMaxTextBytes) return read_case_text(*text, path, report);
  report.add({.rule = text ? "text-size" : "file-unreadable",
              .message = "the file " + (text ? "has more than " + std::to_string(kMaxTextBytes) + " bytes"
                                             : std::string(text.error().message.view())),
              .remedy = text ? "split it into several files" : "check the path and its rights"});
  return {path, described_by(path), {}};
}

}  // namespace chimera::cli
