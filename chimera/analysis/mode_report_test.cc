// SPDX-License-Identifier: Apache-2.0
#include "chimera/analysis/mode_report.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

PortDescriptor port(std::string name, std::uint32_t kind, std::string shape = "") {
  return {.name = std::move(name), .unit = "1", .shape = std::move(shape), .kind = kind};
}

PortDescriptor whole(std::string name, std::uint32_t kind) {
  PortDescriptor out = port(std::move(name), kind);
  out.type = CHIMERA_INT32;
  out.element_size = 4;
  return out;
}

PortDescriptor device(std::string name) {
  PortDescriptor out = port(std::move(name), CHIMERA_RESOURCE);
  out.type = CHIMERA_STRING;
  out.element_size = 256;
  return out;
}

PortDescriptor question(std::string name) {
  PortDescriptor out = port(std::move(name), CHIMERA_IN_CONST);
  out.type = CHIMERA_STRING;
  out.element_size = 64;
  out.names_configuration = true;
  return out;
}

Descriptor component(std::string name, std::vector<PortDescriptor> ports) {
  Descriptor made;
  made.name = std::move(name);
  made.default_rate_hz = 100;
  made.methods[CHIMERA_CYCLE] = true;
  made.ports = std::move(ports);
  EXPECT_TRUE(complete(made));
  return made;
}

/// A tool weighs something, an arm that carries it says how long it is, a user reckons with that.
const Library& library() {
  static const Library kLibrary = Library::of(
      {component("tool", {port("mass", CHIMERA_OUT_CONST)}),
       component("arm", {port("mass", CHIMERA_IN_CONST), port("length", CHIMERA_OUT_CONST)}),
       component("user", {port("length", CHIMERA_IN_CONST)}),
       component("sized_tool", {whole("n", CHIMERA_OUT_CONST), port("u", CHIMERA_OUT_VAR, "[n<=4]")}),
       component("sized_user", {port("u", CHIMERA_IN_VAR, "[m<=4]")}),
       component("source", {port("y", CHIMERA_OUT_VAR)}),
       component("asker", {question("when")}),
       component("device", {device("tty"), port("y", CHIMERA_OUT_VAR)}),
       component("sink", {port("y", CHIMERA_IN_VAR)})},
      our_units());
  return kLibrary;
}

Configuration verified(const std::string& text) {
  Verdict verdict = verify(read_description("subsystem: s\n" + text, "s.yaml"), library());
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  return *std::move(verdict.configuration);
}

const ModeEdge& edge(const ModeReport& report, const std::string& from, const std::string& to) {
  const auto found = std::ranges::find_if(report.edges, [&](const ModeEdge& each) {
    return report.nodes[each.from].name == from && report.nodes[each.to].name == to;
  });
  EXPECT_NE(found, report.edges.end()) << from << " -> " << to;
  return *found;
}

/// "mass: light, heavy; arm": the constant, its producers before and after the switch, and its user.
std::string text(const Configuration& made, const ModeConstant& constant) {
  const auto name = [&](std::size_t task) { return made.tasks()[task].name; };
  std::string text = constant.name + ": " + name(constant.before) + ", " + name(constant.after) + ";";
  for (const std::size_t user : constant.users) text += " " + name(user);
  return text;
}

std::string anew(const Configuration& made, const ModeEdge& edge) {
  return join(edge.anew, " ", [&made](std::size_t task) { return made.tasks()[task].name; });
}

constexpr const char* kTools =
    "tasks:\n"
    "  light: {component: tool}\n"
    "  heavy: {component: tool}\n"
    "  arm: {component: arm}\n"
    "  user: {component: user}\n"
    "configurations: {a: [light, arm, user], b: [heavy, arm, user], c: [light, arm]}\n"
    "start: a\n";

TEST(ModeReport, ConstantOfAnotherTaskMayMakeASwitchSlow) {
  const Configuration made = verified(kTools);
  const ModeReport report = mode_report(made, library());
  const ModeEdge& there = edge(report, "a", "b");
  EXPECT_EQ(there.way(), ModeWay::kSlowUnlessSame);
  ASSERT_EQ(there.constants.size(), 1u);
  EXPECT_EQ(text(made, there.constants[0]), "mass: light, heavy; arm");
  EXPECT_EQ(anew(made, there), "arm user");  // the user follows from the arm
  EXPECT_EQ(text(made, edge(report, "b", "a").constants.at(0)), "mass: heavy, light; arm");
  EXPECT_FALSE(there.breaks_promise());
  EXPECT_TRUE(report.is_accepted());
  EXPECT_TRUE(report.warnings.empty());
}

