// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/act/operator_values.h"

#include <gtest/gtest.h>

#include <cstring>

#include "chimera/manager/testing/test_bundle.h"
#include "chimera/text/json.h"

namespace chimera::manager::operator_values_test {
namespace {

PortDescriptor in_var(const std::string& name, const std::string& unit, const std::string& shape,
                      std::uint32_t type = CHIMERA_FLOAT64, std::uint32_t size = 8) {
  PortDescriptor port;
  port.name = name;
  port.unit = unit;
  port.shape = shape;
  port.type = type;
  port.element_size = size;
  return port;
}

Library library() {
  Descriptor d;
  d.name = "law";
  d.default_rate_hz = 100;
  d.state_size = 64;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = {in_var("kp", "N.m/rad", "[2]"), in_var("speed", "m/s", ""), in_var("go", "1", "", CHIMERA_BOOL, 1),
             in_var("word", "1", "", CHIMERA_STRING, 16), in_var("m", "1", "[2][3]"),
             in_var("n", "1", "", CHIMERA_INT32, 4)};
  d.ports[1].has_range = true;
  d.ports[1].max = 50;
  PortDescriptor pose = in_var("pose", "1", "", CHIMERA_STRUCT, 16);
  pose.type_name = "Spot";
  pose.fields = {{"x", "m"}, {"a", "rad", CHIMERA_FLOAT64, 8}};
  d.ports.push_back(pose);
  EXPECT_TRUE(complete(d)) << complete(d).error().message.c_str();
  return Library::of({d}, our_units());
}

constexpr const char* kText = R"(
subsystem: tune
tasks: {law: {}}
operator: {kp: [1 N.m/rad, 2 N.m/rad], speed: 36 km/h, go: false, word: idle, m: [[1, 2, 3], [4, 5, 6]], n: 3,
           pose: {x: 1 m, a: 2 rad}}
)";

class OperatorValues : public ::testing::Test {
 protected:
  OperatorValues() : library_(library()), configuration_(make()) {
    const ApplicationSpec& spec = configuration_.spec();
    for (const GivenSpec& given : spec.operators)
      for (const ConfiguredVariable& v : configuration_.variables())
        if (v.name == given.name) {
          ValueForm& form = forms_[v.name];
          form.type = given.type;
          form.element_bytes = given.element_bytes;
          form.count = given.extent[0].max * given.extent[1].max;
          form.is_scalar = v.shape.empty();
          form.unit = v.unit;
          if (v.name == "pose") form.fields = library_.find("law")->descriptor.port("pose")->fields;
        }
  }
  Configuration make() {
    const Verdict verdict = chimera::verify(read_description(kText, "tune.yaml"), library_);
    EXPECT_TRUE(verdict.configuration) << verdict.report.text();
    return *verdict.configuration;
  }
  Result<OperatorBytes> ask(const Json& values) { return operator_bytes(configuration_, library_, values, forms_); }
  /// The value in description_text() after it was set in this way.
  std::string after(const std::string& name, const Json& value) {
    const auto bytes = ask({{name, value}});
    if (!bytes) return std::string(bytes.error().where.view()) + ": " + bytes.error().message.c_str();
    return description_text(forms_.at(name), bytes->begin()->second, name == "m" ? 3 : 0);
  }

  Library library_;
  Configuration configuration_;
  std::map<std::string, ValueForm> forms_;
};

TEST_F(OperatorValues, NumbersCountInTheVariablesUnitAndTextsCarryTheirs) {
  EXPECT_EQ(after("speed", 12.5), "12.5 m/s");
  EXPECT_EQ(after("speed", "36 km/h"), "10 m/s");
  EXPECT_EQ(after("kp", Json::array({100, 90.5})), "[100 N.m/rad, 90.5 N.m/rad]");
  EXPECT_EQ(after("kp", "100 N.m/rad"), "[100 N.m/rad, 100 N.m/rad]");
  EXPECT_EQ(after("kp", "[1 2] N.m/rad"), "[1 N.m/rad, 2 N.m/rad]");
  EXPECT_EQ(after("kp", "[1 N.m/rad, 2 N.m/rad]"), "[1 N.m/rad, 2 N.m/rad]");
  EXPECT_EQ(after("kp", Json::array({"1 N.m/rad", 2})), "[1 N.m/rad, 2 N.m/rad]");
  EXPECT_EQ(after("n", 7), "7");
  EXPECT_EQ(after("speed", 1e-7), "1e-07 m/s");
}

TEST_F(OperatorValues, EveryTypeHasItsWords) {
  EXPECT_EQ(after("go", true), "true");
  EXPECT_EQ(after("go", "true"), "true");
  EXPECT_EQ(after("word", "run: \"now\""), "\"run: \\\"now\\\"\"");
  EXPECT_EQ(after("pose", {{"x", 3}, {"a", "90 deg"}}), "{x: 3 m, a: 1.5707963267948966 rad}");
  EXPECT_EQ(after("pose", "{x: 1 km, a: 1 rad}"), "{x: 1000 m, a: 1 rad}");
  EXPECT_EQ(after("m", {{1, 2, 3}, {4, 5, 7}}), "[[1, 2, 3], [4, 5, 7]]");
  EXPECT_EQ(after("m", Json::array({1, 2, 3, 4, 5, 8})), "[[1, 2, 3], [4, 5, 8]]");
}

TEST_F(OperatorValues, WordsOfADescriptionReadBackTheSame) {
  for (const auto& [name, value] : std::map<std::string, Json>{
           {"speed", 0.1}, {"kp", {0.1, 1e300}}, {"n", -7}, {"m", {{1, 2, 3}, {4, 5, 6.5}}}, {"go", true}}) {
    const std::string words = after(name, value);
    EXPECT_EQ(after(name, words), words) << name;
  }
}

TEST_F(OperatorValues, RefusesInTheWordsOfTheRulesAndChangesNothing) {
  EXPECT_EQ(after("speed", "3 kg"),
            "speed: operator variable 'speed': expected a quantity in \"m/s\", found one in \"kg\"");
  EXPECT_NE(after("speed", 51).find("expected 0 to 50 m/s"), std::string::npos) << after("speed", 51);
  EXPECT_NE(after("kp", Json::array({1})).find("found a list of 1; expected 2"), std::string::npos);
  EXPECT_NE(after("speed", nullptr).find("speed"), std::string::npos);
  EXPECT_NE(after("n", 1.5).find("expected a whole number"), std::string::npos);
  EXPECT_NE(after("word", "a text that is far too long").find("at most 15"), std::string::npos);
  EXPECT_NE(after("pose", {{"x", 3}, {"b", 1}}).find("Spot has no field 'b'"), std::string::npos);
  EXPECT_NE(after("speed", "[1, 2").find("speed"), std::string::npos);
  EXPECT_FALSE(ask({{"speed", 1}, {"n", "much"}}));
}

}  // namespace
}  // namespace chimera::manager::operator_values_test
