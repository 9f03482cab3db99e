// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/files/check.h"

#include "chimera/cli/files/testing/test_place.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

CommandResult checked(const std::string& text, bool json = false, const std::string& graph = "") {
  const TestFile file(text);
  CommandResult output = check({file.path(), json, graph}, test_place());
  for (std::string* said : {&output.out, &output.err})
    for (std::size_t at; (at = said->find(file.path())) != std::string::npos;)
      said->replace(at, file.path().size(), "FILE");
  return output;
}

TEST(Check, ALegalDescriptionEarnsItsVerdict) {
  const CommandResult output = checked(kCounterText);
  EXPECT_EQ(output.code, kOk);
  EXPECT_EQ(output.err, "");
  EXPECT_EQ(output.out,
            "small: legal. 1 task, 7 state variables, 0 constants, 1 configuration\n"
            "  all (start): counter\n"
            "  rtpu main on cpu 0: no budgets stated, so the load is not judged\n");
}

TEST(Check, PrintsTheLoadOfStatedBudgets) {
  const CommandResult output = checked("subsystem: s\ntasks:\n  a: {component: t_counter, budget: 250 us}\n");
  EXPECT_NE(output.out.find("rtpu main on cpu 0: budgets take 0.250 of at most 0.93\n"), std::string::npos)
      << output.out << output.err;
}

TEST(Check, PrintsTheGreatestLoadThatASwitchMayLeadTo) {
  const std::string rivals =
      "subsystem: s\nrtpus: {main: {}, spare: {cpu: 1}}\ntasks:\n"
      "  a: {component: t_counter, budget: 250 us}\n"
      "  b: {component: t_counter, budget: 700 us}\n"
      "  c: {component: t_counter, budget: 100 us, rtpu: spare}\n"
      "configurations: {light: [a], heavy: [b], other: [c]}\n";
  const CommandResult output = checked(rivals);
  EXPECT_NE(output.out.find("rtpu main on cpu 0: budgets take 0.250 of at most 0.93, 0.700 in configuration 'heavy'\n"
                            "  rtpu spare on cpu 1: budgets take 0.000 of at most 0.93, 0.100 in configuration "
                            "'other'\n"),
            std::string::npos)
      << output.out << output.err;
}

TEST(Check, CountsTheFaultsOnStandardError) {
  const CommandResult output = checked("subsystem: small\ntasks:\n  counter: {component: t_countr}\n");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(output.out, "");
  EXPECT_EQ(output.err.rfind("FILE:3:", 0), 0u) << output.err;
  EXPECT_NE(output.err.find("t_counter"), std::string::npos) << output.err;
  EXPECT_EQ(output.err.substr(output.err.size() - 8), "1 error\n");
}

TEST(Check, JsonOffersTheEditOfARemedy) {
  const Json report = Json::parse(checked("subsystem: small\ntasks:\n  counter: {component: t_countr}\n", true).out);
  EXPECT_EQ(report["faults"][0]["task"], "counter");
  EXPECT_EQ(report["faults"][0]["offers"][0]["acts"].dump(),
            R"([{"act":"set","path":"tasks/counter/component","value":"t_counter"}])");
}

TEST(Check, JsonStandsAloneOnStandardOutput) {
  const CommandResult output = checked(kCounterText, true);
  EXPECT_EQ(output.code, kOk);
  EXPECT_EQ(output.err, "");
  EXPECT_EQ(output.out,
            "{\"file\": \"FILE\", \"legal\": true, \"errors\": 0, \"warnings\": 0, \"faults\": [], \"notes\": []}\n");
}

TEST(Check, RefusesAFileThatIsNotThereAndAnEmptyOne) {
  EXPECT_EQ(check({"/nowhere/a.yaml", false, ""}, test_place()).code, kRefused);
  EXPECT_EQ(checked("").code, kRefused);
}

