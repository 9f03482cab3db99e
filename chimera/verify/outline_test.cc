// SPDX-License-Identifier: Apache-2.0
// The outline of descriptions with faults: what the text says is shown, and what a fault parts is marked.
#include "chimera/verify/outline.h"

#include <gtest/gtest.h>

#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/testing/sample_component.h"

namespace chimera {
namespace {

const Library& drawn_library() {
  static const Library kLibrary = [] {
    PortDescriptor gain{.name = "gain", .unit = "1", .kind = CHIMERA_IN_CONST};
    gain.initial.resize(8);
    return Library::of({sample_component("source", {{.name = "angle", .unit = "rad", .kind = CHIMERA_OUT_VAR}}),
                        sample_component("sink", {{.name = "angle", .unit = "rad"}, gain}),
                        sample_component("counter", {{.name = "angle", .type = CHIMERA_INT64}}),
                        sample_component("mix", {{.name = "in", .unit = "U", .repeated = true, .max_instances = 4},
                                          {.name = "out", .unit = "U", .kind = CHIMERA_OUT_VAR}})},
                       our_units());
  }();
  return kLibrary;
}

Json outline_for(const std::string& text) {
  const Outlined outlined = verify_with_outline(read_description(text, "a.yaml"), drawn_library());
  return outlined.outline ? outline_json(*outlined.outline) : Json();
}

TEST(Outline, IsNoneForATextThatIsNoTree) { EXPECT_TRUE(outline_for("tasks: [").is_null()); }

TEST(Outline, ShowsTheLinkThatAClashOfTypesParts) {
  const Json of = outline_for("subsystem: a\ntasks: {source: , counter: }\n");
  const Json& port = of["tasks"][1]["ports"][0];
  EXPECT_EQ(port["variable"], "angle");
  EXPECT_EQ(port["parted"], true);
  EXPECT_EQ(of["variables"][0]["producers"].dump(), R"([{"port":"angle","task":"source"}])");
  EXPECT_EQ(of["variables"][0]["consumers"].dump(), R"([{"port":"angle","task":"counter"}])");
}

TEST(Outline, ShowsAnInputWithoutAProducer) {
  const Json of = outline_for("subsystem: a\ntasks: {sink: {alias: {angle: q_ref}, constants: {gain: 2}}}\n");
  const Json& ports = of["tasks"][0]["ports"];
  EXPECT_EQ(ports[0]["variable"], "q_ref");
  EXPECT_EQ(ports[0]["parted"], true);
  EXPECT_EQ(ports[0]["unit"], "rad");
  EXPECT_EQ(ports[1]["value"], "2");
  EXPECT_EQ(ports[1]["default"], "0");
  EXPECT_EQ(of["variables"][0]["variable"], "q_ref");
  EXPECT_TRUE(of["variables"][0]["origin"].is_null());
}

TEST(Outline, ShowsATaskOfAnUnknownComponentWithoutPorts) {
  const Json of = outline_for("subsystem: a\ntasks: {sourc: {rate: 50 Hz, budget: 1 ms, criticality: high}}\n");
  const Json& task = of["tasks"][0];
  EXPECT_EQ(task["known"], false);
  EXPECT_EQ(task["rate_hz"], 50);
  EXPECT_EQ(task["budget_ns"], 1'000'000);
  EXPECT_EQ(task["criticality"], "high");
  EXPECT_EQ(task["ports"].size(), 0u);
  EXPECT_EQ(of["configurations"].dump(), R"([{"configuration":"all","safe_when":null,"tasks":["sourc"]}])");
  EXPECT_EQ(of["start"], "all");
}

TEST(Outline, NamesUnsolvedUnitsAsDeclaredAndCountsInstances) {
  const Json none = outline_for("subsystem: a\ntasks: {mix: }\n")["tasks"][0];
  EXPECT_EQ(none["ports"].size(), 1u);
  EXPECT_EQ(none["ports"][0]["unit"], "U");
  EXPECT_EQ(none["ports"][0]["solved"], false);
  EXPECT_EQ(none["repeated"][0]["instances"], 0);
  EXPECT_EQ(none["repeated"][0]["max_instances"], 4);
  const Json two = outline_for("subsystem: a\ntasks: {source: , mix: {alias: {in: [angle, angle]}}}\n")["tasks"][1];
  EXPECT_EQ(two["ports"][1]["port"], "in[1]");
  EXPECT_EQ(two["ports"][1]["declared"], "in");
  EXPECT_EQ(two["ports"][2]["unit"], "rad");
  EXPECT_EQ(two["repeated"][0]["instances"], 2);
}

TEST(Outline, HasTheLineOfEachTask) {
  const Json of = outline_for("subsystem: a\ntasks:\n  source:\n\n  sink: {rate: 1 Hz}\n");
  EXPECT_EQ(of["tasks"][0]["line"], 3);
  EXPECT_EQ(of["tasks"][1]["line"], 5);
}

TEST(Outline, KeepsTheWordsOfEachStepAlsoOfFaultyOnes) {
  const Json of = outline_for("subsystem: a\ntasks: {source: }\nconfigurations: {run: [source]}\n"
                              "sequence:\n  repeat: true\n  steps:\n"
                              "    - {switch: rn, until: 'angle > 1 rad', within: 2 s, else: 7, confirm: true}\n"
                              "    - run\n"
                              "    - {name: [a, 'b'], switch: , for: 0 s, reentry: on}\n")["sequence"];
  EXPECT_EQ(of["line"], 4);
  EXPECT_EQ(of["path"], "sequence/steps");
  EXPECT_EQ(of["repeat"], true);
  EXPECT_EQ(of["steps"].dump(),
            R"([{"confirm":true,"else":"7","for":null,"name":null,"number":1,"reentry":false,"switch":"rn",)"
            R"("until":"angle > 1 rad","within":"2 s"},)"
            R"({"confirm":false,"else":null,"for":null,"name":null,"number":2,"reentry":false,"switch":null,)"
            R"("until":null,"within":null},)"
            R"({"confirm":false,"else":null,"for":"0 s","name":"[a, \"b\"]","number":3,"reentry":false,)"
            R"("switch":null,"until":null,"within":null}])");
}

TEST(Outline, ShowsEachFormOfASequence) {
  const std::string text = "subsystem: a\ntasks: {source: }\n";
  EXPECT_TRUE(outline_for(text)["sequence"].is_null());
  const std::pair<const char*, const char*> forms[] = {
      {"sequence: [a]\n", "sequence 1"},       {"sequence: a\n", "sequence 0"},
      {"sequence:\n", "sequence 0"},           {"sequence: {repeat: true}\n", "sequence/steps 0"},
      {"sequence: {steps: {a: 1}}\n", "sequence/steps 0"}};
  for (const auto& [form, shown] : forms) {
    const Json of = outline_for(text + form)["sequence"];
    EXPECT_EQ(of["path"].as_string() + " " + std::to_string(of["steps"].size()), shown) << form;
  }
}

/// The ports that an act gets from the outline of `text`: "task.port ".
std::string named(EditAct act, const std::string& text) {
  name_ports(act, *verify_with_outline(read_description(text, "a.yaml"), drawn_library()).outline);
  std::string all;
  const auto* rename = std::get_if<RenameKey>(&act);
  for (const TaskPort& each : rename != nullptr ? rename->ports : std::get<JoinProducers>(act).producers)
    all += each.task + '.' + each.port + ' ';
  return all;
}

TEST(Outline, NamesThePortsThatAnActLeavesOut) {
  const std::string text =
      "subsystem: a\ntasks:\n  source:\n  other: {component: source}\n  sink: {constants: {gain: 1}}\n"
      "  free: {component: sink, alias: {angle: angle}}\n  far: {component: sink, alias: {angle: q}}\n"
      "constants: {gain: 2}\noperator: {q: 1 rad}\n";
  EXPECT_EQ(named(RenameKey{{"variables", "angle"}, "b", {}, true}, text),
            "source.angle other.angle sink.angle free.angle ");
  EXPECT_EQ(named(RenameKey{{"constants", "gain"}, "b", {}, true}, text), "free.gain far.gain ");
  EXPECT_EQ(named(RenameKey{{"operator", "q"}, "b", {}, true}, text), "");
  EXPECT_EQ(named(RenameKey{{"tasks", "angle"}, "b", {}, true}, text), "");
  EXPECT_EQ(named(RenameKey{{"variables", "angle"}, "b", {}, false}, text), "");
  EXPECT_EQ(named(JoinProducers{"angle", JoinBy::kMean, {}, true}, text), "source.angle other.angle ");
  EXPECT_EQ(named(JoinProducers{"nothing", JoinBy::kMean, {}, true}, text), "");
}

TEST(Outline, ShowsValuesOfTheFileAndOfTheOperatorWithTheirText) {
  const Json of = outline_for(
      "subsystem: a\nrtpus: {servo: {cpu: 1, policy: muf, executor: preemptive}}\n"
      "tasks: {sink: }\noperator: {angle: 1 deg}\nconstants: {gain: [1, 2]}\n"
      "configurations: {run: {tasks: [sink], safe_when: 'angle < 1 rad'}}\n");
  EXPECT_EQ(of["variables"][0]["origin"], "constants");
  EXPECT_EQ(of["variables"][0]["value"], "[1, 2]");
  EXPECT_EQ(of["variables"][1]["origin"], "operator");
  EXPECT_EQ(of["variables"][1]["value"], "1 deg");
  EXPECT_EQ(of["configurations"][0]["safe_when"], "angle < 1 rad");
  EXPECT_EQ(of["rtpus"].dump(), R"([{"cpu":1,"executor":"preemptive","policy":"muf","rtpu":"servo"}])");
}

}  // namespace
}  // namespace chimera
