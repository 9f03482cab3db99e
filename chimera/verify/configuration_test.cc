// SPDX-License-Identifier: Apache-2.0
#include "chimera/verify/configuration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

PortDescriptor port(std::string name, std::uint32_t kind, std::string unit = "1", std::string shape = "") {
  return {.name = std::move(name), .unit = std::move(unit), .shape = std::move(shape), .kind = kind};
}

PortDescriptor resource(std::string name) {
  PortDescriptor out = port(std::move(name), CHIMERA_RESOURCE);
  out.type = CHIMERA_STRING;
  out.element_size = 256;
  return out;
}

PortDescriptor whole(std::string name, std::uint32_t kind) {
  PortDescriptor out = port(std::move(name), kind);
  out.type = CHIMERA_INT32;
  out.element_size = 4;
  return out;
}

Descriptor component(std::string name, std::vector<PortDescriptor> ports, double rate = 100) {
  Descriptor d;
  d.name = std::move(name);
  d.default_rate_hz = rate;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = std::move(ports);
  const auto sound = complete(d);
  EXPECT_TRUE(sound) << (sound ? "" : sound.error().message.c_str());
  return d;
}

PortDescriptor with_initial(PortDescriptor made, double value) {
  made.initial.resize(8);
  std::memcpy(made.initial.data(), &value, 8);
  return made;
}

const Library& library() {
  static const Library kLibrary = Library::of(
      {component("source", {port("x", CHIMERA_OUT_VAR, "rad", "[3]"), resource("device")}, 3),
       component("gain", {port("x", CHIMERA_IN_VAR, "U", "[n<=8]"), with_initial(port("k", CHIMERA_IN_CONST), 2),
                          port("y", CHIMERA_OUT_VAR, "U", "[n<=8]")}),
       component("sink", {port("x", CHIMERA_IN_VAR, "rad", "[3]")}),
       component("robot", {whole("ndof", CHIMERA_OUT_CONST), port("q", CHIMERA_OUT_VAR, "rad", "[ndof<=10]"),
                           port("tau", CHIMERA_IN_VAR, "N.m", "[ndof<=10]")}),
       component("law", {whole("ndof", CHIMERA_IN_CONST), port("q", CHIMERA_IN_VAR, "rad", "[ndof<=6]"),
                         port("kp", CHIMERA_IN_CONST, "N.m/rad", "[ndof<=6]"),
                         port("tau", CHIMERA_OUT_VAR, "N.m", "[ndof<=6]")}),
       component("loop", {port("a", CHIMERA_IN_VAR), with_initial(port("b", CHIMERA_OUT_VAR), 1)})},
      our_units());
  return kLibrary;
}

Configuration legal(std::string_view text) {
  const ReadDescription reading = read_description(text, "demo.yaml");
  Verdict verdict = verify(reading, library());
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  return std::move(*verdict.configuration);
}

std::vector<double> numbers(std::span<const std::byte> bytes) {
  std::vector<double> out(bytes.size() / 8);
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

std::vector<std::string> names(const Configuration& made, std::span<const TaskId> order) {
  return names_of(order, [&made](TaskId id) { return made.tasks()[id.index].name; });
}

using Names = std::vector<std::string>;

constexpr const char* kLine = R"(
subsystem: line
tasks:
  sink: {alias: {x: y}}
  gain: {rate: 1 kHz, deadline: 500 us, offset: 250 us, budget: 40 us, min: 10 us, criticality: medium,
         user_priority: 7, on_miss: hold, on_overrun: flag, max_consecutive: 3, initial: {y: [90 deg, 0 rad, 1 rad]}}
  source: {resources: {device: /dev/null}}
)";

TEST(Configuration, HandsTheTimesDown) {
  const Configuration made = legal(kLine);
  const TaskSpec& gain = made.spec().tasks[1];
  EXPECT_EQ(gain.name, "gain");
  EXPECT_EQ(gain.period, microseconds(1000));
  EXPECT_EQ(gain.deadline, microseconds(500));
  EXPECT_EQ(gain.offset, microseconds(250));
  EXPECT_EQ(gain.budget, microseconds(40));
  EXPECT_EQ(gain.min_time, microseconds(10));
  EXPECT_EQ(gain.criticality, 1u);
  EXPECT_EQ(gain.user_priority, 7u);
  EXPECT_EQ(gain.on_miss, OnMiss::kHold);
  EXPECT_EQ(gain.on_overrun, OnMiss::kFlag);
  EXPECT_EQ(gain.max_consecutive, 3u);
  const TaskSpec& source = made.spec().tasks[2];
  EXPECT_EQ(source.period, Nanoseconds{333'333'333});
  EXPECT_EQ(source.deadline, source.period);
}

