// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "chimera/catalogue/descriptor_json.h"
#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

Descriptor component(const std::string& name) {
  Descriptor d;
  d.name = name;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = {{.name = "x", .unit = "m"}};
  EXPECT_TRUE(complete(d));
  return d;
}

/// A folder under the temporary folder of the test.
struct RuleComponents : ::testing::Test {
  std::string root = testing::TempDir() + "chimera_rule_components_" + std::to_string(::getpid()) + "/";
  void SetUp() override { std::filesystem::create_directories(root + "one"); }
  void TearDown() override { std::filesystem::remove_all(root); }
  void write(const std::string& file, const std::string& text) { std::ofstream(root + file) << text; }
  Library make() {
    const std::string folders[] = {root + "one", root + "nowhere"};
    return Library::make(folders, our_units());
  }
};

TEST_F(RuleComponents, NamesFoldersOfThePathThatAreNotThere) {
  EXPECT_TRUE(make().missing_folders().empty());
  ::setenv("CHIMERA_PATH", (root + "one:/nowhere/at/all").c_str(), 1);
  const Library library = make();
  const Verdict verdict =
      verify(read_description("subsystem: demo\ntasks: {motor: {rate: 1 kHz}}\n", "app.yaml"), library);
  ::unsetenv("CHIMERA_PATH");
  ASSERT_EQ(library.missing_folders().size(), 1u);
  EXPECT_EQ(verdict.report.text(),
            "app.yaml:2:9: error: task 'motor': the component 'motor' is not in the library [component-unknown]\n"
            "  'chimera list' shows the library; CHIMERA_PATH adds folders to it; CHIMERA_PATH names /nowhere/at/all, "
            "which is no folder\n");
}

TEST_F(RuleComponents, AComponentThatCannotBeReadIsNotMissing) {
  std::string text = to_json(component("motor"));
  text.replace(text.find("\"abi_version\": 1"), 16, "\"abi_version\": 99");
  write("one/motor.component.json", text);
  const Verdict verdict =
      verify(read_description("subsystem: demo\ntasks: {motor: {rate: 1 kHz}}\n", "app.yaml"), make());
  EXPECT_EQ(verdict.report.text(),
            "app.yaml:2:9: error: task 'motor': the component 'motor' cannot be used: " + root +
                "one/motor.component.json: $.abi_version: motor was built for ABI 99, and this chimera needs ABI 1 "
                "[component-unknown]\n  rebuild the component motor\n");
}

/// An arm, a path that may measure it, and a counter whose output has the name of a port of the path.
Library arm_and_path() {
  const auto made = [](const std::string& name, std::vector<PortDescriptor> ports) {
    Descriptor d;
    d.name = name;
    d.default_rate_hz = 100;
    d.methods[CHIMERA_CYCLE] = true;
    d.ports = std::move(ports);
    EXPECT_TRUE(complete(d));
    return d;
  };
  const PortDescriptor measured{.name = "q", .unit = "rad", .repeated = true, .max_instances = 1};
  const PortDescriptor q{.name = "q", .unit = "rad", .kind = CHIMERA_OUT_VAR};
  const PortDescriptor reference{.name = "q_ref", .unit = "rad", .kind = CHIMERA_OUT_VAR};
  return Library::of({made("arm", {q, {.name = "q_ref", .unit = "rad"}}), made("path", {measured, reference}),
                      made("counter", {{.name = "q", .unit = "m", .kind = CHIMERA_OUT_VAR}})},
                     our_units());
}

/// The tasks of the first configuration in their order, each with the number of its inputs.
std::string order_of(const std::string& tasks) {
  const Verdict verdict = verify(read_description("subsystem: demo\n" + tasks, "app.yaml"), arm_and_path());
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  if (!verdict.configuration) return "";
  const ApplicationSpec& spec = verdict.configuration->spec();
  std::string order;
  for (const TaskId task : spec.start) {
    std::size_t inputs = 0;
    for (const Variable& variable : spec.variables)
      inputs += static_cast<std::size_t>(
          std::ranges::count_if(variable.consumers, [&](const PortOf& port) { return port.task == task; }));
    order += std::string(spec.tasks[task.index].name) + std::to_string(inputs) + " ";
  }
  return order;
}

TEST(LeftOut, AMeasuredPortJoinsTheVariableOfItsNameAndClosesNoLoop) {
  EXPECT_EQ(order_of("tasks: {path: {}, arm: {}}"), "arm1 path1 ") << "the arm goes ON first";
  EXPECT_EQ(order_of("tasks: {path: {}}"), "path0 ");
  EXPECT_EQ(order_of("tasks: {path: {alias: {q: []}}, arm: {}}"), "path0 arm1 ");
  EXPECT_EQ(order_of("tasks: {path: {}, counter: {}}"), "path0 counter0 ") << "another unit";
  EXPECT_EQ(order_of("tasks: {path: {}, arm: {}}\nconfigurations: {all: [path, arm], alone: [path]}"), "path0 arm1 ")
      << "one configuration has no arm";
}

}  // namespace
}  // namespace chimera
