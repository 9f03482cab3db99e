// SPDX-License-Identifier: Apache-2.0
#include "chimera/component_test/setup.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "chimera/component_test/testing/test_component.h"

namespace chimera::component_test {
namespace {

namespace fs = std::filesystem;

LibraryEntry everything() {
  PortDescriptor ndof = port("ndof", CHIMERA_IN_CONST, "1");
  ndof.type = CHIMERA_INT32;
  ndof.element_size = 4;
  PortDescriptor many = port("in", CHIMERA_IN_VAR, "U");
  many.repeated = true;
  many.max_instances = 16;
  return component({ndof, port("q", CHIMERA_IN_VAR, "rad", "[ndof<=10]"), many, port("k", CHIMERA_IN_CONST, "X/U"),
                    ranged(port("limit", CHIMERA_IN_CONST, "m"), 2, 4), port("w", CHIMERA_IN_VAR, "U/s", "[n<=3]"),
                    port("y", CHIMERA_OUT_VAR, "X")});
}

TEST(MadeUp, GivesEveryInputAndConstant) {
  EXPECT_EQ(default_setup(everything().descriptor),
            "subsystem: trial\n"
            "tasks:\n"
            "  thing:\n"
            "    component: thing\n"
            "    alias:\n"
            "      in: [in_0, in_1]\n"
            "    constants:\n"
            "      ndof: 2\n"
            "      k: 1\n"
            "      limit: 3 m\n"
            "operator:\n"
            "  q: 0.5 rad\n"
            "  in_0: 0.5\n"
            "  in_1: 0.5\n"
            "  w: [0.5 1/s, 0.5 1/s]\n");
  const Verdict verdict = arrange({}, everything(), our_units());
  EXPECT_TRUE(verdict.configuration.has_value()) << verdict.report.text();
}

TEST(Arrange, ChoosesUnitAndExtentOfOutputsWithoutReaders) {
  const Verdict verdict = arrange({}, component({port("y", CHIMERA_OUT_VAR, "U/s", "[n<=64]")}), our_units());
  ASSERT_TRUE(verdict.configuration.has_value()) << verdict.report.text();
  EXPECT_EQ(verdict.configuration->spec().tasks[0].ports[0].max_count(), 1u);
}

class ArrangeFrom : public ::testing::Test {
 protected:
  ArrangeFrom() : file_((fs::temp_directory_path() / ("setup_" + std::to_string(::getpid()) + ".yaml")).string()) {}
  ~ArrangeFrom() override { fs::remove(file_); }
  Verdict from(const std::string& text, const LibraryEntry& entry, const std::string& partner = "") {
    std::ofstream(file_) << text;
    return arrange({file_, "", partner}, entry, our_units());
  }
  std::string file_;
};

TEST_F(ArrangeFrom, TheFileSaysAndTheRestIsMadeUp) {
  const Verdict verdict = from(
      "subsystem: s\nconstants: {limit: 2.5 m}\n"
      "tasks: {thing: {rate: 50 Hz, alias: {in: [a, b, c]}, constants: {ndof: 3}}}\n"
      "operator: {q: [1 rad, 2 rad, 3 rad], b: 4}\n",
      everything());
  ASSERT_TRUE(verdict.configuration.has_value()) << verdict.report.text();
  const ApplicationSpec& spec = verdict.configuration->spec();
  EXPECT_EQ(spec.tasks[0].period, milliseconds(20));
  std::string names;
  for (const GivenSpec& given : spec.operators) names += std::string(given.name) + " ";
  EXPECT_EQ(names, "q b a c w ");
}

TEST_F(ArrangeFrom, NamesThePartner) {
  PortDescriptor device = port("device", CHIMERA_RESOURCE, "1");
  device.type = CHIMERA_STRING;
  device.element_size = 1;
  const LibraryEntry entry = component({device});
  const Verdict verdict =
      from("subsystem: s\ntasks: {thing: {resources: {device: \"tcp:{partner}\"}}}\n", entry, "5020");
  ASSERT_TRUE(verdict.configuration.has_value()) << verdict.report.text();
  const auto text = verdict.configuration->spec().tasks[0].ports[0].value;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(text.data()), text.size()), "tcp:5020");
}

TEST_F(ArrangeFrom, RefusesASetupThatDoesNotFitTheComponent) {
  const LibraryEntry entry = component({});
  EXPECT_EQ(from("subsystem: s\ntasks: {a: {component: other}}\n", entry).report.faults()[0].message,
            "a test setup has one task, of the component thing");
  EXPECT_TRUE(from("subsystem: s\ntasks: {thing: {ratee: 1 Hz}}\n", entry).report.has("key-unknown"));
  EXPECT_TRUE(from("subsystem: [\n", entry).report.has("yaml-syntax"));
  fs::remove(file_);
  EXPECT_TRUE(arrange({file_, "", ""}, entry, our_units()).report.has("file-unreadable"));
}

}  // namespace
}  // namespace chimera::component_test