TEST(ModeReport, ListsInAConstantLeadToASetThatIsNoConfiguration) {
  const Configuration made = verified(
      "tasks:\n"
      "  main: {component: source}\n"
      "  other: {component: source, alias: {y: z}}\n"
      "  watcher: {component: asker, constants: {when: \"--on other\"}}\n"
      "configurations: {run: [main, watcher], main_alone: [main]}\n"
      "start: run\n");
  const ModeReport report = mode_report(made, library());
  const ModeEdge& there = edge(report, "run", "run --on other");
  ASSERT_EQ(there.askers.size(), 1u);
  EXPECT_EQ(asker_text(made, there.askers[0]), "constant when of watcher");
  EXPECT_EQ(there.way(), ModeWay::kFast);
  EXPECT_EQ(there.cpus.size(), 1u) << "its deadlines are judged";
  EXPECT_EQ(report.nodes.size(), 3u);
}

TEST(ModeReport, NamesConstantsAndTakeoversAsJson) {
  const auto json_of = [](const Configuration& made) { return mode_json(made, mode_report(made, library())); };
  const std::string tools = json_of(verified(kTools));
  EXPECT_NE(tools.find(R"("from":"a","to":"b","asked_by":[],"legal":true,"way":"slow-unless-same","cpus":[)"),
            std::string::npos) << tools;
  EXPECT_NE(tools.find(R"("constants":[{"constant":"mass","before":"light","after":"heavy","tasks":["arm"]}],)"
                       R"("resources":[],"initialised_anew":["arm","user"]})"),
            std::string::npos) << tools;
  const std::string spared = json_of(verified(
      "tasks:\n"
      "  main: {component: source}\n"
      "  spare: {component: source, standby_for: main}\n"
      "configurations: {run: [main]}\n"
      "start: run\n"));
  EXPECT_NE(spared.find(R"("takeovers":[{"name":"run with spare for main","configuration":"run","primary":"main",)"
                        R"("standby":"spare"}])"),
            std::string::npos) << spared;
  EXPECT_NE(spared.find(R"("way":"takeover")"), std::string::npos);
}

TEST(ModeReport, SameProducerKeepsItsConstant) {
  const ModeReport report = mode_report(verified(kTools), library());
  EXPECT_EQ(edge(report, "a", "c").way(), ModeWay::kFast);
  EXPECT_EQ(edge(report, "c", "a").way(), ModeWay::kFast);
}

TEST(ModeReport, TasksThatLeaveOrArriveDoNotMakeASwitchSlow) {
  const Configuration made = verified(
      "tasks:\n"
      "  light: {component: tool}\n"
      "  heavy: {component: tool}\n"
      "  left: {component: arm}\n"
      "  right: {component: arm}\n"
      "configurations: {a: [light, left], b: [heavy, right]}\n"
      "start: a\n");
  const ModeReport report = mode_report(made, library());
  EXPECT_EQ(edge(report, "a", "b").way(), ModeWay::kFast);
  EXPECT_TRUE(edge(report, "a", "b").anew.empty());
}

TEST(ModeReport, GivenConstantStays) {
  const ModeReport report = mode_report(
      verified("tasks:\n"
               "  light: {component: tool}\n"
               "  heavy: {component: tool}\n"
               "  arm: {component: arm, constants: {mass: 3}}\n"
               "configurations: {a: [light, arm], b: [heavy, arm]}\n"
               "start: a\n"),
      library());
  EXPECT_EQ(edge(report, "a", "b").way(), ModeWay::kFast);
}

TEST(ModeReport, ExtentIsUsedToo) {
  const Configuration made = verified(
      "tasks:\n"
      "  one: {component: sized_tool}\n"
      "  two: {component: sized_tool}\n"
      "  user: {component: sized_user}\n"
      "configurations: {a: [one, user], b: [two, user]}\n"
      "start: a\n");
  const ModeEdge there = edge(mode_report(made, library()), "a", "b");
  EXPECT_EQ(there.way(), ModeWay::kSlowUnlessSame);
  EXPECT_EQ(text(made, there.constants.at(0)), "n: one, two; user");
}

