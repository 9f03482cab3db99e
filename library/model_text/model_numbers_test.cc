// SPDX-License-Identifier: Apache-2.0
#include "library/model_text/model_numbers.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "library/mujoco/simulated_arm.h"

namespace chimera::library {
namespace {

// A test replaces the numbers after an @ by bad ones.
constexpr char kUrdf[] = R"(<?xml version="1.0"?>
<!-- nan="nan" <axis xyz="nan"/> -->
<robot name="nan">
  <link name="a"/>
  <link name="inf">
    <inertial><mass value="@2"/><origin xyz="0 0 @.5" rpy="0 @0 0"/>
      <inertia ixx="@.1" iyy="@.1" izz="@+.1" ixy="@0" ixz="@0" iyz="@-0e0"/></inertial>
    <collision><origin xyz="@0 0 0" rpy="0 0 @0"/><geometry><box size="1 @1 1"/></geometry></collision>
    <collision><geometry><cylinder radius="@.1" length="@1."/></geometry></collision>
    <collision><geometry><sphere radius="@1e-1"/></geometry></collision>
  </link>
  <joint name="j" type="revolute"><parent link="a"/><child link="inf"/>
    <origin xyz="0 0 @1" rpy="@0 0 0"/><axis xyz="0 @1 0"/>
    <limit lower="@-1" upper="@1" effort="@5" velocity="@1"/><dynamics damping="@.1" friction="@0"/></joint>
</robot>)";

constexpr char kMjcf[] = R"(<mujoco model="nan">
  <compiler angle="radian" boundmass="@0"/><option timestep="@0.001" gravity="0 0 @-9.81" iterations="@50"><flag
    gravity="enable"/></option>
  <visual><rgba joint="@1 0 0 1"/></visual>
  <default><joint damping="@.1"/><geom solref="@.02 1"/></default>
  <worldbody><body name="nan" pos="0 @0 1" quat="1 0 0 @0">
    <joint name="j" axis="@0 1 0" limited="true" range="-1 @1" armature="@.1" group="@1" stiffness="@0"/>
    <inertial pos="0 0 @.1" mass="@1" diaginertia="1 1 @1"/>
    <geom name="inf" type="capsule" fromto="0 0 0 1 @0 0" size="@.1" contype="@0" conaffinity="@0" friction="@1"/>
  </body></worldbody>
  <actuator><motor joint="j" gear="@50" ctrllimited="true" ctrlrange="-2 @2"/></actuator>
  <custom><text name="t" data="nan"/><numeric name="n" data="1 @2"/></custom></mujoco>)";

struct ModelNumbers : ::testing::Test {
  std::string path = testing::TempDir() + "numbers_" + std::to_string(::getpid()) + ".xml";
  ~ModelNumbers() override { ::unlink(path.c_str()); }

  std::string refusal(const std::string& text) {
    std::ofstream(path) << text;
    const Result<void> sound = check_model_numbers(path);
    return sound ? "sound" : std::string(sound.error().message.view()).substr(path.size());
  }
  bool loads(const std::string& text) {
    std::ofstream(path) << text;
    SimulatedArm arm;
    return static_cast<bool>(arm.load(path.c_str()));
  }
  /// Replaces the number after @ number `which` by `word`; "" if there are fewer.
  static std::string with(const std::string& marked, std::size_t which, const std::string& word) {
    std::string text;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (marked[i] != '@') {
        text += marked[i];
      } else if (seen++ == which) {
        text += word;
        i = marked.find_first_of(" \"", i) - 1;
      }
    }
    return seen > which ? text : "";
  }
  static std::string sound(const std::string& marked) {
    std::string text = marked;
    std::erase(text, '@');
    return text;
  }
};

TEST_F(ModelNumbers, SoundFilesPassAndLoadNamesCalledNanToo) {
  EXPECT_EQ(refusal(sound(kUrdf)), "sound");
  EXPECT_EQ(refusal(sound(kMjcf)), "sound");
  EXPECT_TRUE(loads(sound(kUrdf)));
  EXPECT_TRUE(loads(sound(kMjcf)));
}

TEST_F(ModelNumbers, RefusesANonFiniteNumberInEveryAttribute) {
  std::size_t files = 0;
  for (const std::string marked : {kUrdf, kMjcf}) {
    for (const std::string word : {"nan", "-NaN", "inf", "+Infinity", "&#110;an", "nan(1)"}) {
      for (std::size_t i = 0; !with(marked, i, word).empty(); ++i, ++files) {
        const std::string said = refusal(with(marked, i, word));
        EXPECT_NE(said.find("found '" + word + "', expected a finite number; write one, or leave the attribute out"),
                  std::string::npos) << word << " as number " << i << ": " << said;
      }
    }
  }
  EXPECT_EQ(files, 294u);
}

