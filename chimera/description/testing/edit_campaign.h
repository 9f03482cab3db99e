// SPDX-License-Identifier: Apache-2.0
// Edits of descriptions by seed. Trees and lines before and after judge each, without the code under test.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "chimera/base/testing/tree_path.h"
#include "chimera/description/testing/styled_text.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/yaml_reader.h"

namespace chimera {

/// All values of a tree by their path. A map is "{}", a list "[]", nothing "-"; a text in quotes begins with ".
using FlatTree = std::map<std::string, std::string>;

inline void flatten(const Node& node, const std::string& path, FlatTree& flat) {
  flat[path] = node.is_map()    ? "{}"
               : node.is_list() ? "[]"
               : node.is_none() ? "-"
                                : (node.quoted ? "\"" : "") + node.text;
  for (std::size_t i = 0; i < node.items.size(); ++i)
    flatten(node.items[i], path + "/" + (node.is_map() ? node.keys[i].text : std::to_string(i)), flat);
}

/// A text, its tree and its lines.
struct ReadText {
  std::string text;
  Node root;
  FlatTree flat;
  std::vector<std::string> lines;

  static std::optional<ReadText> of(const std::string& text) {
    Report report;
    auto tree = read_yaml(text, report);
    if (!tree || !report.is_legal()) return std::nullopt;
    ReadText read{text, *std::move(tree), {}, {}};
    flatten(read.root, "", read.flat);
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) read.lines.push_back(line);
    return read;
  }
};

/// The lines of `old` that are not in `now`: between the common beginning and the common end. Counted from 1.
struct ChangedLines {
  std::size_t first = 1, last = 0;

  ChangedLines(const ReadText& old, const ReadText& now) {
    const std::size_t most = std::min(old.lines.size(), now.lines.size());
    std::size_t front = 0, back = 0;
    while (front < most && old.lines[front] == now.lines[front]) ++front;
    while (back < most - front && old.lines[old.lines.size() - 1 - back] == now.lines[now.lines.size() - 1 - back])
      ++back;
    first = front + 1;
    last = old.lines.size() - back;
  }
  std::size_t count() const { return last + 1 - first; }
  bool are_within(std::size_t from, std::size_t to) const { return count() == 0 || (first >= from && last <= to); }
};

/// Edits one text again and again; each edit follows the one before.
class EditCampaign {
 public:
  EditCampaign(std::string text, unsigned seed) : original_(std::move(text)), random_(seed) {}

  /// Returns what is wrong with the first bad edit of `count`; empty if there is none.
  std::string run(std::size_t count) {
    for (std::size_t i = 0; i < count && wrong_.empty(); ++i) {
      if (i % 12 == 0) begin(i / 12);
      if (wrong_.empty()) one_edit();
    }
    return wrong_;
  }

 private:
  // As it is, with other line ends, without the last line end, in other styles.
  void begin(std::size_t round) {
    std::string text = original_;
    if (const auto read = ReadText::of(text); read && round % 2 == 1) text = StyledText(random_).of(read->root);
    if (round % 3 == 1) {
      std::string lines;
      for (const char c : text) lines += c == '\n' ? "\r\n" : std::string(1, c);
      text = lines;
    }
    if (round % 3 == 2 && text.ends_with('\n')) text.pop_back();
    said_ = "begin";
    old_.text = text;
    auto read = ReadText::of(text);
    if (!read) return complain("the text is not legal");
    old_ = *std::move(read);
  }

  std::size_t pick(std::size_t most) { return most == 0 ? 0 : random_() % most; }

  void complain(const std::string& what) {
    if (wrong_.empty()) wrong_ = what + "\n--- " + said_ + "\n--- before\n" + old_.text + "\n--- after\n" + now_.text;
  }

