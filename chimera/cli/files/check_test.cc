// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/files/check.h"

#include "chimera/cli/files/graph_of.h"
#include "chimera/cli/files/testing/test_place.h"

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

TEST(Check, TellsTheLoadOfStatedBudgets) {
  const CommandResult output = checked("subsystem: s\ntasks:\n  a: {component: t_counter, budget: 250 us}\n");
  EXPECT_NE(output.out.find("rtpu main on cpu 0: budgets take 0.250 of at most 0.93\n"), std::string::npos)
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

TEST(GraphOf, HasEveryTaskWithItsPortsAndRate) {
  const Library library = test_library();
  const Configuration configuration = test_configuration(
      "subsystem: s\ntasks:\n  a: {component: t_counter, rate: 50 Hz}\n  b: "
      "{component: t_counter, rate: 1 kHz, alias: {count: n, dt: d, now: w, deadline: l, cycles: c, "
      "dropped: o, illegal: i}}\n",
      library);
  const draw::Graph graph = graph_of(configuration);
  EXPECT_EQ(graph.title, "s");
  ASSERT_EQ(graph.boxes.size(), 2u);
  EXPECT_EQ(graph.boxes[0].rate, "50 Hz");
  EXPECT_EQ(graph.boxes[1].rate, "1 kHz");
  EXPECT_EQ(graph.boxes[1].component, "t_counter");
  ASSERT_EQ(graph.boxes[1].ports.size(), 7u);
  EXPECT_EQ(graph.boxes[1].ports[0].name, "count");
  EXPECT_EQ(graph.boxes[1].ports[0].variable, "n");
  EXPECT_EQ(graph.boxes[1].ports[0].kind, draw::PortKind::kOut);
}

}  // namespace
}  // namespace chimera::cli