TEST(Check, DrawsInsteadOfJudging) {
  EXPECT_EQ(checked(kCounterText, false, "dot").out.rfind("digraph", 0), 0u);
  EXPECT_EQ(checked(kCounterText, false, "svg").out.rfind("<svg", 0), 0u);
  EXPECT_NE(checked(kCounterText, false, "text").out.find("counter"), std::string::npos);
}

// heavy and late meet in the transition; light replaces heavy like for like.
constexpr const char* kModes = R"(subsystem: modes
rtpus: {main: {cpu: 1}}
tasks:
  a: {component: t_counter, rate: 100 Hz, budget: 8 ms, on_miss: {switch: light}}
  b: {component: t_counter, rate: 100 Hz, budget: 8 ms, offset: 9 ms}
  c: {component: t_counter, rate: 100 Hz, budget: 1 ms}
configurations: {heavy: [a], late: [b], light: [c]}
start: heavy
)";

CommandResult modes_of(std::string text, const std::string& instead = "", const std::string& of = "",
                       bool json = false) {
  if (const std::size_t at = of.empty() ? std::string::npos : text.find(of); at != std::string::npos)
    text.replace(at, of.size(), instead);
  const TestFile file(text);
  CommandResult output = check({.file = file.path(), .json = json, .graph = "", .modes = true}, test_place());
  for (std::size_t at; (at = output.err.find(file.path())) != std::string::npos;)
    output.err.replace(at, file.path().size(), "FILE");
  return output;
}

TEST(CheckModes, JudgesEachSwitchAndNamesItsRequesters) {
  const CommandResult output = modes_of(kModes);
  EXPECT_EQ(output.code, kOk);
  EXPECT_EQ(output.err, "");
  EXPECT_EQ(output.out,
            "heavy -> late: slow; asked for by an operator\n"
            "  CPU 1: not schedulable: a cycle of task 'a' may take 40 ms, its deadline is 10 ms\n"
            "heavy -> light: fast; asked for by on_miss of a, an operator\n"
            "  CPU 1: schedulable; what was released before has ended 8 ms after the change\n"
            "late -> heavy: slow; asked for by an operator\n"
            "  CPU 1: not schedulable: a cycle of task 'a' may take 40 ms, its deadline is 10 ms\n"
            "late -> light: fast; asked for by an operator\n"
            "  CPU 1: schedulable; what was released before has ended 9 ms after the change\n"
            "light -> heavy: fast; asked for by an operator\n"
            "  CPU 1: schedulable; what was released before has ended 8 ms after the change\n"
            "light -> late: fast; asked for by an operator\n"
            "  CPU 1: schedulable; what was released before has ended 9 ms after the change\n"
            "unreachable except by an operator: late\n");
}

TEST(CheckModes, AReactionWithASlowSwitchIsAFault) {
  const CommandResult output = modes_of(kModes, "{switch: late}", "{switch: light}");
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(output.out.rfind("heavy -> late: slow; asked for by on_miss of a, an operator\n", 0), 0u) << output.out;
  EXPECT_NE(output.out.find("unreachable except by an operator: light\n"), std::string::npos) << output.out;
}

TEST(CheckModes, WarnsOfATaskThatGoesOnWhereItsFailureLeads) {
  const CommandResult output = modes_of(R"(subsystem: modes
tasks:
  a: {component: t_counter, rate: 100 Hz, budget: 1 ms, on_miss: {switch: both}, on_fault: {switch: both}}
  b: {component: t_source, rate: 10 Hz, budget: 1 ms}
configurations: {alone: [a], both: [a, b], other: [b]}
start: alone
)");
  EXPECT_EQ(output.code, kOk);
  EXPECT_EQ(output.err,
            "FILE: warning: on_miss of a asks for configuration 'both', which contains the task itself: it goes on "
            "there as it is\n"
            "FILE: warning: on_fault of a asks for configuration 'both', which contains the task itself: in ERROR it "
            "cannot be part of it, so the switch is refused\n");
  EXPECT_EQ(output.out.rfind("alone -> both: fast; asked for by on_miss of a, on_fault of a, an operator\n", 0), 0u);
}

