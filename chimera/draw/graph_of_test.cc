// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/graph_of.h"

#include <gtest/gtest.h>

#include "chimera/catalogue/library.h"
#include "chimera/description/draft.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera::draw::graph_of_test {
namespace {

PortDescriptor port(std::string name, std::uint32_t kind, bool has_default = false) {
  PortDescriptor made{.name = std::move(name), .unit = "1", .kind = kind};
  if (kind == CHIMERA_RESOURCE) made.type = CHIMERA_STRING, made.element_size = 0;
  if (has_default) made.initial.resize(8);
  return made;
}

Descriptor component(std::string name, std::vector<PortDescriptor> ports) {
  Descriptor made;
  made.name = std::move(name);
  made.default_rate_hz = 1000;
  made.methods[CHIMERA_CYCLE] = true;
  made.ports = std::move(ports);
  const auto sound = complete(made);
  EXPECT_TRUE(sound) << (sound ? "" : sound.error().message.c_str());
  return made;
}

const Library& drawn_library() {
  static const Library kLibrary = Library::of(
      {component("robot", {port("tau", CHIMERA_IN_VAR), port("q", CHIMERA_OUT_VAR), port("gear", CHIMERA_OUT_CONST),
                           port("spare", CHIMERA_OUT_CONST), port("device", CHIMERA_RESOURCE)}),
       component("law", {port("q", CHIMERA_IN_VAR), port("tau", CHIMERA_OUT_VAR), port("gear", CHIMERA_IN_CONST, true),
                         port("limit", CHIMERA_IN_CONST, true), port("rest", CHIMERA_IN_CONST, true)}),
       component("push", {port("tau", CHIMERA_OUT_VAR)}), component("need", {port("mass", CHIMERA_IN_CONST)})},
      our_units());
  return kLibrary;
}

Configuration legal(std::string_view text) {
  Verdict verdict = verify(read_description(text, "demo.yaml"), drawn_library());
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  return *std::move(verdict.configuration);
}

constexpr const char* kText = R"(
subsystem: demo
tasks:
  robot: {resources: {device: /dev/robot}, initial: {q: 0}}
  law: {rate: 50 Hz, constants: {limit: 2}}
  push: {}
configurations:
  closed: [robot, law]
  pushed: [robot, push]
)";

/// "law 50 Hz: in q=q, out tau=tau; ".
std::string text_of(const Graph& graph) {
  constexpr const char* kKinds[] = {"in", "out", "in-const", "out-const", "resource"};
  std::string text;
  for (const Box& box : graph.boxes) {
    text += box.name + " " + box.component + " " + box.rate + ":";
    for (const Port& each : box.ports)
      if (each.is_drawn)
        text += std::string(" ") + kKinds[static_cast<int>(each.kind)] + " " + each.name + "=" + each.variable +
                each.written;
    text += "\n";
  }
  return text;
}

TEST(GraphOf, DrawsNoDefaultsAndNoConstantsThatNoTaskReads) {
  const Graph graph = graph_of(legal(kText));
  EXPECT_EQ(graph.title, "demo");
  EXPECT_EQ(text_of(graph),
            "robot robot 1 kHz: in tau=tau out q=q out-const gear=gear resource device=/dev/robot\n"
            "law law 50 Hz: in q=q out tau=tau in-const gear=gear in-const limit=2\n"
            "push push 1 kHz: out tau=tau\n");
  EXPECT_EQ(graph.boxes[0].ports.size(), 5u) << "the text lists all of them";
  EXPECT_EQ(graph.boxes[1].ports.size(), 5u);
}

TEST(GraphOf, DrawsTheTasksOfOneConfiguration) {
  const Configuration configuration = legal(kText);
  const Graph graph = graph_of(configuration, &configuration.sets()[1]);
  EXPECT_EQ(graph.title, "demo: pushed");
  EXPECT_EQ(text_of(graph),
            "robot robot 1 kHz: in tau=tau out q=q resource device=/dev/robot\n"
            "push push 1 kHz: out tau=tau\n");
}

TEST(GraphOf, CutsALongValueAndNamesWhatTheOperatorGives) {
  const Graph graph = graph_of(legal(
      "subsystem: demo\ntasks:\n  robot: {resources: {device: /dev/serial/by-id/usb-arm-0}}\noperator: {tau: 1}\n"));
  EXPECT_EQ(graph.given, std::vector<std::string>{"tau"});
  EXPECT_EQ(graph.boxes[0].ports.back().written, "..serial/by-id/usb-arm-0");
}

TEST(GraphOf, DrawsAnIllegalOutlineAsItsTextLinksIt) {
  const Outlined outlined = verify_with_outline(
      read_description("subsystem: demo\ntasks:\n  push: {alias: {tau: gear}}\n"
                       "  law: {rate: 50 Hz, constants: {limit: 2}}\n  robot: {alias: {tau: q}}\n"
                       "  lost: {component: nothing}\n  other: {component: push, alias: {tau: gear}}\n  need:\n",
                       "demo.yaml"),
      drawn_library());
  ASSERT_FALSE(outlined.verdict.configuration);
  const Graph graph = graph_of(*outlined.outline);
  EXPECT_EQ(text_of(graph),
            "push push 1 kHz: out tau=gear\n"
            "law law 50 Hz: in q=q out tau=tau in-const limit=2\n"
            "robot robot 1 kHz: in tau=q out q=q resource device=\n"
            "lost nothing :\n"
            "other push 1 kHz: out tau=gear\n"
            "need need 1 kHz: in-const mass=\n");
  EXPECT_NE(svg(graph).find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace chimera::draw::graph_of_test
