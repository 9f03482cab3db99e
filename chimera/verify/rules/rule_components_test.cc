// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

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

}  // namespace
}  // namespace chimera
