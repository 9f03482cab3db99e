// SPDX-License-Identifier: Apache-2.0
// What `chimera new` makes is built and tested as a newcomer would: in an empty folder outside the checkout, by CMake,
// against an installation and against the build tree.
#include "chimera/cli/files/new.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/base/testing/tree_path.h"

namespace chimera::cli {
namespace {

namespace fs = std::filesystem;

std::string build_tree() { return fs::path(build_path("")).parent_path(); }

class New : public ::testing::Test {
 protected:
  void SetUp() override {
    char path[] = "/tmp/chimera_new_XXXXXX";
    folder_ = ::mkdtemp(path);
  }
  void TearDown() override { fs::remove_all(folder_); }

  CommandResult make(NewKind kind, const std::string& name, const std::string& prefix = build_tree()) const {
    return new_project({kind, name, folder_}, prefix + "/bin/chimera");
  }
  /// Exit status; what was said is in log().
  int run(const std::string& command) const {
    return std::system(("(" + command + ") >" + folder_ + "/log 2>&1").c_str());
  }
  std::string log() const { return text("log"); }
  std::string text(const std::string& file) const {
    std::ostringstream all;
    all << std::ifstream(folder_ + "/" + file).rdbuf();
    return all.str();
  }
  /// Follows the printed steps.
  void build_and_test(const CommandResult& made, const std::string& name) const {
    ASSERT_EQ(made.code, kOk) << made.err;
    const std::string steps = made.out.substr(made.out.find("next:\n") + 6);
    // Sanitizers watch the component, but a leak check of the build tools is not ours to make.
    ASSERT_EQ(run("set -e; export ASAN_OPTIONS=detect_leaks=0; unset GTEST_OUTPUT; " + steps), 0) << log();
    EXPECT_NE(log().find("100% tests passed"), std::string::npos) << log();
    EXPECT_TRUE(fs::exists(folder_ + "/" + name + "/build/components")) << log();
  }

  std::string folder_;
};

TEST_F(New, ComponentBuildsAndPassesAgainstTheBuildTree) {
  build_and_test(make(NewKind::kComponent, "low_pass"), "low_pass");
  EXPECT_NE(log().find("low_pass: on cycle"), std::string::npos) << log();  // the methods that the build found
  EXPECT_TRUE(fs::exists(folder_ + "/low_pass/build/components/low_pass.component.json"));
  const std::string flags = "low_pass/build/CMakeFiles/component_low_pass_objects.dir/flags.make";
  EXPECT_NE(text(flags).find("-O2"), std::string::npos) << "no build type was given\n" << text(flags);
  ASSERT_NE(run("cd " + folder_ + "/low_pass && sed -i 's/\"s\"/\"ohmz\"/' low_pass.cc && cmake --build build"), 0);
  EXPECT_NE(log().find("port time: \"ohmz\" is no known unit"), std::string::npos) << log();
}

TEST_F(New, ComponentInCAndApplicationBuildAndPassAgainstAnInstallation) {
  const std::string prefix = folder_ + "/its prefix";  // a shell must read it back
  ASSERT_EQ(run("cmake --install " + build_tree() + " --component sdk --prefix \"" + prefix + "\""), 0) << log();
  build_and_test(make(NewKind::kComponentInC, "low_pass_c", prefix), "low_pass_c");
  build_and_test(make(NewKind::kApplication, "demo", prefix), "demo");
  EXPECT_TRUE(fs::exists(folder_ + "/demo/build/components/demo_control.component.json"));
  EXPECT_TRUE(text("demo/demo.yaml").starts_with("subsystem: demo\n"));  // no schema is installed with the sdk
  EXPECT_NE(text("demo/build/cases_demo.xml").find("tests=\"2\" failures=\"0\" errors=\"0\""), std::string::npos)
      << log();
}

TEST_F(New, DriverOfADeviceBuildsAndPassesOnAPseudoTerminal) {
  build_and_test(make(NewKind::kHardwareComponent, "lift"), "lift");
  EXPECT_NE(log().find("lift: init on cycle off kill clear"), std::string::npos) << log();
}

TEST_F(New, WritesAProjectWithoutOurLicence) {
  ASSERT_EQ(make(NewKind::kComponent, "x9_y").code, kOk);
  EXPECT_EQ(text("x9_y/x9_y.cc").find("SPDX"), std::string::npos);
  EXPECT_NE(text("x9_y/x9_y.cc").find("struct X9YComponent {"), std::string::npos);
  EXPECT_EQ(text("x9_y/CMakeLists.txt").find('@'), std::string::npos);
}

TEST_F(New, FirmwareNamesTheToolsOfTheTree) {
  const CommandResult made = make(NewKind::kFirmware, "mine");
  EXPECT_EQ(made.out, "made " + folder_ + "/mine: CMakeLists.txt mine.yaml mine_filter.cc README.md board.yaml "
                      "image.yaml run.sh\nnext:\n  cd " + folder_ + "/mine\n  ./run.sh\n");
  EXPECT_EQ(run(folder_ + "/mine/run.sh --help >" + folder_ + "/help"), 0) << log();
  EXPECT_NE(text("help").find("usage: make.py "), std::string::npos) << text("help");
}

TEST_F(New, ADescriptionNamesTheSchemaForEditors) {
  ASSERT_EQ(make(NewKind::kApplication, "loop").code, kOk);
  const std::string head = "# yaml-language-server: $schema=", line = text("loop/loop.yaml");
  ASSERT_TRUE(line.starts_with(head)) << line;
  EXPECT_TRUE(fs::exists(line.substr(head.size(), line.find('\n') - head.size()))) << line;
}

TEST_F(New, NamesTheFolderThatCannotBeWritten) {
  const CommandResult made = new_project({NewKind::kComponent, "mine", "/proc"}, build_tree() + "/bin/chimera");
  EXPECT_TRUE(made.err.starts_with("/proc/mine: error: cannot be made in /proc: ")) << made.err;
  EXPECT_TRUE(made.err.ends_with(". Go to a folder that you may write in.\n")) << made.err;
}

TEST_F(New, OverwritesNothing) {
  ASSERT_EQ(make(NewKind::kComponent, "mine").code, kOk);
  std::ofstream(folder_ + "/mine/mine.cc") << "my work\n";
  const CommandResult again = make(NewKind::kApplication, "mine");
  EXPECT_EQ(again.code, kRefused);
  EXPECT_EQ(again.err, folder_ + "/mine: error: exists already: nothing is overwritten\n");
  EXPECT_EQ(text("mine/mine.cc"), "my work\n");
}

TEST_F(New, RefusesIllegalNames) {
  for (const std::string name : {"", "9lives", "Upper", "a-b", "../up", "a b"}) {
    const CommandResult made = make(NewKind::kComponent, name);
    EXPECT_EQ(made.code, kRefused) << name;
    EXPECT_EQ(made.err, "error: \"" + name + "\" is no legal name: [a-z][a-z0-9_]*, at most 40 letters\n");
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(New, RefusesAParentOrAnInstallationThatIsNotThere) {
  EXPECT_EQ(new_project({NewKind::kComponent, "x", folder_ + "/no"}, build_tree() + "/bin/chimera").err,
            folder_ + "/no: error: there is no such folder\n");
  EXPECT_EQ(make(NewKind::kComponent, "x", "/nowhere").err,
            "/nowhere: error: there are no templates: no share/chimera/templates/component; the Debian package "
            "chimera-dev has them\n");
}

}  // namespace
}  // namespace chimera::cli