TEST(Configuration, SolvesGenericPorts) {
  const Configuration made = legal(kLine);
  const PortSpec &in = made.spec().tasks[1].ports[0], &out = made.spec().tasks[1].ports[2];
  EXPECT_EQ(made.spec().link_name(in), "x");
  EXPECT_EQ(in.extent[0].max, 3u);
  EXPECT_EQ(out.max_bytes(), 24u);
  EXPECT_EQ(made.tasks()[1].ports[2].unit, "rad");
  EXPECT_EQ(made.tasks()[1].ports[2].shape, "[3]");
}

TEST(Configuration, ConvertsValuesToTheUnitOfThePort) {
  const Configuration made = legal(kLine);
  const std::vector<double> initial = numbers(made.spec().tasks[1].ports[2].value);
  ASSERT_EQ(initial.size(), 3u);
  EXPECT_NEAR(initial[0], 1.5707963267948966, 1e-15);
  EXPECT_EQ(initial[2], 1.0);
}

TEST(Configuration, GivesAnUnlinkedConstantItsDefaultAndAResourceItsText) {
  const Configuration made = legal(kLine);
  const PortSpec& k = made.spec().tasks[1].ports[1];
  EXPECT_EQ(made.spec().link_name(k), "");
  EXPECT_EQ(numbers(k.value), std::vector<double>{2});
  const std::span<const std::byte> text = made.spec().tasks[2].ports[1].value;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(text.data()), text.size()), "/dev/null");
}

TEST(Configuration, StartsInDataFlowOrderHardwareInputsFirst) {
  const Configuration made = legal(kLine);
  EXPECT_EQ(names(made, made.spec().start), (Names{"source", "gain", "sink"}));
}

TEST(Configuration, CutsALoopWhereTheDescriptionGivesAValue) {
  const Configuration made = legal(
      "subsystem: ring\ntasks:\n"
      "  one: {component: loop, alias: {a: c, b: a}}\n"
      "  two: {component: loop, alias: {a: a, b: b}, initial: {b: 5}}\n"
      "  three: {component: loop, alias: {a: b, b: c}}\n");
  EXPECT_EQ(names(made, made.spec().start), (Names{"three", "one", "two"}));
  EXPECT_EQ(numbers(made.spec().tasks[1].ports[1].value), std::vector<double>{5});
}

TEST(Configuration, CutsALoopAtTheFirstByNameOtherwise) {
  const Configuration made = legal(
      "subsystem: ring\ntasks:\n"
      "  one: {component: loop, alias: {a: c, b: b}}\n"
      "  two: {component: loop, alias: {a: b, b: a}}\n"
      "  three: {component: loop, alias: {a: a, b: c}}\n");
  EXPECT_EQ(names(made, made.spec().start), (Names{"three", "one", "two"}));
}

/// The tasks in the order of TaskSpec::place.
Names cycles(std::string_view text) {
  const Configuration made = legal(text);
  Names order(made.tasks().size());
  for (std::size_t t = 0; t < order.size(); ++t) order.at(made.spec().tasks[t].place) = made.tasks()[t].name;
  return order;
}

TEST(Configuration, CyclesFollowTheDataAndCutALoopAtAnInitialOfTheDescription) {
  const auto ring = [](const std::string& initial, const std::string& more) {
    return cycles("subsystem: ring\ntasks:\n"
                  "  end: {component: loop, alias: {a: c, b: d}}\n"
                  "  one: {component: loop, alias: {a: c, b: a}}\n"
                  "  two: {component: loop, alias: {a: a, b: b}" + initial + "}\n"
                  "  three: {component: loop, alias: {a: b, b: c}}\n" + more);
  };
  EXPECT_EQ(ring("", ""), (Names{"one", "two", "three", "end"})) << "cut where the text goes backward";
  EXPECT_EQ(ring(", initial: {b: 5}", ""), (Names{"three", "end", "one", "two"}));
  EXPECT_EQ(ring("", "  four: {component: loop, alias: {a: c, b: e}, initial: {b: 5}}\n"),
            (Names{"one", "two", "three", "end", "four"})) << "a value outside of the loop cuts nothing";
}