  /// Does the acts to the text. Complains if they are refused.
  bool edit(const std::vector<EditAct>& acts, const std::string& said) {
    said_ = said;
    now_ = {};
    const auto made = edit_text(old_.text, acts);
    if (!made) complain(std::string("refused: ") + made.error().where.c_str() + ": " + made.error().message.c_str());
    if (!made) return false;
    now_.text = *made;
    auto read = ReadText::of(*made);
    if (!read) complain("the result is not legal");
    if (!read) return false;
    now_ = *std::move(read);
    return true;
  }
  /// True if these acts lead from the new text to the old one, byte by byte.
  void expect_back(const std::vector<EditAct>& acts) {
    const auto back = edit_text(now_.text, acts);
    if (!back || *back != old_.text) complain("the inverse gives another text:\n" + (back ? *back : "refused"));
  }
  void expect_tree(const FlatTree& wanted) {
    for (const auto& [path, value] : wanted) {
      const auto got = now_.flat.find(path);
      if (got == now_.flat.end() || got->second != value) return complain("'" + path + "' is not " + value);
    }
    for (const auto& [path, value] : now_.flat)
      if (!wanted.contains(path)) return complain("'" + path + "' is new: " + value);
  }
  /// All comments stay but those of these lines.
  void expect_comments(std::size_t from, std::size_t to) {
    for (std::size_t i = 0; i < old_.lines.size(); ++i) {
      const std::size_t at = old_.lines[i].find("# c");
      const std::size_t end = at == std::string::npos ? at : old_.lines[i].find('.', at);
      if ((i + 1 >= from && i + 1 <= to) || end == std::string::npos) continue;
      const std::string comment = old_.lines[i].substr(at, end + 1 - at);
      if (now_.text.find(comment) == std::string::npos) complain("lost: " + comment);
    }
  }
  void expect_lines(std::size_t from, std::size_t to) {
    const ChangedLines changed(old_, now_);
    if (!changed.are_within(from, to))
      complain("lines " + std::to_string(changed.first) + " to " + std::to_string(changed.last) + " changed");
    expect_comments(from, to);
  }
  /// At most one line changed; all comments stay.
  void expect_one_line() {
    if (ChangedLines(old_, now_).count() > 1) complain("more than one line changed");
    expect_comments(1, 0);
  }

  void one_edit() {
    switch (pick(7)) {
      case 0:
        set_value();
        break;
      case 1:
        set_new_key();
        break;
      case 2:
        remove_part();
        break;
      case 3:
        rename_part();
        break;
      case 4:
        add_task();
        break;
      case 5:
        link_port();
        break;
      default:
        join_two();
        break;
    }
    if (wrong_.empty()) old_ = std::move(now_);
  }

  // ---- where ----

