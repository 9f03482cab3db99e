// SPDX-License-Identifier: Apache-2.0
// Values as witnesses of units: in random legal descriptions one wrong value gives one error, at its own place.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/setting.h"
#include "chimera/verify/verify.h"
#include "chimera/verify/testing/sample_component.h"

namespace chimera {
namespace {

PortDescriptor vote_port(std::string name, std::uint32_t kind, std::string unit) {
  return {.name = std::move(name), .unit = std::move(unit), .kind = kind};
}

/// A generic controller; `integral` is its gain of the integral.
Descriptor law(std::string name, PortDescriptor integral) {
  return sample_component(std::move(name), {vote_port("reference", CHIMERA_IN_VAR, "U"),
                                          vote_port("measured", CHIMERA_IN_VAR, "U"),
                                          vote_port("kp", CHIMERA_IN_VAR, "X/U"), std::move(integral),
                                          vote_port("low", CHIMERA_IN_CONST, "X"),
                                          vote_port("high", CHIMERA_IN_CONST, "X"),
                                          vote_port("u", CHIMERA_OUT_VAR, "X")});
}

const Library& vote_library() {
  static const Library kLibrary = [] {
    PortDescriptor optional = vote_port("ki", CHIMERA_IN_VAR, "X/(U.s)");
    optional.initial.resize(8);
    return Library::of({law("law", vote_port("ki", CHIMERA_IN_VAR, "X/(U.s)")), law("easy_law", optional),
                        sample_component("encoder", {vote_port("angle", CHIMERA_OUT_VAR, "rad")})},
                       our_units());
  }();
  return kLibrary;
}

constexpr std::array<const char*, 7> kUnits = {"rad", "m", "V", "N.m", "A", "K", "rad/s"};

/// A cascade of laws: the output of each is the measured value of the next.
struct Cascade {
  struct Value {
    std::string name, unit;
    std::size_t law = 0;
    bool is_constant = false;
  };
  std::vector<Value> values;
  std::size_t laws = 0;
  bool has_encoder = false;

  /// The description. The value number `wrong` is written as `instead`.
  std::string text(std::size_t wrong = SIZE_MAX, const std::string& instead = {}) const {
    std::string all = "subsystem: cascade\ntasks:\n";
    if (has_encoder) all += "  encoder: {alias: {angle: u0}}\n";
    const auto written = [&](std::size_t v) {
      return values[v].name + ": " + (v == wrong ? instead : std::to_string(v) + " " + values[v].unit);
    };
    for (std::size_t i = 1; i <= laws; ++i) {
      const std::string n = std::to_string(i);
      all += "  law" + n + ":\n    component: law\n    alias: {reference: r" + n + ", measured: u" +
             std::to_string(i - 1) + ", kp: kp" + n + ", ki: ki" + n + ", u: u" + n + "}\n    constants:\n";
      for (std::size_t v = 0; v < values.size(); ++v)
        if (values[v].is_constant && values[v].law == i) all += "      " + written(v) + "\n";
    }
    all += "operator:\n";
    for (std::size_t v = 0; v < values.size(); ++v)
      if (!values[v].is_constant) all += "  " + written(v) + "\n";
    return all;
  }
};

Cascade random_cascade(std::mt19937& random) {
  Cascade made;
  made.laws = 1 + random() % 5;
  made.has_encoder = random() % 2 == 0;
  std::string in = made.has_encoder ? "rad" : kUnits[random() % kUnits.size()];
  if (!made.has_encoder) made.values.push_back({"u0", in});
  for (std::size_t i = 1; i <= made.laws; ++i) {
    const std::string n = std::to_string(i), out = kUnits[random() % kUnits.size()];
    made.values.push_back({"r" + n, in});
    made.values.push_back({"kp" + n, "(" + out + ")/(" + in + ")"});
    made.values.push_back({"ki" + n, "(" + out + ")/(s.(" + in + "))"});
    made.values.push_back({"low", out, i, true});
    made.values.push_back({"high", out, i, true});
    in = out;
  }
  std::ranges::shuffle(made.values, random);
  return made;
}

/// "LINE:COLUMN" of `part` in `text`.
std::string place_in(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part), line = text.rfind('\n', at);
  return std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')) + ":" +
         std::to_string(at - line);
}

/// "LINE:COLUMN RULE" of each error.
std::string vote_errors(const std::string& text) {
  std::string all;
  const Report report = verify(read_description(text, "c.yaml"), vote_library()).report;
  for (const Fault& fault : report.faults())
    append_joined(all, ", ", std::to_string(fault.at.line) + ":" + std::to_string(fault.at.column) + " " +
                                 std::string(fault.rule));
  return all;
}

TEST(UnitVotes, OneWrongValueGivesOneErrorAtItsPlace) {
  const unsigned seed = 20261128;
  std::mt19937 random(seed);
  for (int round = 0; round < 300; ++round) {
    const Cascade cascade = random_cascade(random);
    const std::string shown = "seed " + std::to_string(seed) + ", round " + std::to_string(round) + "\n";
    ASSERT_EQ(vote_errors(cascade.text()), "") << shown << cascade.text();
    const std::size_t wrong = random() % cascade.values.size();
    const std::string& unit = cascade.values[wrong].unit;
    const bool is_plain = random() % 2 == 0 && !our_units().parse(unit).value().is_dimensionless();
    const std::string text = cascade.text(wrong, is_plain ? "7777" : "7777 kg.(" + unit + ")");
    ASSERT_EQ(vote_errors(text), place_in(text, "7777") + " value-unit") << shown << text;
  }
}

TEST(UnitVotes, ANewValueIsComparedWithTheUnitOfTheStartAlone) {
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    const Cascade cascade = random_cascade(random);
    const auto start = verify(read_description(cascade.text(), "c.yaml"), vote_library()).configuration;
    ASSERT_TRUE(start);
    for (const Cascade::Value& value : cascade.values) {
      const Unit unit = our_units().parse(value.unit).value();
      if (value.is_constant || unit.is_dimensionless()) continue;
      const auto set = with_new_value(*start, vote_library(), {value.name, "20", "set " + value.name + " 20"});
      ASSERT_FALSE(set) << value.name;
      const std::string said = set.error().message.c_str(), head = "set " + value.name + " 20: operator variable '" +
                               value.name + "': expected a quantity in \"", tail = "\", found a number without unit";
      ASSERT_TRUE(said.starts_with(head) && said.ends_with(tail)) << said;
      const std::string named = said.substr(head.size(), said.size() - head.size() - tail.size());
      EXPECT_TRUE(same(our_units().parse(named).value(), unit)) << said;
    }
  }
}