TEST(CheckModes, NamesTheRequesterOfTasksThatLeadToAConfiguration) {
  const CommandResult output = modes_of(R"(subsystem: modes
tasks:
  asker: {component: t_asker, rate: 100 Hz, budget: 1 ms, constants: {first: --on two, second: --off one}}
  one: {component: gain, rate: 100 Hz, budget: 1 ms, alias: {x: given, y: level}, constants: {k: 1}}
  two: {component: gain, rate: 100 Hz, budget: 1 ms, alias: {x: given, y: level}, constants: {k: 1}}
  reader: {component: gain, rate: 100 Hz, budget: 1 ms, alias: {x: level, y: seen}, constants: {k: 1}}
operator: {wish: 0, given: 5}
configurations: {low: [asker, one, reader], high: [asker, two, reader]}
start: low
)");
  EXPECT_EQ(output.code, kOk);
  EXPECT_EQ(output.out.rfind("low -> high: fast; asked for by constant first of asker, constant second of asker", 0),
            0u)
      << output.out;
  EXPECT_EQ(output.out.find("constant none"), std::string::npos) << output.out;
  EXPECT_EQ(output.err, "") << output.err;
}

TEST(CheckModes, NamesTasksWithoutABudgetAndReactionsWithoutATarget) {
  const CommandResult output = modes_of(kModes, "c: {component: t_counter, rate: 100 Hz}",
                                        "c: {component: t_counter, rate: 100 Hz, budget: 1 ms}");
  EXPECT_NE(output.out.find("heavy -> light: fast; asked for by on_miss of a, an operator\n"
                            "  CPU 1: not judged whole: task 'c' has no budget"),
            std::string::npos)
      << output.out;
  EXPECT_EQ(modes_of(kCounterText).out, "small has one configuration: there is nothing to switch to\n");
  EXPECT_EQ(modes_of("subsystem: small\ntasks:\n  counter: {component: t_countr}\n").code, kRefused);
}

TEST(CheckModes, AsJsonHasEveryKey) {
  const CommandResult output = modes_of(kModes, "", "", true);
  EXPECT_EQ(output.err, "");
  const std::string begin =
      "{\"subsystem\":\"modes\",\"accepted\":true,\"configurations\":[{\"name\":\"heavy\",\"start\":true},"
      "{\"name\":\"late\",\"start\":false},{\"name\":\"light\",\"start\":false}],\"takeovers\":[],\"transitions\":["
      "{\"from\":\"heavy\",\"to\":\"late\",\"asked_by\":[],\"legal\":true,\"way\":\"slow\",\"cpus\":[{\"cpu\":1,"
      "\"schedulable\":\"no\",\"task\":\"a\",\"takes_ns\":40000000,\"settled_ns\":40000000,\"promised_before\":true}],"
      "\"constants\":[],\"resources\":[],\"initialised_anew\":[]},"
      "{\"from\":\"heavy\",\"to\":\"light\",\"asked_by\":[{\"cause\":\"on_miss\",\"task\":\"a\",\"constant\":null}],"
      "\"legal\":true,\"way\":\"fast\",\"cpus\":[{\"cpu\":1,\"schedulable\":\"yes\",\"task\":null,\"takes_ns\":null,"
      "\"settled_ns\":8000000,\"promised_before\":true}],\"constants\":[],\"resources\":[],"
      "\"initialised_anew\":[]},";
  EXPECT_EQ(output.out.substr(0, begin.size()), begin);
  const std::string end = "],\"by_operator_only\":[\"late\"],\"warnings\":[]}\n";
  EXPECT_EQ(output.out.substr(output.out.size() - end.size()), end);
}

}  // namespace
}  // namespace chimera::cli
