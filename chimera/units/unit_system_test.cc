// SPDX-License-Identifier: Apache-2.0
#include "chimera/units/unit_system.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "chimera/units/testing/unit_samples.h"

namespace chimera {
namespace {

std::string refusal(std::string_view text) {
  const auto parsed = our_units().parse(text);
  return parsed ? "accepted" : std::string(parsed.error().message.view());
}

TEST(UnitSystem, NamesTheUnknownWordAndTheNearestUnit) {
  EXPECT_EQ(refusal("Nm"), "\"Nm\" is no known unit; did you mean \"N.m\"?");
  EXPECT_EQ(refusal("hz"), "\"hz\" is no known unit; did you mean \"Hz\"?");
  EXPECT_EQ(refusal("kg.m/sec"), "\"sec\" is no known unit; did you mean \"s\"?");
  EXPECT_EQ(refusal("RPM"), "\"RPM\" is no known unit; did you mean \"rpm\"?");
  EXPECT_EQ(refusal("kph"), "\"kph\" is no known unit; did you mean \"km/h\"?");
  EXPECT_EQ(refusal("kmh"), "\"kmh\" is no known unit; did you mean \"km/h\"?");
  EXPECT_EQ(refusal("radain"), "\"radain\" is no known unit; did you mean \"radian\"?");
  EXPECT_EQ(refusal("furlongs"), "\"furlongs\" is no known unit");
  EXPECT_EQ(refusal("hPa"), "\"hPa\" is no known unit; did you mean \"Pa\"?");
  EXPECT_EQ(refusal("ft"), "\"ft\" is no known unit; did you mean \"t\"?");
}

TEST(UnitSystem, RefusesTextThatBreaksTheGrammar) {
  EXPECT_EQ(refusal(""), "the unit is empty; write 1 for none");
  EXPECT_EQ(refusal("kg/m.s"),
            "unit \"kg/m.s\": a product after \"/\" can be read in two ways; write a/(b.c) or a.c/b");
  EXPECT_EQ(refusal("100 m"), "unit \"100 m\": expected a unit; 1 is the only number in one, found \"100 m\"");
  EXPECT_EQ(refusal("m/"), "unit \"m/\": expected a unit, found the end");
  EXPECT_EQ(refusal("m^"), "unit \"m^\": expected an exponent, found the end");
  EXPECT_EQ(refusal("m0"), "unit \"m0\": an exponent is from 1 to 30, positive or negative");
  EXPECT_EQ(refusal("m31"), "unit \"m31\": an exponent is from 1 to 30, positive or negative");
  EXPECT_EQ(refusal("m20.m20"), "unit \"m20.m20\": an exponent above 30");
  EXPECT_EQ(refusal("m)"), "unit \"m)\": expected a unit, \".\" or \"/\", found \")\"");
  EXPECT_EQ(refusal("(m"), "unit \"(m\": expected \")\", found the end");
  EXPECT_EQ(refusal("K @ 273"), "unit \"K @ 273\": expected a unit, found \"@ 273\"");
  EXPECT_EQ(refusal("seconds since 1970"), "\"since\" is no known unit");
  EXPECT_EQ(refusal("lg(re m)"), "\"lg\" is no known unit; did you mean \"kg\"?");
  EXPECT_EQ(refusal(std::string(9, '(') + "m"), "unit \"(((((((((m\": more than 8 parentheses in each other");
  EXPECT_EQ(refusal(std::string(101, 'm')), "a unit text of more than 100 bytes");
  EXPECT_EQ(refusal("U/s"), "unit \"U/s\": U, X, Y and Z are unit variables of generic ports");
}

TEST(UnitSystem, TheLettersOfVariablesAreNoUnits) {
  for (const char letter : kUnitVariables) {
    for (const std::string& name : our_units().names()) EXPECT_NE(name, std::string(1, letter));
  }
  EXPECT_EQ(refusal("V"), "accepted");
}

TEST(UnitSystem, EveryNameOfTheFileParses) {
  EXPECT_GT(our_units().names().size(), 50u);
  for (const std::string& name : our_units().names()) EXPECT_EQ(refusal(name), "accepted") << name;
}

TEST(UnitSystem, SaysWhereItLookedForTheFile) {
  const std::string files[] = {"/nowhere/a.xml", "/nowhere/b.xml"};
  const auto loaded = UnitSystem::load(files);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().message.view(), "no unit file; looked for /nowhere/a.xml /nowhere/b.xml");
}

TEST(UnitSystem, RefusesAnInvalidUnitFile) {
  const std::string files[] = {testing::TempDir() + "chimera_no_units.xml"};
  std::ofstream(files[0]) << "kind: not even XML\n";
  const auto loaded = UnitSystem::load(files);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().message.view(), "no unit file of UDUNITS-2 with the base unit rad");
  EXPECT_EQ(loaded.error().where.view(), files[0]);
}

TEST(UnitSystem, TheEnvironmentNamesTheFileFirst) {
  ASSERT_TRUE(our_units().parse("rad"));
  ::setenv("CHIMERA_UNITS", "/nowhere/mine.xml", 1);
  const std::string files[] = {our_units().file()};
  const auto loaded = UnitSystem::load(files);
  ::unsetenv("CHIMERA_UNITS");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().message.view(), "no unit file; looked for /nowhere/mine.xml");
}

}  // namespace
}  // namespace chimera
