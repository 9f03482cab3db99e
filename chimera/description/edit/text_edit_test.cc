// SPDX-License-Identifier: Apache-2.0
#include "chimera/description/edit/text_edit.h"

#include <gtest/gtest.h>

#include "chimera/units/testing/unit_samples.h"

namespace chimera::text_edit_test {
namespace {

std::string edited(const std::string& text, std::vector<EditAct> acts) {
  const auto result = edit_text(text, acts);
  if (result) return *result;
  return std::string(result.error().where.view()) + ": " + std::string(result.error().message.view());
}

SetValue set(const char* path, const char* value) { return {edit_path(path), value}; }
RemoveValue remove(const char* path) { return {edit_path(path)}; }
RenameKey rename(const char* path, const char* to, std::vector<TaskPort> ports = {}) {
  return {edit_path(path), to, std::move(ports)};
}
AddTask add(const char* name, const char* component) { return {name, component}; }
LinkPort link(const char* task, const char* port, const char* variable) { return {task, port, variable, {}}; }

std::string with_crlf(const std::string& text) {
  std::string all;
  for (const char c : text) all += c == '\n' ? "\r\n" : std::string(1, c);
  return all;
}

/// The edit gives `after`, also with other line ends and without the last one.
void expect_edit(const std::string& before, const std::vector<EditAct>& acts, const std::string& after) {
  EXPECT_EQ(edited(before, acts), after);
  EXPECT_EQ(edited(with_crlf(before), acts), with_crlf(after));
  if (!before.ends_with('\n')) return;
  EXPECT_EQ(edited(before.substr(0, before.size() - 1), acts), after.substr(0, after.size() - 1));
}

constexpr const char* kFlow =
    "# the arm\nversion: 1\nsubsystem: s\n\n"
    "rtpus:\n  servo: {cpu: 1}  # fast\n\n"
    "tasks:  # two\n"
    "  pid: {rate: 1 kHz, alias: {q: q_seen}}  # control\n"
    "  arm: {component: puma, rtpu: servo}\n\n"
    "operator: {kp: 2, ki: 3}\n";

constexpr const char* kBlock =
    "subsystem: s\n"
    "tasks:\n"
    "    pid:   # control\n"
    "        rate: 1 kHz    # fast\n"
    "        alias:\n"
    "            q: q_seen\n"
    "    arm:\n"
    "        component: puma\n"
    "configurations:\n"
    "    run:\n"
    "    - pid  # first\n"
    "    - arm\n"
    "operator:\n"
    "    kp: 2\t# gain\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(TextEdit, ReplacesAValueInEachStyle) {
  expect_edit(kFlow, {set("tasks/pid/rate", "500 Hz")}, replaced(kFlow, "1 kHz", "500 Hz"));
  expect_edit(kFlow, {set("operator/ki", "[1, 2]")}, replaced(kFlow, "ki: 3", "ki: [1, 2]"));
  expect_edit(kBlock, {set("tasks/pid/rate", "500 Hz")}, replaced(kBlock, "1 kHz", "500 Hz"));
  expect_edit(kBlock, {set("tasks/pid/alias/q", "r")}, replaced(kBlock, "q_seen", "r"));
  expect_edit(kBlock, {set("configurations/run/1", "other")}, replaced(kBlock, "- arm", "- other"));
  expect_edit(kBlock, {set("operator/kp", "-7 V")}, replaced(kBlock, "kp: 2", "kp: -7 V"));
  expect_edit(kBlock, {set("tasks/pid/alias", "w")}, replaced(kBlock, "alias:\n            q: q_seen\n", "alias: w\n"));
}

TEST(TextEdit, InsertsAKeyWhereItUsuallyStands) {
  expect_edit(kFlow, {set("tasks/pid/budget", "40 us")}, replaced(kFlow, "1 kHz, ", "1 kHz, budget: 40 us, "));
  expect_edit(kFlow, {set("tasks/pid/component", "p")}, replaced(kFlow, "{rate", "{component: p, rate"));
  expect_edit(kFlow, {set("tasks/arm/alias/q", "r")}, replaced(kFlow, "rtpu: servo", "rtpu: servo, alias: {q: r}"));
  expect_edit(kBlock, {set("tasks/pid/budget", "40 us")},
              replaced(kBlock, "# fast\n", "# fast\n        budget: 40 us\n"));
  expect_edit(kBlock, {set("tasks/pid/component", "p")},
              replaced(kBlock, "        rate", "        component: p\n        rate"));
  expect_edit(kBlock, {set("tasks/arm/alias/q", "r")},
              replaced(kBlock, "component: puma\n", "component: puma\n        alias: {q: r}\n"));
  expect_edit(kBlock, {set("operator/ki", "3")}, std::string(kBlock) + "    ki: 3\n");
  expect_edit(kBlock, {set("configurations/run/2", "eye")}, replaced(kBlock, "- arm\n", "- arm\n    - eye\n"));
}

TEST(TextEdit, MakesASectionInItsPlace) {
  expect_edit(kFlow, {set("constants/mass", "2 kg")},
              replaced(kFlow, "subsystem: s\n", "subsystem: s\nconstants:\n  mass: 2 kg\n"));
  expect_edit(kFlow, {set("configurations/run", "[pid, arm]")},
              std::string(kFlow) + "\nconfigurations:\n  run: [pid, arm]\n");
  expect_edit(kBlock, {set("rtpus/servo", "{cpu: 1}")},
              replaced(kBlock, "subsystem: s\n", "subsystem: s\nrtpus:\n    servo: {cpu: 1}\n"));
}

TEST(TextEdit, RemovesAKeyWithItsLinesOnly) {
  expect_edit(kFlow, {remove("tasks/pid/rate")}, replaced(kFlow, "rate: 1 kHz, ", ""));
  expect_edit(kFlow, {remove("tasks/pid/alias")}, replaced(kFlow, ", alias: {q: q_seen}", ""));
  expect_edit(kFlow, {remove("tasks/pid/alias/q")}, replaced(kFlow, "{q: q_seen}", "{}"));
  expect_edit(kFlow, {remove("tasks/pid")},
              replaced(kFlow, "  pid: {rate: 1 kHz, alias: {q: q_seen}}  # control\n", ""));
  expect_edit(kFlow, {remove("rtpus/servo")}, replaced(kFlow, "rtpus:\n  servo: {cpu: 1}  # fast\n", "rtpus: {}\n"));
  expect_edit(kFlow, {remove("operator")}, replaced(kFlow, "operator: {kp: 2, ki: 3}\n", ""));
  expect_edit(kBlock, {remove("tasks/pid/rate")}, replaced(kBlock, "        rate: 1 kHz    # fast\n", ""));
  expect_edit(kBlock, {remove("tasks/pid/alias/q")},
              replaced(kBlock, "alias:\n            q: q_seen\n", "alias: {}\n"));
  expect_edit(kBlock, {remove("configurations/run/0")}, replaced(kBlock, "    - pid  # first\n", ""));
  expect_edit(kBlock, {remove("configurations/run/1")}, replaced(kBlock, "    - arm\n", ""));
  expect_edit(kBlock, {remove("operator/kp")}, replaced(kBlock, "operator:\n    kp: 2\t# gain\n", "operator: {}\n"));
}

TEST(TextEdit, KeepsCommentsOfBracketsOverSeveralLines) {
  const std::string text =
      "subsystem: s\ntasks: {\n"
      "  a: {rate: 1 Hz},   # one\n"
      "  # about b\n"
      "  b: {rate: 2 Hz},\n"
      "  c: {rate: 3 Hz}    # three\n"
      "}\n";
  expect_edit(text, {remove("tasks/a")}, replaced(text, "  a: {rate: 1 Hz},   # one\n", ""));
  expect_edit(text, {remove("tasks/b")}, replaced(text, "  b: {rate: 2 Hz},\n", ""));
  expect_edit(text, {remove("tasks/c")},
              replaced(text, "{rate: 2 Hz},\n  c: {rate: 3 Hz}    # three\n", "{rate: 2 Hz}\n"));
  expect_edit(text, {add("d", "x")},
              replaced(text, "{rate: 3 Hz}    # three\n", "{rate: 3 Hz},    # three\n  d: {component: x}\n"));
  const std::string gains = "subsystem: s\ntasks: {a: }\noperator:\n  kp: [1 V,   # shoulder\n       2 V]   # elbow\n";
  expect_edit(gains, {set("operator/kp", "[1 V, 3 V]")}, replaced(gains, "2 V", "3 V"));
  expect_edit(gains, {set("operator/kp", "[1 V, 2 V, 3 V]")}, replaced(gains, "2 V]", "2 V,\n       3 V]"));
  expect_edit(gains, {set("operator/kp", "[1 V]")},
              replaced(gains, "1 V,   # shoulder\n       2 V]", "1 V   # shoulder\n       ]"));
  const std::string comma = "subsystem: s\ntasks:\n  a: {alias: {\n    x: u,\n    y: v,\n  }}\n";
  expect_edit(comma, {set("tasks/a/alias/z", "w")}, replaced(comma, "y: v,\n", "y: v,\n    z: w,\n"));
  expect_edit(comma, {remove("tasks/a/alias/y")}, replaced(comma, "    y: v,\n", ""));
}

TEST(TextEdit, FillsWhatIsEmpty) {
  const std::string text = "subsystem: s\ntasks:\n  a:   # one\n  b: {}\n  c: { }\n  d: null\noperator:\n";
  expect_edit(text, {set("tasks/a/rate", "1 Hz")}, replaced(text, "a:   #", "a: {rate: 1 Hz}   #"));
  expect_edit(text, {set("tasks/b/rate", "1 Hz")}, replaced(text, "{}", "{rate: 1 Hz}"));
  expect_edit(text, {set("tasks/c/rate", "1 Hz")}, replaced(text, "{ }", "{rate: 1 Hz }"));
  expect_edit(text, {set("tasks/d/rate", "1 Hz")}, replaced(text, "null", "{rate: 1 Hz}"));
  expect_edit(text, {set("operator/kp", "1")}, replaced(text, "operator:\n", "operator:\n  kp: 1\n"));
  expect_edit("subsystem: s\ntasks: {a: , b}\n", {set("tasks/a/rate", "1 Hz"), set("tasks/b/rate", "2 Hz")},
              "subsystem: s\ntasks: {a: {rate: 1 Hz} , b: {rate: 2 Hz}}\n");
}

TEST(TextEdit, WritesANewTaskAsTheOthersAre) {
  expect_edit(kFlow, {add("monitor", "tracking_monitor")},
              replaced(kFlow, "rtpu: servo}\n", "rtpu: servo}\n  monitor: {component: tracking_monitor}\n"));
  expect_edit(
      kBlock, {add("monitor", "tracking_monitor")},
      replaced(kBlock, "component: puma\n", "component: puma\n    monitor:\n        component: tracking_monitor\n"));
  expect_edit(kFlow, {add("eye", "eye"), set("tasks/eye/rate", "30 Hz")},
              replaced(kFlow, "rtpu: servo}\n", "rtpu: servo}\n  eye: {rate: 30 Hz}\n"));
  expect_edit(kBlock, {add("eye", "eye"), set("tasks/eye/rate", "30 Hz")},
              replaced(kBlock, "component: puma\n", "component: puma\n    eye:\n        rate: 30 Hz\n"));
  EXPECT_EQ(edited(kFlow, {add("pid", "x")}), "tasks/pid: there is a task 'pid' already");
  EXPECT_EQ(edited(kFlow, {add("a b", "x")}),
            "tasks/a b: the name is 'a b'; expected a letter or '_', then letters, digits and '_', at most 64");
}

TEST(TextEdit, BeginsAnEmptyText) {
  EXPECT_EQ(edited("", {add("pid", "pid_joint")}), "subsystem: untitled\ntasks:\n  pid: {component: pid_joint}\n");
  EXPECT_EQ(edited("# new\n", {AddTask{"pid", "pid", "arm"}}), "# new\nsubsystem: arm\ntasks:\n  pid: {}\n");
  EXPECT_EQ(edited("# new", {set("subsystem", "arm"), add("a", "b"), link("a", "x", "y")}),
            "# new\nsubsystem: arm\ntasks:\n  a: {component: b, alias: {x: y}}\n");
  EXPECT_EQ(edited("subsystem: s\ntasks:\n", {add("a", "b")}), "subsystem: s\ntasks:\n  a: {component: b}\n");
  EXPECT_EQ(edited("subsystem: s", {add("a", "b")}), "subsystem: s\ntasks:\n  a: {component: b}");
}

TEST(TextEdit, GivesEachMapOfANewListALine) {
  const std::string tasks = "subsystem: s\ntasks: {a: {}}\n";
  const std::string list = tasks + "sequence:\n  - {switch: run, until: \"q[0] > 1 rad\"}\n";
  const EditAct first = set("sequence", "[{switch: run, until: 'q[0] > 1 rad'}]");
  expect_edit(tasks, {first}, list);
  expect_edit(tasks + "sequence: []\n", {first}, list);
  expect_edit(tasks + "sequence:\n", {first}, list);
  expect_edit(list, {set("sequence/1", "{switch: rest}")}, list + "  - {switch: rest}\n");
  expect_edit(list, {set("sequence/0/name", "go"), set("sequence/0/within", "1 s")},
              replaced(replaced(list, "{switch", "{name: go, switch"), "\"}", "\", within: 1 s}"));
  expect_edit(list, {remove("sequence"), set("sequence", "{repeat: true, steps: [{switch: run}, {switch: b}]}")},
              tasks + "sequence:\n  repeat: true\n  steps:\n    - {switch: run}\n    - {switch: b}\n");
  expect_edit(tasks + "sequence: [{switch: run}]\n", {set("sequence/1", "{switch: rest}")},
              tasks + "sequence: [{switch: run}, {switch: rest}]\n");
}

TEST(TextEdit, LinksAPortByAnAlias) {
  expect_edit(kFlow, {link("arm", "tau", "torque")},
              replaced(kFlow, "rtpu: servo", "rtpu: servo, alias: {tau: torque}"));
  expect_edit(kFlow, {link("pid", "q", "r")}, replaced(kFlow, "q_seen", "r"));
  expect_edit(kFlow, {link("pid", "tau", "r")}, replaced(kFlow, "q_seen", "q_seen, tau: r"));
  expect_edit(kFlow, {link("pid", "q", "q")}, replaced(kFlow, ", alias: {q: q_seen}", ""));
  expect_edit(kBlock, {link("pid", "q", "q")}, replaced(kBlock, "        alias:\n            q: q_seen\n", ""));
  expect_edit(kFlow, {link("arm", "q", "q")}, kFlow);
  expect_edit(kFlow, {LinkPort{"pid", "in", "a", 0}, LinkPort{"pid", "in", "b", 1}},
              replaced(kFlow, "q_seen", "q_seen, in: [a, b]"));
  EXPECT_EQ(edited(kFlow, {link("pdi", "q", "r")}), "tasks/pdi: no task 'pdi'; did you mean 'pid'?");
  EXPECT_EQ(edited(kFlow, {LinkPort{"pid", "in", "a", 1}}), "tasks/pid/alias/in/1: the list has 0 items");
}

constexpr const char* kNames =
    "subsystem: s\n"
    "constants: {pid: hand, mass: 2 kg}\n"
    "rtpus: {fast: {}}\n"
    "tasks:\n"
    "  pid: {rate: 1 Hz, rtpu: fast, alias: {m: mass, in: [kp, q], out: q}}\n"
    "  spare: {component: pid, standby_for: pid, on_miss: {switch: hand}}\n"
    "  hot: {component: pid, standby_for: {task: pid, hot: true}, on_overrun: {switch: hand}}\n"
    "  mode: {constants: {when: hand, then: '--on pid spare --off pid', name: pidx}, on_fault: {switch: hand}}\n"
    "  last: {on_fault: {restart: 1, within: 1 s, then: {switch: hand}}}\n"
    "operator: {kp: 1}\n"
    "configurations:\n"
    "  hand: [pid, mode]\n"
    "  arm: {tasks: [pid, last], safe_when: 'kp[1] < 2'}\n"
    "start: hand\n";

TEST(TextEdit, RenamesATaskInAllPlacesThatNameIt) {
  std::string after = replaced(kNames, "constants: {pid: hand", "constants: {pid: hand");
  after = replaced(after, "  pid: {rate", "  law: {component: pid, rate");
  after = replaced(after, "standby_for: pid", "standby_for: law");
  after = replaced(after, "task: pid", "task: law");
  after = replaced(after, "--on pid spare --off pid", "--on law spare --off law");
  after = replaced(after, "[pid, mode]", "[law, mode]");
  after = replaced(after, "[pid, last]", "[law, last]");
  expect_edit(kNames, {rename("tasks/pid", "law")}, after);
}

TEST(TextEdit, RenamesAConfigurationInAllPlacesThatNameIt) {
  std::string after = kNames;
  for (int i = 0; i < 8; ++i) after = replaced(after, "hand", "HAND");
  after = replaced(after, "HAND: [", "grip: [");
  while (after.find("HAND") != std::string::npos) after = replaced(after, "HAND", "grip");
  EXPECT_EQ(after.find("hand"), std::string::npos);
  expect_edit(kNames, {rename("configurations/hand", "grip")}, after);
}

TEST(TextEdit, RenamesRtpusVariablesAndConstants) {
  expect_edit(kNames, {rename("rtpus/fast", "servo")},
              replaced(replaced(kNames, "fast", "servo"), "rtpu: fast", "rtpu: servo"));
  const std::string kp = replaced(replaced(replaced(kNames, "[kp", "[k"), "{kp: 1", "{k: 1"), "'kp[1]", "'k[1]");
  expect_edit(kNames, {rename("operator/kp", "k")}, kp);
  expect_edit(kNames, {rename("variables/kp", "k")}, kp);
  expect_edit(kNames, {rename("operator/kp", "k", {{"last", "kp"}, {"pid", "in"}})},
              replaced(kp, "last: {", "last: {alias: {kp: k}, "));
  expect_edit(kNames, {rename("variables/q", "r")}, replaced(kNames, "q], out: q", "r], out: r"));
  expect_edit(kNames, {rename("constants/mass", "m2")},
              replaced(replaced(kNames, "mass: 2", "m2: 2"), "m: mass", "m: m2"));
  expect_edit(kNames, {rename("tasks/pid/alias/m", "load")}, replaced(kNames, "m: mass", "load: mass"));
  EXPECT_EQ(edited(kNames, {rename("operator/kp", "q")}),
            "operator/kp: 'q' is the name of a variable or constant already: link ports to it instead");
  EXPECT_EQ(edited(kNames, {rename("tasks/pid", "spare")}), "tasks/pid: there is 'spare' already");
  EXPECT_EQ(edited(kNames, {rename("tasks/pdi", "x")}), "tasks/pdi: no key 'pdi'; did you mean 'pid'?");
  EXPECT_EQ(edited(kNames, {rename("variables/zz", "x")}),
            "variables/zz: no alias, operator or constant has this name");
  EXPECT_EQ(edited(kNames, {rename("start", "x")}), "start: keys of the file have fixed names");
}

TEST(TextEdit, TakesNamesThatLookLikeValues) {
  for (const char* name : {"on", "yes", "no", "_1", "true", "null"}) {
    const std::string written = std::string(name) == "null" ? "\"null\"" : name;
    expect_edit("subsystem: s\ntasks:\n  a: {}\nstart: a\n", {rename("tasks/a", name)},
                "subsystem: s\ntasks:\n  " + written + ": {component: a}\nstart: a\n");
  }
  for (const char* name : {"1", "a b", "", "\xC3\xA4", "a-b", "a:"})
    EXPECT_NE(edited("subsystem: s\ntasks: {a: }\n", {rename("tasks/a", name)}).find("expected a letter"),
              std::string::npos)
        << name;
}

TEST(TextEdit, QuotesAsYamlNeedsItAndAsItWasBefore) {
  const std::string text =
      "subsystem: s\ntasks:\n  a: {resources: {f: \"0:0\", g: 'it''s # h', h: x}}\noperator: {k: 1}\n";
  expect_edit(text, {set("tasks/a/resources/h", "a, b")}, replaced(text, "h: x", "h: \"a, b\""));
  expect_edit(text, {set("tasks/a/resources/h", "a b")}, replaced(text, "h: x", "h: a b"));
  expect_edit(text, {set("tasks/a/resources/h", "gr\xC3\xBC\xC3\x9F \xF0\x9F\x99\x82")},
              replaced(text, "h: x", "h: gr\xC3\xBC\xC3\x9F \xF0\x9F\x99\x82"));
  expect_edit(text, {set("tasks/a/resources/g", "\"it's\"")}, replaced(text, "'it''s # h'", "'it''s'"));
  expect_edit(text, {set("tasks/a/resources/g", "on")}, replaced(text, "'it''s # h'", "on"));
  expect_edit(text, {set("tasks/a/resources/f", "'1'")}, replaced(text, "\"0:0\"", "\"1\""));
  expect_edit("subsystem: s\n\"tasks\":\n  'a': {\"rate\": 1 Hz}\n",
              {set("tasks/a/rate", "2 Hz"), rename("tasks/a", "b")},
              "subsystem: s\n\"tasks\":\n  'b': {component: a, \"rate\": 2 Hz}\n");
  EXPECT_EQ(edited(text, {set("operator/k", "[1")}), "operator/k: '[1' is no value");
  EXPECT_EQ(edited(text, {set("operator/k", "")}), "operator/k: '' is no value");
  EXPECT_EQ(edited(text, {set("operator/k", "1\nb: 2")}), "operator/k: '1 b: 2' is no value");
}

TEST(TextEdit, FollowsPlainTextsOverSeveralLines) {
  const std::string text =
      "subsystem: s\ntasks:\n  a: {resources: {f: one\n    two, g: x}}\n  b:\n    resources:\n"
      "      f: one\n        two\n\n        three  # end\n      g: 'a\n        b'\n";
  expect_edit(text, {set("tasks/a/resources/f", "z")}, replaced(text, "one\n    two", "z"));
  expect_edit(text, {set("tasks/b/resources/f", "z")}, replaced(text, "one\n        two\n\n        three", "z"));
  expect_edit(text, {remove("tasks/b/resources/g")}, replaced(text, "      g: 'a\n        b'\n", ""));
  expect_edit(text, {set("tasks/b/resources/h", "z")}, text + "      h: z\n");
}

TEST(TextEdit, RefusesAPlaceThatIsNotThere) {
  EXPECT_EQ(edited(kFlow, {set("tasks/pdi/rate", "1 Hz")}), "tasks/pdi: no task 'pdi'; did you mean 'pid'?");
  EXPECT_EQ(edited(kFlow, {set("tasks/pid/raet", "1 Hz")}), "tasks/pid/raet: no key 'raet'; did you mean 'rate'?");
  EXPECT_EQ(edited(kFlow, {set("operater/kp", "1")}), "operater: no key 'operater'; did you mean 'operator'?");
  EXPECT_EQ(edited(kFlow, {set("tasks/pid/rate/x", "1")}),
            "tasks/pid/rate: has a value without parts: set it as a whole");
  EXPECT_EQ(edited(kBlock, {set("configurations/run/x", "1")}),
            "configurations/run: is a list: set it as a whole, or name an item by its number");
  EXPECT_EQ(edited(kBlock, {set("configurations/run/7", "1")}), "configurations/run/7: the list has 2 items");
  EXPECT_EQ(edited(kFlow, {remove("tasks/pid/budget")}), "tasks/pid/budget: no key 'budget'");
  EXPECT_EQ(edited(kFlow, {set("", "1")}), ": the path is empty");
  EXPECT_EQ(edited("a: 1\n", {remove("a")}), ": no key would be left in the text: remove the file instead");
}

TEST(TextEdit, RefusesWhereItWouldTouchAnAnchorAliasTagOrBlockScalar) {
  const std::string text =
      "subsystem: s\ntasks:\n  a: {rate: &r 1 Hz, budget: 1 ms}\n  b: {rate: *r}\n"
      "  c: {rate: !t 1 Hz}\noperator:\n  k: |\n    1\n  l: 2\n";
  EXPECT_EQ(edited(text, {set("tasks/a/rate", "2 Hz")}),
            "3:13: an anchor (&) is not accepted (write the value out where it is used)");
  EXPECT_EQ(edited(text, {set("tasks/c/rate", "2 Hz")}),
            "5:13: a tag (!) is not accepted (leave it out: the port settles the type)");
  EXPECT_EQ(edited(text, {set("operator/k", "2")}),
            "7:6: a block scalar (| or >) is not accepted (write the text on one line)");
  EXPECT_EQ(edited(text, {remove("tasks/a")}),
            "3:13: an anchor (&) is not accepted (write the value out where it is used)");
  EXPECT_EQ(edited(text, {set("tasks/b/rate", "2 Hz")}),
            "4:13: an alias (*) is not accepted (write the value out where it is used)");
  EXPECT_EQ(edited(text, {set("tasks/a/budget", "2 ms"), set("operator/l", "3")}),
            replaced(replaced(text, "1 ms", "2 ms"), "l: 2", "l: 3"));
}

TEST(TextEdit, RefusesATextThatIsNoYamlOrHasAKeyTwice) {
  EXPECT_EQ(edited("subsystem: s\ntasks: {a: {rate: 1 Hz, rate: 2 Hz}}\n", {set("subsystem", "t")}),
            "2:25: the key 'rate' stands already at 2:13 (take one of the two out)");
  EXPECT_TRUE(edited("tasks: [", {set("subsystem", "t")}).starts_with("1:8: not YAML"))
      << edited("tasks: [", {set("subsystem", "t")});
  EXPECT_TRUE(edited("tasks:\n\ta: 1\n", {set("subsystem", "t")}).starts_with("2:1: a tab"));
  EXPECT_TRUE(edited("- a\n", {set("subsystem", "t")}).starts_with(": is a list"));
  EXPECT_EQ(edited("? a\n: 1\nb: 2\n", {remove("a")}),
            "1:1: this place is written in a form that no edit follows: edit the text by hand");
}

TEST(TextEdit, JoinsProducers) {
  const std::string text =
      "subsystem: join\ntasks:\n"
      "  left: {component: gain, rate: 100 Hz, alias: {x: lv, y: distance}}\n"
      "  right: {component: gain, rate: 50 Hz, alias: {x: rv, y: distance}}\n"
      "  speed: {component: tderiv, rate: 100 Hz, alias: {x: distance}}\n"
      "configurations: {run: [left, right, speed]}\n";
  const std::vector<TaskPort> producers = {{"left", "y"}, {"right", "y"}};
  const auto joined = [&](const char* task, const char* tail = "") {
    std::string after =
        replaced(replaced(text, "lv, y: distance", "lv, y: distance_1"), "rv, y: distance", "rv, y: distance_2");
    after = replaced(after, "  speed:", std::string("  join_distance: ") + task + "\n  speed:");
    return replaced(after, "right, speed", "right, join_distance, speed") + tail;
  };
  expect_edit(text, {JoinProducers{"distance", JoinBy::kMean, producers}},
              joined("{component: join_mean, rate: 100 Hz, alias: {in: [distance_1, distance_2], out: distance}}"));
  EXPECT_EQ(edited(text, {JoinProducers{"distance", JoinBy::kPriority, producers}}),
            joined("{component: join_priority, rate: 100 Hz, alias: {in: [distance_1, distance_2], out: distance, "
                   "chosen: distance_chosen}}"));
  EXPECT_EQ(edited(text, {JoinProducers{"distance", JoinBy::kSelect, producers}}),
            replaced(joined("{component: select, rate: 100 Hz, alias: {in: [distance_1, distance_2], "
                            "which: distance_which, out: distance}}"),
                     "configurations", "operator:\n  distance_which: 0\nconfigurations"));
  EXPECT_EQ(edited(text, {JoinProducers{"distance", JoinBy::kMean, {{"left", "y"}}}}),
            "variables/distance: a join needs two producers; name task and port of each");
  const std::string spare =
      replaced(text, "  speed", "  spare: {component: gain, standby_for: left, alias: {y: distance}}\n  speed");
  EXPECT_NE(edited(spare, {JoinProducers{"distance", JoinBy::kMean, {{"left", "y"}, {"right", "y"}, {"spare", "y"}}}})
                .find("standby_for: left, alias: {y: distance_1}}"),
            std::string::npos);
}

TEST(TextEdit, DoesActsInTurnAndAllOrNone) {
  expect_edit(kFlow,
              {add("eye", "eye"), rename("tasks/eye", "ear"), set("tasks/ear/rate", "9 Hz"), remove("tasks/ear")},
              kFlow);
  EXPECT_EQ(edited(kFlow, {set("tasks/pid/rate", "5 Hz"), remove("tasks/x")}), "tasks/x: no task 'x'");
}

// ---- values that say the same ----

constexpr const char* kValues =
    "# the arm\nsubsystem: s\ntasks:\n  a:   {component: c}   # kp: 3\n\n"
    "operator:  # the gains\n"
    "  kp: [100 N.m/rad,   # shoulder\n       90 N.m/rad]   # elbow\n"
    "  goal: 180 deg\t# half a turn\n"
    "  name: 'it''s # here'  # a text\n"
    "  pose: {x: 1 m, y: 2 m}\n"
    "configurations:\n  run: [a]";

std::string saved(const std::string& text, const std::vector<std::pair<const char*, const char*>>& values) {
  std::vector<EditAct> acts;
  for (const auto& [name, value] : values) acts.emplace_back(SetValue{{"operator", name}, value, &our_units()});
  return edited(text, acts);
}

TEST(TextEdit, OnlyTheValuesThatDifferChange) {
  EXPECT_EQ(saved(kValues, {{"goal", "1.5 rad"},
                            {"name", "\"new\""},
                            {"pose", "{x: 1 m, y: 3 m}"},
                            {"kp", "[100 N.m/rad, 80 N.m/rad]"}}),
            "# the arm\nsubsystem: s\ntasks:\n  a:   {component: c}   # kp: 3\n\n"
            "operator:  # the gains\n"
            "  kp: [100 N.m/rad,   # shoulder\n       80 N.m/rad]   # elbow\n"
            "  goal: 1.5 rad\t# half a turn\n"
            "  name: 'new'  # a text\n"
            "  pose: {x: 1 m, y: 3 m}\n"
            "configurations:\n  run: [a]");
}

TEST(TextEdit, AnEqualValueStaysAsItIsWritten) {
  EXPECT_EQ(saved(kValues, {{"goal", "3.141592653589793 rad"},
                            {"kp", "[100 N.m/rad, 90 N.m/rad]"},
                            {"name", "\"it's # here\""},
                            {"pose", "{y: 2 m, x: 1 m}"}}),
            kValues);
  const std::string broadcast = "subsystem: s\ntasks: {a: }\noperator: {kp: 2 m, ki: 3}\n";
  EXPECT_EQ(saved(broadcast, {{"kp", "[2 m, 2 m]"}}), broadcast);
  EXPECT_EQ(saved(broadcast, {{"kp", "[2 m, 3 m]"}, {"ki", "4"}}),
            "subsystem: s\ntasks: {a: }\noperator: {kp: [2 m, 3 m], ki: 4}\n");
}

TEST(TextEdit, ReplacesValuesThatHaveLinesOfTheirOwnOneByOne) {
  const std::string head = "subsystem: s\ntasks: {a: }\noperator:\n";
  EXPECT_EQ(
      saved(head + "  kp:\n    - 1 m  # near\n    # far\n    - 2 m\n  ki: 3\n", {{"kp", "[1 m, 7 m]"}, {"ki", "4"}}),
      head + "  kp:\n    - 1 m  # near\n    # far\n    - 7 m\n  ki: 4\n");
  EXPECT_EQ(saved(head + "  m:\n    - [1, 2]\n    - [3, 4]\n", {{"m", "[[1, 2], [5, 6]]"}}),
            head + "  m:\n    - [1, 2]\n    - [5, 6]\n");
  EXPECT_EQ(saved(head + "  pose:\n    x: 1 m\n    y: 2 m\n", {{"pose", "{y: 3 m, x: 1 m}"}}),
            head + "  pose:\n    x: 1 m\n    y: 3 m\n");
  EXPECT_EQ(saved(head + "  kp:\n    - 1\n    - 2\n", {{"kp", "[1, 3, 4]"}}),
            head + "  kp:\n    - 1\n    - 3\n    - 4\n");
}

TEST(TextEdit, RefusesEachActOnTheTaskThatTheKeyOfASequenceMakes) {
  const std::string text = "subsystem: s\ntasks: {pid: }\nsequence: [{switch: run}]\n";
  const EditAct acts[] = {set("tasks/sequence/rate", "50 Hz"), set("tasks/sequence", "{rate: 50 Hz}"),
                          remove("tasks/sequence"), rename("tasks/sequence", "steps"), add("sequence", "sequence"),
                          link("sequence", "value", "q"), rename("tasks/pid", "sequence"),
                          rename("variables/q", "p", {{"sequence", "q"}})};
  for (const EditAct& act : acts)
    EXPECT_EQ(edited(text, {act}), "tasks/sequence: task 'sequence' comes from the key 'sequence': edit its steps");
  EXPECT_EQ(edited(text, {set("tasks/sequences/rate", "1 Hz")}), "tasks/sequences: no task 'sequences'");
  expect_edit("tasks: {sequence: {rate: 1 Hz}}\nsequence: []\n", {set("tasks/sequence/rate", "2 Hz")},
              "tasks: {sequence: {rate: 2 Hz}}\nsequence: []\n");
}

}  // namespace
}  // namespace chimera::text_edit_test