  struct Spot {
    EditPath path;
    const Node* parent = nullptr;
    std::size_t index = 0;
    std::size_t parent_line = 0;
    const Node& value() const { return parent->items[index]; }
    std::size_t line() const {
      return parent->is_map() ? parent->keys[index].at.line : value().is_none() ? parent->at.line : value().at.line;
    }
  };
  static void collect(const Node& node, const EditPath& path, std::size_t line, std::vector<Spot>& all) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      EditPath inner = path;
      inner.push_back(node.is_map() ? node.keys[i].text : std::to_string(i));
      all.push_back({inner, &node, i, line});
      collect(node.items[i], inner, all.back().line(), all);
    }
  }
  std::vector<Spot> spots() const {
    std::vector<Spot> all;
    collect(old_.root, {}, 1, all);
    return all;
  }
  static std::size_t last_line(const Node& node, std::size_t line) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      if (node.is_map()) line = std::max<std::size_t>(line, node.keys[i].at.line);
      line = last_line(node.items[i], line);
    }
    return node.is_none() ? line : std::max<std::size_t>(line, node.at.line);
  }
  /// The line of the bracket that closes a value over several lines, else `last`.
  std::size_t closing_line(const Node& value, std::size_t last) const {
    if (value.items.empty() || value.at.line == last) return last;
    for (std::size_t line = last + 1; line <= old_.lines.size(); ++line) {
      const std::size_t at = old_.lines[line - 1].find_first_not_of(" \t\r");
      if (at == std::string::npos || old_.lines[line - 1][at] == '#') continue;
      return old_.lines[line - 1][at] == ']' || old_.lines[line - 1][at] == '}' ? line : last;
    }
    return last;
  }
  std::vector<std::string> names(const char* section) const {
    std::vector<std::string> all;
    if (const Node* map = old_.root.find(section))
      for (const Word& key : map->keys) all.push_back(key.text);
    return all;
  }
  static std::string flat_path(const EditPath& path) { return "/" + text_of(path); }
  static bool is_within(const std::string& path, const std::string& top) {
    return path == top || path.starts_with(top + "/");
  }

  // ---- acts ----

  void set_value() {
    static const std::vector<std::string> kValues = {
        "7",       "1 kHz",       "a b",  "\"q: # 'x'\"", "[1, {x: 2}]", "{a: 1, b: [2, 3]}", "-0.5 rad", "on",
        "'it''s'", "gr\xC3\xBCn", "\"\"", "[]",           "{}",          "[[1, 2], [3, 4]]"};
    std::vector<Spot> all = spots();
    std::erase_if(all, [](const Spot& spot) { return !spot.value().is_scalar(); });
    const Spot& spot = all[pick(all.size())];
    const std::string& value = kValues[pick(kValues.size())];
    if (!edit({SetValue{spot.path, value}}, "set " + text_of(spot.path) + " " + value)) return;
    Report report;
    FlatTree wanted = old_.flat;
    flatten(*read_yaml("v: " + value, report)->find("v"), flat_path(spot.path), wanted);
    expect_tree(wanted);
    expect_lines(spot.line(), spot.value().at.line);
  }

  void set_new_key() {
    const std::vector<std::string> tasks = names("tasks");
    EditPath path = {pick(2) == 0 ? "operator" : "constants", "zz" + std::to_string(pick(1000))};
    if (!tasks.empty() && pick(3) > 0)
      path = {"tasks", tasks[pick(tasks.size())], pick(2) == 0 ? "initial" : "max_step",
              "zz" + std::to_string(pick(1000))};
    const std::string flat = flat_path(path);
    for (const auto& [known, value] : old_.flat)
      if (flat.starts_with(known + "/") && value != "{}" && value != "-") return stay();
    if (old_.flat.contains(flat)) return stay();
    if (!edit({SetValue{path, "5 m"}}, "set " + text_of(path))) return;
    FlatTree wanted = old_.flat;
    for (EditPath part = path; !part.empty(); part.pop_back()) wanted[flat_path(part)] = part == path ? "5 m" : "{}";
    expect_tree(wanted);
    expect_one_line();
  }

  void remove_part() {
    const std::vector<Spot> all = spots();
    const Spot& spot = all[pick(all.size())];
    if (spot.path.size() == 1 || spot.path.size() < 3 || !spot.parent->is_map()) return stay();
    if (!edit({RemoveValue{spot.path}}, "remove " + text_of(spot.path))) return;
    FlatTree wanted = old_.flat;
    std::erase_if(wanted, [&](const auto& one) { return is_within(one.first, flat_path(spot.path)); });
    expect_tree(wanted);
    const bool is_last = spot.index + 1 == spot.parent->items.size();
    const std::size_t before = spot.parent->items.size() == 1 ? spot.parent_line
                               : is_last                      ? last_line(spot.parent->items[spot.index - 1], 1)
                                                              : spot.line();
    expect_lines(std::min(before, spot.line()), closing_line(spot.value(), last_line(spot.value(), spot.line())));
  }

  /// True if `path` is a place where names of that section stand.
  static bool may_name(const std::string& section, const EditPath& path) {
    const auto at = [&](std::size_t i) { return i < path.size() ? path[i] : std::string(); };
    const bool in_task = at(0) == "tasks" && path.size() > 2;
    const bool is_constant = at(0) == "constants" || (in_task && at(2) == "constants");
    if (section == "rtpus") return in_task && at(2) == "rtpu";
    if (section == "tasks")
      return (at(0) == "configurations" && at(2) != "safe_when") || (in_task && at(2) == "standby_for") || is_constant;
    const bool is_else = at(0) == "sequence" && path.back() == "else";
    if (section == "configurations") return at(0) == "start" || path.back() == "switch" || is_else || is_constant;
    return in_task && at(2) == "alias";
  }

  void rename_part() {
    static const std::vector<const char*> kSections = {"tasks", "configurations", "rtpus", "operator", "constants"};
    const std::string section = kSections[pick(kSections.size())];
    const std::vector<std::string> all = names(section.c_str());
    if (all.empty()) return stay();
    const std::string from = all[pick(all.size())], to = "zz_" + std::to_string(pick(100000));
    if (!edit({RenameKey{{section, from}, to, {}}}, "rename " + section + "/" + from + " " + to)) return;
    FlatTree wanted;
    const std::string top = "/" + section + "/" + from;
    const bool is_step = std::ranges::any_of(old_.flat, [&](const auto& one) {
      return one.first.starts_with("/sequence/") && one.first.ends_with("/name") && one.second == from;
    });
    for (const auto& [path, value] : old_.flat) {
      const std::string quote = value.starts_with('"') ? "\"" : "";
      const bool is_of_step = is_step && path.ends_with("/else");
      const bool is_named = value == quote + from && path.size() > 1 && !is_of_step &&
                            may_name(section, edit_path(path.substr(1)));
      const std::string moved = is_within(path, top) ? "/" + section + "/" + to + path.substr(top.size()) : path;
      const bool is_condition = (path.ends_with("/safe_when") || path.ends_with("/until")) &&
                                (section == "operator" || section == "constants");
      wanted[moved] = is_named ? quote + to : is_condition ? now_.flat[moved] : value;
    }
    const std::string task = "/tasks/" + to;
    const bool had_component = section != "tasks" || old_.flat.contains(top + "/component");
    if (!had_component) wanted[task + "/component"] = from;
    if (!had_component) wanted[task] = "{}";
    expect_tree(wanted);
    if (!had_component) return;
    expect_back({RenameKey{{section, to}, from, {}}});
    if (old_.lines.size() != now_.lines.size()) return complain("another number of lines");
    for (std::size_t i = 0; i < old_.lines.size(); ++i)
      if (old_.lines[i] != now_.lines[i] && old_.lines[i].find(from) == std::string::npos)
        complain("line " + std::to_string(i + 1) + " changed");
  }

  void add_task() {
    const std::string name = "zz_" + std::to_string(pick(100000));
    if (old_.flat.contains("/tasks/" + name)) return stay();
    if (!edit({AddTask{name, "part"}}, "add_task " + name)) return;
    FlatTree wanted = old_.flat;
    wanted["/tasks/" + name] = "{}";
    wanted["/tasks/" + name + "/component"] = "part";
    expect_tree(wanted);
    expect_one_line();
    expect_back({RemoveValue{{"tasks", name}}});
  }

  void link_port() {
    const std::vector<std::string> tasks = names("tasks");
    const std::string task = tasks[pick(tasks.size())], top = "/tasks/" + task;
    if (old_.flat[top] != "{}" && old_.flat[top] != "-") return stay();
    const bool had_alias = old_.flat.contains(top + "/alias");
    if (had_alias && old_.flat[top + "/alias"] != "{}") return stay();
    if (!edit({LinkPort{task, "zz_port", "zz_variable", {}}}, "link " + task)) return;
    FlatTree wanted = old_.flat;
    std::erase_if(wanted, [&](const auto& one) { return is_within(one.first, top + "/alias/zz_port"); });
    wanted[top] = wanted[top + "/alias"] = "{}";
    wanted[top + "/alias/zz_port"] = "zz_variable";
    expect_tree(wanted);
    expect_one_line();
    // Brackets that the inverse leaves empty are written anew.
    const Node* old_task = old_.root.find("tasks")->find(task);
    const Node* alias = old_task->find("alias");
    const bool leaves_parts = !old_task->items.empty() && (alias == nullptr || !alias->items.empty());
    const bool is_new = !old_.flat.contains(top + "/alias/zz_port");
    if (is_new && leaves_parts) expect_back({LinkPort{task, "zz_port", "zz_port", {}}});
  }

  void join_two() {
    const std::vector<std::string> tasks = names("tasks");
    const std::string a = tasks[pick(tasks.size())], b = tasks[pick(tasks.size())];
    for (const std::string& task : {a, b})
      for (const char* key : {"", "/alias", "/standby_for"}) {
        const auto value = old_.flat.find("/tasks/" + task + key);
        if (a == b || (value != old_.flat.end() && value->second != "{}" && value->second != "-")) return stay();
        if (value != old_.flat.end() && *key == '/' && key[1] == 's') return stay();
      }
    const std::string variable = "zz" + std::to_string(pick(100000)), made = "/tasks/join_" + variable;
    if (!edit({JoinProducers{variable, static_cast<JoinBy>(pick(3)), {{a, "zz_out"}, {b, "zz_out"}}}},
              "join " + a + " " + b))
      return;
    if (now_.flat[made] != "{}" || now_.flat[made + "/alias/out"] != variable) complain("there is no join");
    if (now_.flat["/tasks/" + a + "/alias/zz_out"] != variable + "_1")
      complain("the first producer has no new variable");
    if (now_.flat["/tasks/" + b + "/alias/zz_out"] != variable + "_2")
      complain("the second producer has no new variable");
    for (const auto& [path, value] : old_.flat) {
      const bool may_change =
          path.starts_with("/configurations/") || path.find("/alias/zz_out") != std::string::npos || value == "-";
      const auto got = now_.flat.find(path);
      if (!may_change && (got == now_.flat.end() || got->second != value)) complain("'" + path + "' changed");
    }
  }

  void stay() { now_ = old_; }

  std::string original_;
  std::mt19937 random_;
  ReadText old_, now_;
  std::string said_, wrong_;
};

/// The texts of all descriptions of the lessons, and of the legal ones of tests/verify, by path.
inline std::map<std::string, std::string> texts_to_edit() {
  std::map<std::string, std::string> all;
  for (const char* folder : {"examples", "tests/verify/good"})
    for (const auto& file : std::filesystem::recursive_directory_iterator(source_path(folder))) {
      const std::string path = file.path().string();
      if (!path.ends_with(".yaml") || path.ends_with(".cases.yaml")) continue;
      std::ifstream stream(path, std::ios::binary);
      std::ostringstream text;
      text << stream.rdbuf();
      all[path] = text.str();
    }
  return all;
}

}  // namespace chimera