TEST(ModeReport, WarnsOfAReactionThatMayRaiseTheFlag) {
  const ModeReport report = mode_report(
      verified("tasks:\n"
               "  light: {component: tool}\n"
               "  heavy: {component: tool}\n"
               "  arm: {component: arm, on_miss: {switch: b}}\n"
               "  user: {component: user}\n"
               "configurations: {a: [light, arm, user], b: [heavy, arm, user]}\n"
               "start: a\n"),
      library());
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_EQ(report.warnings[1],
            "on_miss of arm asks for configuration 'b': from 'a' that is slow, under the flag, unless the values are "
            "the same of constant 'mass'");
  EXPECT_TRUE(report.is_accepted());
  EXPECT_TRUE(edge(report, "a", "b").has_reaction());
}

TEST(ModeReport, JudgesTakeoversAndTheSwitchesAfterThem) {
  const Configuration made = verified(
      "rtpus: {first: {cpu: 0}, second: {cpu: 1}}\n"
      "tasks:\n"
      "  main: {component: source, rtpu: first, rate: 100 Hz, budget: 9 ms}\n"
      "  spare: {component: source, rtpu: second, rate: 100 Hz, budget: 1 ms, standby_for: main}\n"
      "  user: {component: sink, rtpu: second, rate: 100 Hz, budget: 1 ms}\n"
      "  loud: {component: sink, rtpu: second, rate: 100 Hz, budget: 1 ms, on_overrun: {switch: run}}\n"
      "configurations: {run: [main, user], both: [main, user, loud]}\n"
      "start: run\n");
  const ModeReport report = mode_report(made, library());
  ASSERT_EQ(report.nodes.size(), 4u);
  EXPECT_EQ(report.nodes[2].name, "run with spare for main");
  EXPECT_EQ(report.edges.size(), 2u + 2u + 4u);
  const ModeEdge& takeover = edge(report, "run", "run with spare for main");
  EXPECT_EQ(takeover.way(), ModeWay::kTakeover);
  ASSERT_EQ(takeover.cpus.size(), 2u);
  EXPECT_EQ(takeover.cpus[1].guarantee, Guarantee::kYes);
  EXPECT_EQ(edge(report, "run with spare for main", "run").way(), ModeWay::kFast);
  const ModeEdge& asked = edge(report, "both with spare for main", "run");
  ASSERT_EQ(asked.askers.size(), 1u);
  EXPECT_EQ(asker_text(made, asked.askers[0]), "on_overrun of loud");
  EXPECT_TRUE(edge(report, "run with spare for main", "both").askers.empty());
}

TEST(ModeReport, TakeoverThatMayMissIsNoRefusal) {
  const Configuration made = verified(
      "rtpus: {first: {cpu: 0}, second: {cpu: 1}}\n"
      "tasks:\n"
      "  main: {component: source, rtpu: first, rate: 100 Hz, budget: 9 ms}\n"
      "  spare: {component: source, rtpu: second, rate: 100 Hz, budget: 4 ms, standby_for: main}\n"
      "  user: {component: sink, rtpu: second, rate: 200 Hz, budget: 2500 us}\n"
      "configurations: {run: [main, user]}\n"
      "start: run\n");
  const ModeReport report = mode_report(made, library());
  const ModeEdge& takeover = edge(report, "run", "run with spare for main");
  EXPECT_EQ(takeover.cpus.at(1).guarantee, Guarantee::kNo);
  EXPECT_EQ(takeover.way(), ModeWay::kTakeover);
  EXPECT_TRUE(report.is_accepted());
}

TEST(ModeReport, AResourceThatChangesHandsIsSlowAndWarnedOf) {
  const Configuration made = verified(
      "tasks:\n  one: {component: device, resources: {tty: a}, on_fault: {switch: second}}\n"
      "  two: {component: device, resources: {tty: a}}\n"
      "  other: {component: device, resources: {tty: b}}\n  user: {component: sink}\n"
      "configurations: {first: [one, user], second: [two, user], third: [other, user]}\n");
  const ModeReport report = mode_report(made, library());
  const ModeEdge& there = edge(report, "first", "second");
  EXPECT_EQ(there.way(), ModeWay::kSlow);
  ASSERT_EQ(there.resources.size(), 1u);
  EXPECT_EQ(there.resources[0].text, "a");
  EXPECT_EQ(made.tasks()[there.resources[0].before].name, "one");
  EXPECT_EQ(made.tasks()[there.resources[0].after].name, "two");
  EXPECT_EQ(edge(report, "first", "third").way(), ModeWay::kFast);
  EXPECT_TRUE(report.is_accepted()) << "no deadline is at stake";
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0], "on_fault of one asks for configuration 'second': from 'first' that is slow, under the "
                                "flag, because resource 'a' changes hands");
}

}  // namespace
}  // namespace chimera
