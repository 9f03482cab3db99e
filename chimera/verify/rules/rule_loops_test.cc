// SPDX-License-Identifier: Apache-2.0
// Compares the orders of tasks with direct statements of the rules, on random graphs with loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

enum class Initial : std::uint8_t { kByDescription, kByComponent, kNone };

struct Graph {
  struct Arc {
    std::size_t from, to, variable;
  };
  std::vector<std::vector<std::size_t>> inputs;  ///< of each task, by number of the variable
  std::vector<std::vector<std::size_t>> outputs;
  std::vector<bool> has_resource;
  std::vector<std::string> names;     ///< of the variables
  std::vector<Initial> initial;       ///< of the variables
  std::vector<std::size_t> producer;  ///< of the variables
};

Graph random_graph(std::mt19937& random, bool with_bare) {
  Graph graph;
  const std::size_t n = 2 + random() % 7;
  graph.inputs.resize(n);
  graph.outputs.resize(n);
  for (std::size_t t = 0; t < n; ++t) {
    graph.has_resource.push_back(random() % 3 == 0);
    for (std::size_t k = random() % 3; k > 0; --k) {
      graph.outputs[t].push_back(graph.names.size());
      graph.names.push_back(std::string(1, static_cast<char>('a' + random() % 26)) +
                            std::to_string(graph.names.size()));
      graph.initial.push_back(random() % 2 == 0                 ? Initial::kByDescription
                              : !with_bare || random() % 2 == 0 ? Initial::kByComponent
                                                                : Initial::kNone);
      graph.producer.push_back(t);
    }
  }
  for (std::size_t t = 0; t < n; ++t)
    for (std::size_t v = 0; v < graph.names.size(); ++v)
      if (random() % 3 == 0) graph.inputs[t].push_back(v);
  return graph;
}

Library components(const Graph& graph) {
  std::vector<Descriptor> made;
  for (std::size_t t = 0; t < graph.inputs.size(); ++t) {
    Descriptor d;
    d.name = "m" + std::to_string(t);
    d.default_rate_hz = 100;
    d.methods[CHIMERA_CYCLE] = true;
    if (graph.has_resource[t]) {
      d.ports.push_back({.name = "line", .kind = CHIMERA_RESOURCE, .type = CHIMERA_STRING, .element_size = 256});
    }
    for (const std::size_t v : graph.inputs[t])
      d.ports.push_back({.name = "in_" + graph.names[v], .kind = CHIMERA_IN_VAR});
    for (const std::size_t v : graph.outputs[t]) {
      d.ports.push_back({.name = "out_" + graph.names[v], .kind = CHIMERA_OUT_VAR});
      if (graph.initial[v] == Initial::kByComponent) d.ports.back().initial.resize(8);
    }
    const auto completed = complete(d);
    EXPECT_TRUE(completed) << (completed ? "" : completed.error().message.c_str());
    made.push_back(d);
  }
  return Library::of(std::move(made), our_units());
}

std::string described(const Graph& graph) {
  std::string text = "subsystem: demo\ntasks:\n";
  for (std::size_t t = 0; t < graph.inputs.size(); ++t) {
    std::string alias, initial;
    for (const std::size_t v : graph.inputs[t]) alias += "in_" + graph.names[v] + ": " + graph.names[v] + ", ";
    for (const std::size_t v : graph.outputs[t]) {
      alias += "out_" + graph.names[v] + ": " + graph.names[v] + ", ";
      if (graph.initial[v] == Initial::kByDescription) initial += "out_" + graph.names[v] + ": 0, ";
    }
    text += "  m" + std::to_string(t) + ": {alias: {" + alias + "}, initial: {" + initial + "}" +
            (graph.has_resource[t] ? ", resources: {line: x}" : "") + "}\n";
  }
  return text;
}

std::vector<Graph::Arc> arcs_of(const Graph& graph) {
  std::vector<Graph::Arc> arcs;
  for (std::size_t v = 0; v < graph.names.size(); ++v)
    for (std::size_t t = 0; t < graph.inputs.size(); ++t)
      for (const std::size_t input : graph.inputs[t])
        if (input == v) arcs.push_back({graph.producer[v], t, v});
  return arcs;
}

/// The rule as docs/formats/description.md states it, without stored state between steps.
class Plain {
 public:
  explicit Plain(const Graph& graph) : graph_(graph), arcs_(arcs_of(graph)), placed_(graph.inputs.size(), false) {}
  std::vector<std::string> order() {
    std::vector<std::string> names;
    while (names.size() < placed_.size()) {
      const std::size_t next = ready();
      if (next == placed_.size()) {
        cut();
        continue;
      }
      placed_[next] = true;
      names.push_back("m" + std::to_string(next));
    }
    return names;
  }
  /// Number of loops without an initial value; loops that share a task count once.
  std::size_t bare_loops() {
    std::erase_if(arcs_, [this](const Graph::Arc& arc) { return graph_.initial[arc.variable] != Initial::kNone; });
    std::size_t n = 0;
    std::vector<bool> told(placed_.size(), false);
    for (const Graph::Arc& arc : arcs_) {
      if (!is_one_loop(arc.from, arc.to) || told[arc.from]) continue;
      ++n;
      for (std::size_t t = 0; t < told.size(); ++t)
        if (is_one_loop(arc.from, t)) told[t] = true;
    }
    return n;
  }