// Either check_model_numbers or MuJoCo refuses each of these files.
TEST_F(ModelNumbers, GarbageAndMissingNumbersMakeNoArm) {
  std::size_t files = 0;
  for (const std::string marked : {kUrdf, kMjcf}) {
    for (const std::string word : {"x", "1x", "0x10", "1,2", "1e999", "--1"}) {
      for (std::size_t i = 0; !with(marked, i, word).empty(); ++i, ++files) {
        EXPECT_FALSE(loads(with(marked, i, word))) << word << " as number " << i;
      }
    }
  }
  for (std::size_t i = 0; !with(kUrdf, i, "").empty(); ++i) EXPECT_FALSE(loads(with(kUrdf, i, ""))) << i;
  EXPECT_EQ(files, 294u);
}

TEST_F(ModelNumbers, NamesFileLineElementAndTheExpectation) {
  EXPECT_EQ(refusal("<robot name='r'>\n<joint name='elbow'>\n<axis xyz='0 nan 0'/></joint></robot>"),
            ":3: attribute 'xyz' of <axis>: found 'nan', expected a finite number; write one, or leave the attribute "
            "out");
  EXPECT_EQ(refusal("<robot><origin xyz='0 0'/></robot>"),
            ":1: attribute 'xyz' of <origin>: found 2 numbers, expected 3");
  EXPECT_EQ(refusal("<robot><mass value=''/></robot>"),
            ":1: attribute 'value' of <mass>: found 0 numbers, expected 1");
  EXPECT_EQ(refusal("<mujoco><joint name='elbow' group='1.5'/></mujoco>"),
            ":1: attribute 'group' of <joint> 'elbow': found '1.5', expected a whole number");
  EXPECT_EQ(refusal("<mujoco><joint axis='0 1'/></mujoco>"),
            ":1: attribute 'axis' of <joint>: found 2 numbers, expected 3");
}

TEST_F(ModelNumbers, LooksIntoIncludedFilesAndEndsWhereOneIncludesItself) {
  const std::string inner = testing::TempDir() + "numbers_inner_" + std::to_string(::getpid()) + ".xml";
  std::ofstream(inner) << "<mujoco>\n<joint axis='0 inf 0'/></mujoco>";
  std::ofstream(path) << "<mujoco><include file='" + inner.substr(inner.rfind('/') + 1) + "'/></mujoco>";
  const Result<void> read = check_model_numbers(path);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message.view(), inner + ":2: attribute 'axis' of <joint>: found 'inf', expected a finite "
                                                 "number; write one, or leave the attribute out");
  ::unlink(inner.c_str());
  EXPECT_EQ(refusal("<mujoco><include file='" + path + "'/></mujoco>"), "sound");
}

TEST_F(ModelNumbers, TextThatIsNoXmlIsLeftToMujoco) {
  for (const char* text : {"", "<", "<a", "<a b", "<a b=", "<a b='", "<!--", "<a b=c d='nan'/>", "</", "<?"})
    EXPECT_EQ(refusal(text), "sound") << text;
}

// Every attribute of MuJoCo's schema is either in a list here or holds numbers.
TEST_F(ModelNumbers, TheKindOfEveryAttributeOfTheSchemaIsKnown) {
  std::vector<char> schema(200000);
  ASSERT_GT(mj_printSchema(nullptr, schema.data(), static_cast<int>(schema.size()), 0, 0), 0);
  std::istringstream lines{std::string(schema.data())};  // "element (*)  attribute attribute", or attributes alone
  std::set<std::string> texts, numbers;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line.find(')') == std::string::npos ? line : line.substr(line.rfind(')') + 1)};
    for (std::string word; words >> word;) {
      const bool is_text = refusal("<mujoco><x " + word + "='nan'/></mujoco>") == "sound";
      (is_text ? texts : numbers).insert(word);
    }
  }
  EXPECT_TRUE(numbers.contains("damping") && numbers.contains("fullinertia") && numbers.contains("springref"));
  EXPECT_TRUE(texts.contains("childclass") && texts.contains("sidesite"));
  EXPECT_LT(texts.size(), 50u);
  EXPECT_GT(numbers.size(), 150u);
}

}  // namespace
}  // namespace chimera::library
