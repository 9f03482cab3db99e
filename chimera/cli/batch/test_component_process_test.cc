// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/batch/test_component.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "chimera/base/testing/tree_path.h"

namespace chimera::cli {
namespace {

namespace fs = std::filesystem;

class TestComponent : public ::testing::Test {
 protected:
  TestComponent() : folder_(fs::temp_directory_path() / ("chimera_component_test_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    workplace_.component_folders = {build_path("components")};
    workplace_.unit_files = {source_path("share/chimera/units.xml")};
    options_.components = {"t_misfit"};
    options_.cycles = 200;
  }
  ~TestComponent() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  CommandResult run() { return test_components(options_, workplace_); }
  /// The report's line called `name`.
  std::string line(const CommandResult& output, const std::string& name) const {
    for (std::size_t at = 0; at < output.out.size(); at = output.out.find('\n', at) + 1) {
      const std::string one = output.out.substr(at, output.out.find('\n', at) - at);
      if (one.size() > 28 && one.substr(14, name.size() + 1) == name + " ") return one;
    }
    return output.out + output.err;
  }
  /// The line after misdeed number `misdeed` of t_misfit.
  std::string misdeed(int misdeed, const std::string& name) {
    options_.setup = write("setup.yaml", "subsystem: s\ntasks: {t_misfit: {constants: {misdeed: " +
                                             std::to_string(misdeed) + "}}}\n");
    const CommandResult output = run();
    EXPECT_EQ(output.code, kRefused) << output.out;
    return line(output, name);
  }

  fs::path folder_;
  Workplace workplace_;
  TestOptions options_;
};

TEST_F(TestComponent, PassesAGoodOneAndSaysSo) {
  const CommandResult output = run();
  EXPECT_EQ(output.code, kOk) << output.out << output.err;
  EXPECT_TRUE(output.out.starts_with("t_misfit: passes (inputs: generated, seed 1)\n")) << output.out;
  EXPECT_EQ(line(output, "start"),
            "  ok          start         5 ports as the descriptor says; methods init on cycle kill error clear");
  EXPECT_EQ(line(output, "cycles"), "  ok          cycles        200 cycles completed");
  EXPECT_EQ(line(output, "faults"),
            "  ok          faults        came back after a fault in init: spawn, on; on: clear, on; cycle: clear, on; "
            "kill: spawn, on; error: clear, on; clear: clear, on");
  EXPECT_NE(output.out.find("\n  measured    time          "), std::string::npos) << output.out;
}

TEST_F(TestComponent, FindsOutputsThatAreNotSound) {
  EXPECT_EQ(misdeed(1, "outputs"), "  fails       outputs       y is NaN in cycle 7");
  EXPECT_EQ(misdeed(2, "outputs"), "  fails       outputs       y is 2e+06, outside -1e+06 to 1e+06 in cycle 7");
  EXPECT_EQ(misdeed(3, "outputs"), "  fails       outputs       z is NaN in cycle 0");
}

TEST_F(TestComponent, FindsAllocations) {
  EXPECT_EQ(misdeed(4, "allocations"),
            "  fails       allocations   cycle allocates: at most 1 block in one call, 200 in 200 calls");
  EXPECT_EQ(misdeed(5, "allocations"),
            "  fails       allocations   cycle allocates: at most 1 block in one call, 200 in 200 calls");
}

TEST_F(TestComponent, FindsSystemCalls) {
  const std::string said = misdeed(6, "cycles");
  options_.json = false;
  const std::string found = line(run(), "system calls");
  if (found.find("lets no process trace") != std::string::npos) GTEST_SKIP() << "the system allows no tracing";
  EXPECT_EQ(found,
            "  fails       system calls  cycle: at most 1 in one call, 200 in 200 calls, the first system call 110; "
            "and the component has no resource port");
  EXPECT_EQ(misdeed(17, "system calls"),
            "  fails       system calls  on: at most 1 in one call, 1 in 1 call, the first system call 110; "
            "and the component has no resource port");
}

TEST_F(TestComponent, FindsAComponentThatDoesNotRepeat) {
  EXPECT_EQ(misdeed(7, "repeatable"),
            "  fails       repeatable    the same inputs gave other outputs the second time, in cycle 0");
}

TEST_F(TestComponent, FindsAComponentThatDoesNotRecoverFromAFault) {
  EXPECT_EQ(misdeed(8, "faults"),
            "  fails       faults        after a fault in on it does not come back: \"does not forgive\"");
  EXPECT_EQ(misdeed(9, "faults"),
            "  fails       faults        after a fault in on clear returns false although the cause is gone");
}

TEST_F(TestComponent, FindsAStateThatABadInputSpoilt) {
  EXPECT_EQ(misdeed(10, "bad inputs"),
            "  fails       bad inputs    after NaN its outputs are still not finite 100 good cycles later");
}

TEST_F(TestComponent, SurvivesACrashAndAHang) {
  EXPECT_EQ(misdeed(11, "cycles"), "  fails       cycles        killed by signal 6 (Aborted) in cycle 3");
  options_.patience = seconds(2);  // one that is held up before does not hang
  EXPECT_EQ(misdeed(12, "cycles"), "  fails       cycles        no progress, ended in cycle 3");
}

TEST_F(TestComponent, FindsASafeStateThatIsNotReachedOrNotLeft) {
  EXPECT_EQ(line(run(), "safe state"),
            "  ok          safe state    reached under the illegal-configuration flag in cycle 1, and left when it is "
            "down");
  EXPECT_EQ(misdeed(18, "safe state"),
            "  fails       safe state    not reached within 5 s of cycles under the illegal-configuration flag");
  EXPECT_EQ(misdeed(19, "safe state"),
            "  fails       safe state    still told 5 s of cycles after the flag went down");
}

TEST_F(TestComponent, FindsDescriptorsAndMemoryThatKillLeaves) {
  const std::string open = misdeed(13, "leftovers");
  const std::string head = "  fails       leftovers     every two rounds of spawn and kill leave 2 open descriptors, ";
  EXPECT_TRUE(open.starts_with(head + "such as ")) << open;
  EXPECT_TRUE(open.ends_with(" -> /dev/null")) << open;
  EXPECT_EQ(misdeed(14, "leftovers"),
            "  fails       leftovers     every two rounds of spawn and kill leave 2 blocks of memory");
}

TEST_F(TestComponent, FindsAComponentThatCompletesNoCycleOrDoesNotStart) {
  EXPECT_EQ(misdeed(15, "cycles"),
            "  fails       cycles        none of 200 was completed, the first with \"thrown on purpose\" in cycle 0; "
            "NAME.test.yaml and --inputs give it something to work on");
  EXPECT_EQ(misdeed(16, "start"), "  fails       start         refuses on purpose");
}

TEST_F(TestComponent, FindsAnObjectThatContradictsItsDescriptor) {
  fs::copy(build_path("components/t_misfit.so"), folder_ / "t_misfit.so");
  std::ifstream stream(build_path("components/t_misfit.component.json"));
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  text.replace(text.find("\"z\""), 3, "\"w\"");
  const std::size_t mark = text.find(",\n  \"fingerprint\"");
  text.erase(mark, text.find('\n', mark + 2) - mark);
  write("t_misfit.component.json", text);
  options_.components = {(folder_ / "t_misfit.so").string()};
  const CommandResult output = run();
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(line(output, "start"),
            "  fails       start         component t_misfit: port 4: name: the descriptor says \"w\", the object says "
            "\"z\"");
}

TEST_F(TestComponent, TestsAnObjectWithoutSourceOrDescriptor) {
  fs::copy(build_path("components/t_misfit.so"), folder_ / "alone.so");
  options_.components = {(folder_ / "alone.so").string()};
  const CommandResult output = run();
  EXPECT_EQ(output.code, kOk) << output.out << output.err;
  write("text.so", "no object");
  options_.components = {(folder_ / "text.so").string()};
  EXPECT_EQ(run().err, (folder_ / "text.so").string() +
                           ": error: text.so is not a shared object: it does not begin with the ELF mark. Rebuild the "
                           "component.\n");
}

TEST_F(TestComponent, RefusesASetupThatIsNotLegal) {
  options_.setup = write("setup.yaml", "subsystem: s\ntasks: {t_misfit: {}}\noperator: {x: 1 m}\n");
  const CommandResult output = run();
  EXPECT_EQ(output.code, kRefused);
  EXPECT_NE(output.out.find("[value-unit]"), std::string::npos) << output.out;
  options_.setup = write("setup.yaml", "subsystem: s\ntasks: {a: {component: t_misfit}, b: {component: t_misfit}}\n");
  EXPECT_NE(run().out.find("a test setup has one task, of the component t_misfit [count-limit]"), std::string::npos);
}

TEST_F(TestComponent, PlaysARecording) {
  options_.inputs = write("run.csv", "t,in[0]\n0,1\n0.05,2\n0.1,\n0.2,-3\n");
  options_.names = {"x"};
  const CommandResult output = run();
  EXPECT_EQ(output.code, kOk) << output.out << output.err;
  EXPECT_EQ(line(output, "cycles"), "  ok          cycles        201 cycles completed");
  options_.inputs = write("run.csv", "t,v\n0,1\n");
  EXPECT_EQ(run().err, options_.inputs + ":1:3: error: no in-var of the component is called 'v'\n");
}

TEST_F(TestComponent, NamesTheNearestComponentForAnUnknownOne) {
  options_.components = {"t_misfitt"};
  const CommandResult output = run();
  EXPECT_EQ(output.code, kRefused);
  EXPECT_EQ(output.err, "error: no component 't_misfitt' is installed; did you mean 't_misfit'?\n");
}

}  // namespace
}  // namespace chimera::cli
