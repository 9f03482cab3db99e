// SPDX-License-Identifier: Apache-2.0
// Row 15: `check` of a generated application of 100 tasks, from text to configuration; and to the refusal of one in
// which every task is at fault.
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/library.h"
#include "chimera/verify/verify.h"

namespace {

using namespace chimera;

constexpr std::size_t kTasks = 100;

Library library() {
  const std::string units[] = {source_path("share/chimera/units.xml")};
  auto system = UnitSystem::load(units);
  if (!system) {
    std::fprintf(stderr, "%s\n", system.error().message.c_str());
    std::exit(1);
  }
  Descriptor filter;
  filter.name = "filter";
  filter.default_rate_hz = 1000;
  filter.methods[CHIMERA_CYCLE] = true;
  filter.ports = {{.name = "x", .unit = "U", .shape = "[n<=16]", .kind = CHIMERA_IN_VAR},
                  {.name = "bias", .unit = "U", .shape = "[n<=16]", .kind = CHIMERA_IN_VAR},
                  {.name = "gain", .kind = CHIMERA_IN_CONST},
                  {.name = "y", .unit = "U", .shape = "[n<=16]", .kind = CHIMERA_OUT_VAR},
                  {.name = "dy", .unit = "U/s", .shape = "[n<=16]", .kind = CHIMERA_OUT_VAR}};
  if (!complete(filter)) std::exit(1);
  return Library::of({filter}, *std::move(system));
}

/// A chain of generic filters: each unit and shape is solved from its neighbour, the longest way there is.
std::string application(const char* rate) {
  std::string text = "subsystem: chain\noperator: {y0: [1 rad, 2 rad, 3 rad], bias: 0 rad}\n";
  text += "constants: {gain: 2}\ntasks:\n";
  for (std::size_t i = kTasks; i > 0; --i) {
    const std::string n = std::to_string(i), before = std::to_string(i - 1);
    text += "  t" + n + ":\n    component: filter\n    rate: " + rate + "\n    budget: 5 us\n    criticality: high\n" +
            "    alias: {x: y" + before + ", y: y" + n + ", dy: dy" + n + "}\n    on_miss: hold\n" +
            "    initial: {y: 0 rad}\n";
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const Library components = library();
  const std::string good = application("1 kHz"), bad = application("1 km");
  const Verdict legal = verify(read_description(good, "chain.yaml"), components);
  const Verdict refused = verify(read_description(bad, "chain.yaml"), components);
  if (!legal.configuration || refused.report.errors() != kTasks) {
    std::fprintf(stderr, "%s%s", legal.report.text().c_str(), refused.report.text().c_str());
    return 1;
  }
  const int repetitions = bench::repetitions(argc, argv, 31);
  for (const bool is_good : {true, false}) {
    std::vector<double> ms;
    for (int i = 0; i < repetitions; ++i) {
      const double start = bench::now_ns();
      Verdict verdict = verify(read_description(is_good ? good : bad, "chain.yaml"), components);
      std::string text = verdict.report.text();
      bench::keep(text);
      ms.push_back((bench::now_ns() - start) * 1e-6);
    }
    bench::print({.row = 15, .what = is_good ? "check a legal application of 100 tasks" : "refuse 100 faulty tasks",
                  .unit = "ms", .figure = bench::median(ms), .goal = bench::figure_at_most(50),
                  .n = static_cast<std::uint64_t>(repetitions)});
  }
  return 0;
}