 private:
  bool reaches(std::size_t from, std::size_t to) const {
    std::vector<std::size_t> queue{from};
    std::vector<bool> seen(placed_.size(), false);
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const Graph::Arc& arc : arcs_)
        if (arc.from == queue[i] && !placed_[arc.from] && !seen[arc.to]) {
          seen[arc.to] = true;
          queue.push_back(arc.to);
        }
    return from == to || seen[to];
  }
  bool is_one_loop(std::size_t a, std::size_t b) const { return reaches(a, b) && reaches(b, a); }
  std::size_t ready() const {
    std::size_t best = placed_.size();
    for (std::size_t t = 0; t < placed_.size(); ++t) {
      const auto feeds = [&](const Graph::Arc& arc) { return arc.to == t && !placed_[arc.from]; };
      if (placed_[t] || std::any_of(arcs_.begin(), arcs_.end(), feeds)) continue;
      if (graph_.has_resource[t] && graph_.inputs[t].empty()) return t;
      if (best == placed_.size()) best = t;
    }
    return best;
  }
  bool is_fed(std::size_t task) const {
    return std::any_of(arcs_.begin(), arcs_.end(), [&](const Graph::Arc& arc) {
      return !placed_[arc.from] && is_one_loop(arc.to, task) && !is_one_loop(arc.from, task);
    });
  }
  auto rank(const Graph::Arc& arc) const {
    return std::tuple(graph_.initial[arc.variable], graph_.names[arc.variable]);
  }
  void cut() {
    std::vector<Graph::Arc> candidates;
    for (const Graph::Arc& arc : arcs_)
      if (!placed_[arc.from] && is_one_loop(arc.from, arc.to) && !is_fed(arc.from)) candidates.push_back(arc);
    ASSERT_FALSE(candidates.empty());
    Graph::Arc best = candidates[0];
    for (const Graph::Arc& arc : candidates)
      if (rank(arc) < rank(best)) best = arc;
    std::vector<Graph::Arc> left;
    for (const Graph::Arc& arc : arcs_)
      if (arc.variable != best.variable || !is_one_loop(arc.to, best.from)) left.push_back(arc);
    arcs_ = left;
  }

  const Graph& graph_;
  std::vector<Graph::Arc> arcs_;
  std::vector<bool> placed_;
};

TEST(RuleLoops, OrdersRandomGraphsAsThePlainRuleDoes) {
  const unsigned seed = 20261122;
  std::mt19937 random(seed);
  std::size_t cuts = 0;
  for (int round = 0; round < 150; ++round) {
    const Graph graph = random_graph(random, false);
    const std::string text = described(graph);
    const std::string shown = "seed " + std::to_string(seed) + ", round " + std::to_string(round) + "\n" + text;
    const Verdict verdict = verify(read_description(text, "random"), components(graph));
    ASSERT_TRUE(verdict.configuration) << shown << verdict.report.text();
    std::vector<std::string> found;
    for (const TaskId task : verdict.configuration->sets()[0].order)
      found.push_back(verdict.configuration->tasks()[task.index].name);
    ASSERT_EQ(found, Plain(graph).order()) << shown;
    Graph bare = graph;
    bare.initial.assign(bare.initial.size(), Initial::kNone);
    cuts += Plain(bare).bare_loops();
  }
  EXPECT_GT(cuts, 100u) << "hardly a graph has a loop: the test says little";
}

TEST(RuleLoops, NamesEachLoopWithoutInitialValueOnce) {
  const unsigned seed = 20261123;
  std::mt19937 random(seed);
  std::size_t told = 0;
  for (int round = 0; round < 300; ++round) {
    const Graph graph = random_graph(random, true);
    const std::string text = described(graph);
    const Verdict verdict = verify(read_description(text, "random"), components(graph));
    const std::size_t expected = Plain(graph).bare_loops();
    ASSERT_EQ(verdict.report.errors(), expected) << "round " << round << "\n" << text << verdict.report.text();
    told += expected;
  }
  EXPECT_GT(told, 60u);
}

TEST(RuleCycles, RunsAReaderFirstOnlyWhereItCutsALoop) {
  std::mt19937 random(20261128);
  std::size_t cuts = 0;
  for (int round = 0; round < 300; ++round) {
    const Graph graph = random_graph(random, false);
    const std::string text = described(graph);
    const Verdict verdict = verify(read_description(text, "random"), components(graph));
    ASSERT_TRUE(verdict.configuration) << text << verdict.report.text();
    const std::span<const TaskSpec> tasks = verdict.configuration->spec().tasks;
    const std::vector<Graph::Arc> arcs = arcs_of(graph);
    const auto is_forward = [&](const Graph::Arc& arc) { return tasks[arc.from].place < tasks[arc.to].place; };
    const auto is_given = [&](const Graph::Arc& arc) { return graph.initial[arc.variable] == Initial::kByDescription; };
    for (const Graph::Arc& arc : arcs) {
      if (arc.from == arc.to || is_forward(arc)) continue;
      ++cuts;
      std::vector<bool> is_behind(tasks.size());  // the reader, by links that run forward
      is_behind[arc.to] = true;
      for (std::size_t step = 0; step < tasks.size(); ++step)
        for (const Graph::Arc& each : arcs)
          if (is_behind[each.from] && is_forward(each) && (is_given(arc) || !is_given(each))) is_behind[each.to] = true;
      ASSERT_TRUE(is_behind[arc.from]) << graph.names[arc.variable] << " is read too early\n" << text;
    }
  }
  EXPECT_GT(cuts, 300u);
}

}  // namespace
}  // namespace chimera
