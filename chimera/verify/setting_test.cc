// SPDX-License-Identifier: Apache-2.0
#include "chimera/verify/setting.h"

#include <gtest/gtest.h>

#include <cstring>

#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/testing/sample_component.h"

namespace chimera {
namespace {

PortDescriptor set_port(std::string name, std::uint32_t kind, std::string unit, std::string shape = "") {
  return {.name = std::move(name), .unit = std::move(unit), .shape = std::move(shape), .kind = kind};
}

const Library& set_library() {
  static const Library kLibrary = Library::of(
      {sample_component("law", {set_port("q", CHIMERA_IN_VAR, "rad", "[2]"),
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

TEST_F(SettingTest, ANumberIsWrittenInTheUnitThatTheFileHas) {
  const auto written = [](const std::string& before, const std::string& now) {
    return in_words_of(written_value(before), now, our_units());
  };
  EXPECT_EQ(written("1.6 V/A", "1.5 m2.kg.rad/(s3.A2)"), "1.5 V/A");
  EXPECT_EQ(written("180 deg", "3.141592653589793 rad"), "180 deg");
  EXPECT_EQ(written("1600 mV/A", "1.5 V/A"), "1500 mV/A");
  EXPECT_EQ(written("[1 m, 20 cm]", "[3 m, 0.5 m]"), "[3 m, 50 cm]");
  EXPECT_EQ(written("2 mm", "[0.001 m, 0.5 m]"), "[1 mm, 500 mm]");
  EXPECT_EQ(written("{x: 1 cm, n: 3}", "{x: 0.25 m, n: 4}"), "{x: 25 cm, n: 4}");
  for (const char* now : {"5 N", "true", "\"a text\"", "[1, 2]"}) EXPECT_EQ(written(now, now), now);
}

TEST_F(SettingTest, AnRtpuIsPlacedOnAnotherCpu) {
  const auto made = with({{"rtpus.main.cpu", "3", "--cpu main=3"}});
  ASSERT_TRUE(made) << made.error().message.c_str();
  EXPECT_EQ(made->rtpus()[0].cpu, 3u);
  EXPECT_EQ(refusal({{"rtpus.man.cpu", "3", "--cpu man=3"}}),
            "arm.yaml: --cpu man=3: no rtpu 'man'; did you mean 'main'?");
  EXPECT_EQ(refusal({{"rtpus.main.cpu", "x", "--cpu main=x"}}),
            "arm.yaml: --cpu main=x: expected RTPU=N, N from 0 to 1023");
}

TEST_F(SettingTest, AConstantIsExplained) {
  EXPECT_EQ(about_constant(*verdict_.configuration, "cutoff"),
            "'cutoff' is a constant of task 'law' (10 Hz): nothing changes it while tasks run. Change it in the file "
            "and start again; an input under operator: can be set at any time");
  const auto about = [this](const std::string& name) { return about_constant(*verdict_.configuration, name); };
  EXPECT_TRUE(about("limit").starts_with("'limit' is a constant of task 'law' (5 N.m)"));
  EXPECT_TRUE(about("law.cutoff").starts_with("'law.cutoff' is a constant of task"));
  EXPECT_EQ(about("kp"), "");
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