TEST(Configuration, CyclesFollowTheStartWhereConfigurationsContradictEachOther) {
  const std::string text =
      "subsystem: s\ntasks:\n"
      "  m: {component: loop, alias: {a: t, b: p}}\n"
      "  n: {component: loop, alias: {a: p, b: s}}\n"
      "  r: {component: loop, alias: {a: s, b: t}}\n"
      "  p0: {component: loop, alias: {a: z, b: p}}\n"
      "  s0: {component: loop, alias: {a: z, b: s}}\n"
      "  t0: {component: loop, alias: {a: z, b: t}}\n"
      "operator: {z: 0}\n"
      "configurations: {mn: [m, n, t0], nr: [n, r, p0], rm: [r, m, s0]}\nstart: ";
  EXPECT_EQ(cycles(text + "mn\n"), (Names{"p0", "s0", "t0", "m", "n", "r"})) << "not r before m";
  EXPECT_EQ(cycles(text + "nr\n"), (Names{"p0", "s0", "t0", "m", "n", "r"})) << "then the first in the text";
  EXPECT_EQ(cycles(text + "rm\n"), (Names{"p0", "s0", "r", "t0", "m", "n"})) << "not n before r";
}

constexpr const char* kRobot = R"(
subsystem: arm
constants: {kp: [1 kN.m/rad, 2 kN.m/rad, 3 kN.m/rad]}
tasks:
  law: {initial: {tau: 4 N.m}}
  robot:
)";

TEST(Configuration, InitialisesProducersOfConstantsFirst) {
  const Configuration made = legal(kRobot);
  EXPECT_EQ(names(made, made.spec().init_order), (Names{"robot", "law"}));
}

TEST(Configuration, LaysAllPortsOfAVariableOutAtTheLeastMaximum) {
  const Configuration made = legal(kRobot);
  for (const TaskSpec& task : made.spec().tasks)
    for (const PortSpec& p : task.ports) {
      const std::string_view name = made.spec().link_name(p);
      if (name != "q" && name != "tau") continue;
      EXPECT_EQ(p.extent[0].max, 6u) << task.name << ' ' << name;
      ASSERT_TRUE(p.extent[0].constant.is_valid());
      EXPECT_EQ(made.spec().constants[p.extent[0].constant.index].name, "ndof");
    }
}

TEST(Configuration, FillsGivenVectorsToTheirMaximum) {
  const Configuration made = legal(kRobot);
  const PortSpec& port = made.spec().tasks[0].ports[2];
  ASSERT_TRUE(port.constant.is_valid());
  EXPECT_EQ(port.extent[0].max, 6u);
  const ConstantSpec& kp = made.spec().constants[port.constant.index];
  EXPECT_EQ(kp.name, "kp");
  EXPECT_TRUE(kp.producers.empty());
  EXPECT_EQ(kp.listed[0], 3u);
  EXPECT_EQ(numbers(kp.value), (std::vector<double>{1000, 2000, 3000, 0, 0, 0}));
  EXPECT_EQ(numbers(made.spec().tasks[0].ports[3].value), std::vector<double>(6, 4.0));
}

TEST(Configuration, HandsLinksDownById) {
  const Configuration made = legal(kRobot);
  const ApplicationSpec& spec = made.spec();
  Names constants, variables;
  for (const ConstantSpec& constant : spec.constants) constants.emplace_back(constant.name);
  EXPECT_EQ(constants, (Names{"kp", "ndof"}));
  EXPECT_EQ(spec.constants[1].type, CHIMERA_INT32);
  EXPECT_EQ(std::vector(spec.constants[1].producers.begin(), spec.constants[1].producers.end()),
            (std::vector<PortOf>{{TaskId(1u), 0}}));
  for (std::size_t v = 0; v < spec.variables.size(); ++v) {
    variables.emplace_back(spec.variables[v].name);
    EXPECT_EQ(made.variable(VariableId(v)).name, spec.variables[v].name);
    for (const PortOf& port : spec.variables[v].producers) {  // each of these components has one output
      ASSERT_EQ(port.index, 0u);
      const auto is_output = [](const PortSpec& p) { return p.kind == CHIMERA_OUT_VAR; };
      EXPECT_EQ(std::ranges::find_if(spec.tasks[port.task.index].ports, is_output)->variable, VariableId(v));
    }
  }
  EXPECT_EQ(variables, (Names{"q", "tau"}));
}

