// SPDX-License-Identifier: Apache-2.0
// Compares the verifier with the two set equations of the 1994 paper, on random graphs.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

constexpr unsigned kVariables = 5;

/// X and Y of a module, one bit per variable.
struct Module {
  unsigned inputs = 0, outputs = 0;
};

struct RandomGraph {
  std::vector<Module> modules;
  unsigned operated = 0;
  std::vector<unsigned> sets;  ///< one bit per module
};

RandomGraph random_graph(std::mt19937& random) {
  const auto sparse = [&] { return static_cast<unsigned>(random() & random()) % (1u << kVariables); };
  RandomGraph graph;
  graph.modules.resize(1 + random() % 5);
  for (Module& module : graph.modules) module = {sparse(), sparse() & sparse()};
  graph.operated = sparse() & sparse();
  graph.sets.resize(1 + random() % 3);
  for (unsigned& set : graph.sets) set = 1 + static_cast<unsigned>(random()) % ((1u << graph.modules.size()) - 1);
  return graph;
}

/// Equation 1 over one set, with the operator as one more module: Y_i and Y_j are disjoint.
bool outputs_are_disjoint(const RandomGraph& graph, unsigned set) {
  for (std::size_t i = 0; i < graph.modules.size(); ++i) {
    if (!(set >> i & 1)) continue;
    if (graph.modules[i].outputs & graph.operated) return false;
    for (std::size_t j = 0; j < i; ++j)
      if ((set >> j & 1) && (graph.modules[i].outputs & graph.modules[j].outputs)) return false;
  }
  return true;
}

/// Equation 2: the union of X is a subset of the union of Y.
bool inputs_are_met(const RandomGraph& graph, unsigned set) {
  unsigned x = 0, y = graph.operated;
  for (std::size_t i = 0; i < graph.modules.size(); ++i)
    if (set >> i & 1) x |= graph.modules[i].inputs, y |= graph.modules[i].outputs;
  return (x & ~y) == 0;
}

std::string letter(unsigned variable) { return "v" + std::to_string(variable); }

Library components_of(const RandomGraph& graph) {
  std::vector<Descriptor> out;
  for (std::size_t i = 0; i < graph.modules.size(); ++i) {
    Descriptor d;
    d.name = "m" + std::to_string(i);
    d.default_rate_hz = 100;
    d.methods[CHIMERA_CYCLE] = true;
    for (unsigned v = 0; v < kVariables; ++v) {
      if (graph.modules[i].inputs >> v & 1) d.ports.push_back({.name = "in_" + letter(v), .kind = CHIMERA_IN_VAR});
      if (graph.modules[i].outputs >> v & 1) {
        d.ports.push_back({.name = "out_" + letter(v), .kind = CHIMERA_OUT_VAR});
        d.ports.back().initial.resize(8);  // loops are another rule
      }
    }
    EXPECT_TRUE(complete(d));
    out.push_back(d);
  }
  return Library::of(std::move(out), our_units());
}

std::string text_of(const RandomGraph& graph) {
  std::string text = "subsystem: demo\ntasks:\n";
  for (std::size_t i = 0; i < graph.modules.size(); ++i) {
    text += "  m" + std::to_string(i) + ": {alias: {";
    for (unsigned v = 0; v < kVariables; ++v) {
      if (graph.modules[i].inputs >> v & 1) text += "in_" + letter(v) + ": " + letter(v) + ", ";
      if (graph.modules[i].outputs >> v & 1) text += "out_" + letter(v) + ": " + letter(v) + ", ";
    }
    text += "}}\n";
  }
  text += "operator: {";
  for (unsigned v = 0; v < kVariables; ++v)
    if (graph.operated >> v & 1) text += letter(v) + ": 0, ";
  text += "}\nconfigurations:\n";
  for (std::size_t s = 0; s < graph.sets.size(); ++s) {
    text += "  c" + std::to_string(s) + ": [";
    for (std::size_t i = 0; i < graph.modules.size(); ++i)
      if (graph.sets[s] >> i & 1) text += "m" + std::to_string(i) + ", ";
    text += "]\n";
  }
  return text;
}

TEST(VerifyOracle, AgreesWithTheSetEquationsOnRandomGraphs) {
  const unsigned seed = 20240611;
  std::mt19937 random(seed);
  unsigned legal = 0;
  for (int round = 0; round < 1000; ++round) {
    const RandomGraph graph = random_graph(random);
    bool disjoint = true, met = true;
    for (const unsigned set : graph.sets) {
      disjoint = disjoint && outputs_are_disjoint(graph, set);
      met = met && inputs_are_met(graph, set);
    }
    const std::string text = text_of(graph);
    const Verdict verdict = verify(read_description(text, "random"), components_of(graph));
    const std::string shown =
        "seed " + std::to_string(seed) + ", round " + std::to_string(round) + "\n" + text + verdict.report.text();
    ASSERT_EQ(verdict.configuration.has_value(), disjoint && met) << shown;
    ASSERT_EQ(verdict.report.has("two-producers") || verdict.report.has("operator-produced"), !disjoint) << shown;
    ASSERT_EQ(verdict.report.has("input-unmet"), !met) << shown;
    legal += verdict.configuration ? 1 : 0;
  }
  EXPECT_GT(legal, 100u) << "the graphs are nearly all illegal: the test says little";
  EXPECT_LT(legal, 900u);
}

}  // namespace
}  // namespace chimera
