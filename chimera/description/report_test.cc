// SPDX-License-Identifier: Apache-2.0
#include "chimera/description/report.h"

#include <gtest/gtest.h>

#include "chimera/description/draft.h"

namespace chimera {
namespace {

Fault fault(Place at, std::string message) {
  return {.rule = "key-unknown",
          .at = at,
          .message = std::move(message),
          .found = "rat",
          .expected = "'rate'",
          .nearest = "rate"};
}

TEST(Report, ReadsLikeACompiler) {
  Report report("arm.yaml");
  report.add(fault({12, 8}, "task 'a' has no key 'rat'"));
  EXPECT_EQ(report.text(), "arm.yaml:12:8: error: task 'a' has no key 'rat' [key-unknown]\n  did you mean 'rate'?\n");
}

TEST(Report, SortsByPlaceAndKeepsEachFaultOnce) {
  Report report("a");
  report.add(fault({3, 1}, "third"));
  report.add(fault({1, 9}, "second"));
  report.add(fault({1, 2}, "first"));
  report.add(fault({3, 1}, "third"));
  report.sort();
  ASSERT_EQ(report.faults().size(), 3u);
  EXPECT_EQ(report.faults()[0].message, "first");
  EXPECT_EQ(report.faults()[2].message, "third");
}

TEST(Report, IsLegalWithWarnings) {
  Report report("a");
  Fault warning = fault({1, 1}, "unused");
  warning.severity = Severity::kWarning;
  report.add(warning);
  EXPECT_TRUE(report.is_legal());
  EXPECT_EQ(report.warnings(), 1u);
  report.add(fault({1, 1}, "wrong"));
  EXPECT_FALSE(report.is_legal());
}

TEST(Report, CountsFaultsThatItDoesNotKeep) {
  Report report("a"), whole("a");
  for (std::uint32_t i = 0; i < 250; ++i) report.add(fault({i + 1, 1}, "wrong"));
  whole.add_all(report);
  EXPECT_EQ(whole.errors(), 250u);
  EXPECT_EQ(whole.faults().size(), Report::kMaxFaults);
  EXPECT_TRUE(whole.text().ends_with("a: and 50 more\n"));
}

TEST(Report, KeepsAFaultOnOneLine) {
  Report report("a");
  report.add(fault({1, 1}, "found 'a\nb: error: c [d]\x1b[31m'"));
  EXPECT_EQ(report.text(), "a:1:1: error: found 'a b: error: c [d] [31m' [key-unknown]\n  did you mean 'rate'?\n");
}

TEST(Report, IsOneJsonObject) {
  Report report("a \"b\"");
  report.add(fault({2, 3}, "back\\slash"));
  EXPECT_EQ(report.json(),
            R"({"file": "a \"b\"", "legal": false, "errors": 1, "warnings": 0, "faults": [{"rule": "key-unknown", )"
            R"("severity": "error", "file": "a \"b\"", "line": 2, "column": 3, "found": "rat", "expected": "'rate'", )"
            R"("nearest": "rate", "message": "back\\slash", "remedy": "did you mean 'rate'?", "set": "", "task": "", )"
            R"("port": "", "path": "", "offers": []}], "notes": []})");
  EXPECT_EQ(Report("a").json(),
            R"({"file": "a", "legal": true, "errors": 0, "warnings": 0, "faults": [], "notes": []})");
}

TEST(Report, FillsPathAndBoxFromThePlace) {
  const auto box = [](const std::string& text) {
    const ReadDescription reading = read_description(text, "a");
    const Fault& fault = reading.report.faults()[0];
    Report again("a", reading.report.keys());
    again.add_all(reading.report);
    EXPECT_EQ(again.faults()[0].path, fault.path) << "its path is made anew, not longer";
    return fault.path + " set=" + fault.set + " task=" + fault.task + " port=" + fault.port;
  };
  const std::string head = "subsystem: a\ntasks:\n  pid:\n    ";
  EXPECT_EQ(box(head + "rat: 1 Hz\n"), "tasks/pid/rat set= task=pid port=");  // the map begins at the same place
  EXPECT_EQ(box(head + "rate:\n      a: 1\n"), "tasks/pid/rate set= task=pid port=");
  EXPECT_EQ(box(head + "alias: {q: 1 m}\n"), "tasks/pid/alias/q set= task=pid port=q");
  EXPECT_EQ(box(head + "alias:\n      in:\n      - a\n      - b c\n"),
            "tasks/pid/alias/in/1 set= task=pid port=in[1]");
  EXPECT_EQ(box(head + "rate: 1 Hz\nconfigurations: {run: [1 m]}\n"), "configurations/run/0 set=run task= port=");
  EXPECT_EQ(box(head + "resources: {port: &a x}\n"), "tasks/pid/resources/port set= task=pid port=port");
  EXPECT_EQ(box("subsystem: a\n"), " set= task= port=");
}

TEST(Report, WritesEachKindOfActThatItOffers) {
  Report report("a");
  report.add(fault({1, 1}, "wrong"));
  report.offer(0, {"press", {SetValue{{"tasks", "pid", "rate"}, "1 kHz"}, RemoveValue{{"operator", "x"}},
                             RenameKey{{"tasks", "a"}, "b", {{"c", "d"}}}, AddTask{"e", "f"},
                             LinkPort{"g", "h", "i", 2}, LinkPort{"g", "h", "i", std::nullopt},
                             JoinProducers{"j", JoinBy::kPriority, {{"k", "l"}}}}});
  const std::string expected =
      R"("offers": [{"label": "press", "acts": [{"act": "set", "path": "tasks/pid/rate", "value": "1 kHz"}, )"
      R"({"act": "remove", "path": "operator/x"}, )"
      R"({"act": "rename", "path": "tasks/a", "to": "b", "ports": [{"task": "c", "port": "d"}]}, )"
      R"({"act": "add_task", "name": "e", "component": "f"}, )"
      R"({"act": "link", "task": "g", "port": "h", "variable": "i", "instance": 2}, )"
      R"({"act": "link", "task": "g", "port": "h", "variable": "i", "instance": null}, )"
      R"({"act": "join", "variable": "j", "by": "priority", "producers": [{"task": "k", "port": "l"}]}]}])";
  EXPECT_NE(report.json().find(expected), std::string::npos) << report.json();
}

TEST(Report, HasNotesThatAreNoFaults) {
  Report report("a"), other("a");
  other.note("something to\nknow");
  other.note("something to know");
  report.add_all(other);
  EXPECT_TRUE(report.is_legal());
  EXPECT_EQ(report.text(), "a: note: something to know\n");
  EXPECT_TRUE(report.json().ends_with(R"("faults": [], "notes": ["something to know"]})")) << report.json();
}

}  // namespace
}  // namespace chimera