constexpr const char* kThreeLaws =
    "subsystem: cascade\n"
    "tasks:\n"
    "  encoder: {alias: {angle: u0}}\n"
    "  a: {component: LAW, alias: {measured: u0, u: u1, kp: kp_a}, constants: {low: -1 rad/s, high: 1 rad/s}}\n"
    "  b: {component: LAW, alias: {reference: u1, measured: w, u: u2, kp: kp_b}, constants: {low: -9 A, high: 9 A}}\n"
    "  c: {component: LAW, alias: {reference: u2, measured: i, u: u3, kp: kp_c}, constants: {low: -24 V, high: 24 V}}\n"
    "operator: {reference: 1 rad, w: 0 rad/s, i: 0 A, kp_a: 30 1/s, kp_b: 1 A.s/rad, kp_c: 1.6 V/A}\n";

std::string of_laws(std::string component) {
  std::string text = kThreeLaws;
  for (std::size_t at; (at = text.find("LAW")) != std::string::npos;) text.replace(at, 3, component);
  return text;
}

TEST(UnitVotes, AnInputWithoutAProducerJoinsNoOtherOfItsName) {
  EXPECT_EQ(vote_errors(of_laws("law")), "4:3 input-unmet, 5:3 input-unmet, 6:3 input-unmet");
  const std::string said = verify(read_description(of_laws("law"), "c.yaml"), vote_library()).report.text();
  const std::string unmet = "input 'ki' of task 'c' has no producer in configuration 'all'; it is in V/(A.s)";
  EXPECT_NE(said.find(unmet), std::string::npos) << said;
  EXPECT_EQ(said.find("did you mean"), std::string::npos) << "kp_c has another unit\n" << said;
}

TEST(UnitVotes, AnOptionalInputThatNothingIsConnectedToHasItsDefault) {
  const auto made = verify(read_description(of_laws("easy_law"), "c.yaml"), vote_library()).configuration;
  ASSERT_TRUE(made) << vote_errors(of_laws("easy_law"));
  std::string defaults;
  for (const ConfiguredVariable& variable : made->variables())
    if (variable.name.find('.') != std::string::npos)
      append_joined(defaults, ", ", variable.name + " " + variable.unit);
  EXPECT_EQ(defaults, "a.ki 1/s2, b.ki A/rad, c.ki V/(A.s)");
  const auto set = with_new_value(*made, vote_library(), {"a.ki", "1 1/s2", "set a.ki '1 1/s2'"});
  ASSERT_FALSE(set);
  EXPECT_STREQ(set.error().message.c_str(),
               "set a.ki '1 1/s2': 'a.ki' is the default of an input: write 'ki' under operator: to set it");
  // An alias says that the input is meant: then it needs a producer.
  std::string meant = of_laws("easy_law");
  meant.replace(meant.find("kp: kp_a"), 8, "kp: kp_a, ki: ki_a");
  EXPECT_EQ(vote_errors(meant), place_in(meant, "ki_a") + " input-unmet");
}

TEST(UnitVotes, AGenericUnitHasTheWordsOfTheDescription) {
  const auto made = verify(read_description(of_laws("easy_law"), "c.yaml"), vote_library()).configuration;
  ASSERT_TRUE(made);
  for (const auto& [name, unit] : {std::pair{"kp_c", "V/A"}, {"kp_b", "A.s/rad"}, {"kp_a", "1/s"}, {"u3", "V"}})
    EXPECT_EQ(std::ranges::find(made->variables(), name, &ConfiguredVariable::name)->unit, unit) << name;
}

TEST(UnitVotes, AValueThatCannotBeReadIsTheCauseAndReportedAlone) {
  const std::string text = "subsystem: s\ntasks:\n  law: {constants: {low: -1, high: 1}}\noperator:\n"
                           "  reference: 2 Vs\n  measured: 3 RPM\n  kp: 1_000 1/Vs\n  ki: 2 Vs\n";
  EXPECT_EQ(vote_errors(text), "5:14 quantity-bad, 6:13 quantity-bad, 7:7 quantity-bad, 8:7 quantity-bad");
}

}  // namespace
}  // namespace chimera