TEST(Configuration, OrdersTasksOutsideTheStartSetToo) {
  const Configuration made = legal(
      "subsystem: line\ntasks:\n"
      "  sink: {component: sink, alias: {x: y}}\n"
      "  gain: {component: gain}\n"
      "  source: {component: source, resources: {device: /dev/null}}\n"
      "configurations: {only: [source], all: [sink, gain, source]}\nstart: only\n");
  EXPECT_EQ(names(made, made.spec().start), (Names{"source"}));
  EXPECT_EQ(names(made, made.spec().on_order), (Names{"source", "gain", "sink"}));
  EXPECT_EQ(names(made, made.spec().end_order), (Names{"sink", "gain", "source"}));
}

TEST(Configuration, NamesProducersAndUsersOfAVariable) {
  const Configuration made = legal(kRobot);
  for (const ConfiguredVariable& variable : made.variables()) {
    if (variable.name != "tau") continue;
    ASSERT_EQ(variable.producers.size(), 1u);
    EXPECT_EQ(made.tasks()[variable.producers[0].task].name, "law");
    EXPECT_EQ(made.tasks()[variable.consumers[0].task].ports[variable.consumers[0].port].name, "tau");
    EXPECT_EQ(variable.unit, "N.m");
    EXPECT_EQ(variable.shape, "[ndof<=6]");
    return;
  }
  FAIL() << "no variable tau";
}

TEST(Configuration, TakesTheOperatorForAProducer) {
  const Configuration made = legal("subsystem: demo\ntasks: {sink: }\noperator: {x: 90 deg}\n");
  ASSERT_EQ(made.spec().operators.size(), 1u);
  const std::vector<double> value = numbers(made.spec().operators[0].value);
  ASSERT_EQ(value.size(), 3u);
  EXPECT_NEAR(value[2], 1.5707963267948966, 1e-15);
}

TEST(Configuration, KeepsTheUnitInWhichTheFileWritesAValue) {
  const Configuration made = legal("subsystem: demo\ntasks: {sink: }\noperator: {x: [90 deg, 1 rad, 0 rad]}\n");
  const ConfiguredVariable& x = made.variable(VariableId(0u));
  EXPECT_EQ(x.unit, "rad");
  EXPECT_EQ(x.written.text, "deg") << "of its first number";
  EXPECT_NEAR(x.written.from(1.5707963267948966), 90, 1e-12);
}

TEST(Configuration, HasOneRtpuAndOneConfigurationByDefault) {
  const Configuration made = legal("subsystem: demo\ntasks: {sink: }\noperator: {x: 0 rad}\n");
  ASSERT_EQ(made.rtpus().size(), 1u);
  EXPECT_EQ(made.rtpus()[0].name, "main");
  EXPECT_EQ(made.rtpus()[0].policy, Policy::kEdf);
  ASSERT_EQ(made.sets().size(), 1u);
  EXPECT_EQ(made.sets()[0].name, "all");
}

TEST(Configuration, HandsTheSetsAndTheLargestStepsDown) {
  const Configuration made = legal(std::string(kLine).replace(std::string(kLine).find("on_miss: hold"), 13,
                                                              "max_step: {y: [180 deg, 1 rad, 2 rad]}") +
                                   "configurations: {all: [sink, gain, source], bare: [source]}\nstart: all\n");
  const std::vector<double> steps = numbers(made.spec().tasks[1].ports[2].max_step);
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_NEAR(steps[0], 3.14159265358979, 1e-12);
  EXPECT_EQ(steps[2], 2.0);
  EXPECT_TRUE(made.spec().tasks[0].ports[0].max_step.empty());
  const auto sets = made.spec().sets;
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[0].name, "all");
  EXPECT_EQ(names(made, sets[0].order), (Names{"source", "gain", "sink"}));
  EXPECT_EQ(names(made, sets[1].order), Names{"source"});
  EXPECT_TRUE(std::ranges::equal(made.spec().start, sets[0].order));
}

TEST(Configuration, OutlivesItsSourcesAndCopies) {
  std::optional<Configuration> first = legal(kRobot);
  const Configuration second = *first;
  first.reset();
  EXPECT_EQ(second.spec().link_name(second.spec().tasks[0].ports[1]), "q");
  EXPECT_EQ(second.spec().name, "arm");
}

}  // namespace
}  // namespace chimera
