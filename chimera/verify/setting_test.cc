// SPDX-License-Identifier: Apache-2.0
#include "chimera/verify/setting.h"

#include <gtest/gtest.h>

#include <cstring>

#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"

namespace chimera {
namespace {

PortDescriptor set_port(std::string name, std::uint32_t kind, std::string unit, std::string shape = "") {
  return {.name = std::move(name), .unit = std::move(unit), .shape = std::move(shape), .kind = kind};
}

Descriptor set_component(std::string name, std::vector<PortDescriptor> ports) {
  Descriptor d;
  d.name = std::move(name);
  d.default_rate_hz = 100;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = std::move(ports);
  EXPECT_TRUE(complete(d));
  return d;
}

const Library& set_library() {
  static const Library kLibrary = Library::of(
      {set_component("law", {set_port("q", CHIMERA_IN_VAR, "rad", "[2]"),
                             set_port("kp", CHIMERA_IN_VAR, "N.m/rad", "[2]"),
                             set_port("limit", CHIMERA_IN_CONST, "N.m"), set_port("cutoff", CHIMERA_IN_CONST, "Hz"),
                             set_port("tau", CHIMERA_OUT_VAR, "N.m", "[2]")})},
      our_units());
  return kLibrary;
}

constexpr const char* kText =
    "subsystem: arm\n"
    "constants: {limit: 5 N.m}\n"
    "tasks:\n"
    "  law: {component: law, constants: {cutoff: 10 Hz}}\n"
    "operator:\n"
    "  q: [0 rad, 0 rad]\n"
    "  kp: [1 N.m/rad, 2 N.m/rad]\n";

class SettingTest : public ::testing::Test {
 protected:
  SettingTest() : verdict_(verify(read_description(kText, "arm.yaml"), set_library())) {
    EXPECT_TRUE(verdict_.configuration) << verdict_.report.text();
  }
  static Setting set(const std::string& name, const std::string& value) {
    return {name, value, "--set " + name + " '" + value + "'"};
  }
  Result<Configuration> with(const std::vector<Setting>& settings) {
    return with_settings(*verdict_.configuration, set_library(), settings);
  }
  /// "where: message", or "accepted".
  std::string refusal(const std::vector<Setting>& settings) {
    const auto made = with(settings);
    return made ? "accepted" : made.error().where.c_str() + std::string(": ") + made.error().message.c_str();
  }
  static std::vector<double> numbers(std::span<const std::byte> bytes) {
    std::vector<double> all(bytes.size() / sizeof(double));
    std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
  }

  Verdict verdict_;
};

TEST_F(SettingTest, PutsValuesInThePlaceOfThoseOfTheFile) {
  const auto made = with({set("kp", "[3 4] kN.m/rad"), set("limit", "700 mN.m"), set("law.cutoff", "2 kHz")});
  ASSERT_TRUE(made) << made.error().message.c_str();
  EXPECT_EQ(numbers(made->spec().operators[1].value), (std::vector<double>{3000, 4000}));
  EXPECT_EQ(numbers(made->spec().constants[0].value), (std::vector<double>{0.7}));
  EXPECT_EQ(numbers(made->spec().tasks[0].ports[3].value), (std::vector<double>{2000}));
  // The original configuration is unchanged.
  EXPECT_EQ(numbers(verdict_.configuration->spec().operators[1].value), (std::vector<double>{1, 2}));
}

TEST_F(SettingTest, OneValueFillsAList) {
  const auto made = with({set("kp", "7 N.m/rad")});
  ASSERT_TRUE(made);
  EXPECT_EQ(numbers(made->spec().operators[1].value), (std::vector<double>{7, 7}));
}

TEST_F(SettingTest, AWrongValueIsReportedWithItsPlaceAndOption) {
  EXPECT_EQ(refusal({set("limit", "2 N.m"), set("kp", "5 rad")}),
            "arm.yaml:7:7: --set kp '5 rad': operator variable 'kp': expected a quantity in \"N.m/rad\", "
            "found one in \"rad\"");
  EXPECT_EQ(refusal({set("kp", "[1 2 3] N.m/rad")}).substr(0, 56),
            "arm.yaml:7:7: --set kp '[1 2 3] N.m/rad': operator varia");
  EXPECT_EQ(refusal({set("kp", "1, q: 2")}).substr(0, 34), "arm.yaml:7:7: --set kp '1, q: 2': ");
}

TEST_F(SettingTest, AWrongNameIsReportedWithTheNearest) {
  EXPECT_EQ(refusal({set("kpp", "5")}),
            "arm.yaml: --set kpp '5': the file has no operator variable or constant 'kpp'; did you mean 'kp'?");
  EXPECT_EQ(refusal({set("lw.cutoff", "5 Hz")}), "arm.yaml: --set lw.cutoff '5 Hz': no task 'lw'; did you mean 'law'?");
  EXPECT_EQ(refusal({set("cutoff", "5 Hz")}),
            "arm.yaml: --set cutoff '5 Hz': the file has no operator variable or constant 'cutoff'; task 'law' has a "
            "constant of that name: 'law.cutoff'");
  EXPECT_NE(refusal({set("law.cutof", "5 Hz")}).find("did you mean 'cutoff'?"), std::string::npos)
      << refusal({set("law.cutof", "5 Hz")});
}

TEST_F(SettingTest, RefusesAProducedVariableAndASecondValue) {
  EXPECT_EQ(refusal({set("tau", "5 N.m")}),
            "arm.yaml:4:3: --set tau '5 N.m': 'tau' is produced by task 'law'; operator variables and constants of the "
            "file can be set");
  EXPECT_EQ(refusal({set("kp", "1 N.m/rad"), set("kp", "2 N.m/rad")}),
            "arm.yaml: --set kp '2 N.m/rad': 'kp' is set twice");
}

}  // namespace
}  // namespace chimera
