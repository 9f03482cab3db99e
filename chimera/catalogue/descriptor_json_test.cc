// SPDX-License-Identifier: Apache-2.0
#include "chimera/catalogue/descriptor_json.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace chimera {
namespace {

template <class T>
std::vector<std::byte> bytes(std::initializer_list<T> values) {
  std::vector<std::byte> out(values.size() * sizeof(T));
  std::memcpy(out.data(), std::data(values), out.size());
  return out;
}

/// A descriptor with one port for every kind of content.
Descriptor rich() {
  Descriptor d;
  d.name = "rich";
  d.doc = "One of each \"kind\".";
  d.source = "1994 paper";
  d.default_rate_hz = 1.0 / 3;
  d.state_size = 640;
  d.state_align = 16;
  d.methods[CHIMERA_ON] = d.methods[CHIMERA_CYCLE] = true;
  d.background = true;
  PortDescriptor q{.name = "q", .doc = "\xc2\xb5", .unit = "rad", .shape = "[ndof<=3]", .frame = "base"};
  PortDescriptor tau{.name = "tau", .unit = "N.m", .kind = CHIMERA_OUT_VAR, .safety = true, .has_range = true};
  tau.min = -0.1;
  tau.max = std::numeric_limits<double>::infinity();
  tau.initial = bytes({0.1});
  PortDescriptor ndof{.name = "ndof", .kind = CHIMERA_IN_CONST, .type = CHIMERA_INT32, .element_size = 4};
  ndof.initial = bytes<std::int32_t>({3});
  PortDescriptor big{.name = "big", .shape = "[2]", .kind = CHIMERA_IN_CONST, .type = CHIMERA_INT64};
  big.initial = bytes<std::int64_t>({INT64_MIN, INT64_MAX});
  PortDescriptor bigger = big;
  bigger.name = "bigger";
  bigger.at_least = "big";
  PortDescriptor narrow{.name = "narrow", .kind = CHIMERA_OUT_VAR, .type = CHIMERA_FLOAT32, .element_size = 4};
  narrow.initial = bytes<float>({0.1f});
  PortDescriptor label{.name = "label", .kind = CHIMERA_IN_CONST, .type = CHIMERA_STRING, .element_size = 8};
  label.initial = bytes<char>({'a', '"', '\\', 0, 0, 0, 0, 0});
  PortDescriptor mode = label;
  mode.name = "mode";
  mode.one_of = {"a\"\\", "b"};
  PortDescriptor many{.name = "many", .unit = "U/s", .type_name = "T", .type = CHIMERA_ANY, .repeated = true};
  many.max_instances = 4;
  PortDescriptor pose{.name = "pose", .type_name = "P", .kind = CHIMERA_OUT_VAR, .type = CHIMERA_STRUCT};
  pose.element_size = 24;
  pose.fields = {{"ok", "1", CHIMERA_BOOL, 0, 1, 1}, {"xy", "m", CHIMERA_FLOAT64, 8, 2, 8}};
  pose.initial = bytes<double>({0, -0.0, 1e-300});
  pose.initial[0] = std::byte{1};
  PortDescriptor file{.name = "file", .kind = CHIMERA_RESOURCE, .type = CHIMERA_STRING, .element_size = 256};
  file.safe_state = true;
  PortDescriptor held{.name = "held", .kind = CHIMERA_OUT_VAR, .type = CHIMERA_BOOL, .element_size = 1};
  held.safe_state = true;
  d.ports = {held, q, tau, ndof, big, bigger, narrow, label, mode, many, pose, file};
  const auto sound = complete(d);
  EXPECT_TRUE(sound) << (sound ? "" : sound.error().message.c_str());
  return d;
}

std::string refusal(const std::string& text) {
  const auto parsed = parse_descriptor(text);
  return parsed ? "accepted" : std::string(parsed.error().message.view());
}

/// A small legal file in which `from` is replaced by `to`.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = R"({"format": 1, "name": "gain", "abi_version": 1, "default_rate_hz": 0, "state_size": 8,
    "state_align": 8, "methods": ["cycle"], "ports": [{"name": "y", "kind": "out-var", "type": "float64",
    "element_size": 8, "unit": "U", "shape": "", "initial": [0]}]})";
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(DescriptorJson, ComesBackEqualToTheLastBit) {
  const Descriptor before = rich();
  const std::string text = to_json(before);
  const auto after = parse_descriptor(text);
  ASSERT_TRUE(after) << after.error().message.view();
  EXPECT_EQ(after.value(), before);
  EXPECT_EQ(to_json(after.value()), text);
  EXPECT_EQ(fingerprint(after.value()), fingerprint(before));
}

TEST(DescriptorJson, AcceptsTheSmallestFile) { EXPECT_EQ(refusal(changed("\"U\"", "\"m\"")), "accepted"); }

TEST(DescriptorJson, NamesUnknownMissingAndRepeatedKeys) {
  EXPECT_EQ(refusal(changed("\"unit\"", "\"unti\"")), "$.ports[0]: unknown key \"unti\"; did you mean \"unit\"?");
  EXPECT_EQ(refusal(changed("\"state_size\": 8,", "")), "$: the key \"state_size\" is missing");
  EXPECT_EQ(refusal(changed("\"unit\": \"U\"", "\"unit\": \"U\", \"unit\": \"U\"")),
            "$: the key \"unit\" comes twice in one object");
}

TEST(DescriptorJson, NamesWrongTypesWithTheirPath) {
  EXPECT_EQ(refusal(changed("\"element_size\": 8", "\"element_size\": \"8\"")),
            "$.ports[0].element_size: expected a whole number from 0 to 4294967295, found \"8\"");
  EXPECT_EQ(refusal(changed("\"element_size\": 8", "\"element_size\": -1")),
            "$.ports[0].element_size: expected a whole number from 0 to 4294967295, found a whole number");
  EXPECT_EQ(refusal(changed("\"U\"", "7")), "$.ports[0].unit: expected a text, found a whole number");
  EXPECT_EQ(refusal(changed("[\"cycle\"]", "\"cycle\"")), "$.methods: expected a list, found \"cycle\"");
  EXPECT_EQ(refusal(changed("out-var", "outvar")),
            "$.ports[0].kind: no kind is called \"outvar\"; did you mean \"out-var\"?");
  EXPECT_EQ(refusal(changed("\"format\": 1", "\"format\": 2")), "$.format: this reader knows format 1");
  EXPECT_EQ(refusal(changed("[0]", "[true]")), "$.ports[0].initial[0]: the value does not fit a float64");
  EXPECT_EQ(refusal(changed("[0]", "[null]")), "$.ports[0].initial[0]: expected a number, found null");
  EXPECT_EQ(refusal("[]"), "$: expected an object, found a list");
}

TEST(DescriptorJson, KeepsTheRulesOfDeclarations) {
  EXPECT_EQ(refusal(changed("\"element_size\": 8", "\"element_size\": 4")),
            "$.ports[0]: port y: float64 takes 8 bytes, declared are 4");
  EXPECT_EQ(refusal(changed("\"shape\": \"\"", "\"shape\": \"[n]\"")),
            "$.ports[0]: port y: shape \"[n]\": the extent n needs a maximum, as in [n<=16]");
  EXPECT_EQ(refusal(changed("[0]", "[0, 1]")),
            "$: component gain: port y: initial value of 2 elements; expected 1 or 1");
  EXPECT_EQ(refusal(changed("[\"cycle\"]", "[]")), "$: component gain: has no cycle method");
}

TEST(DescriptorJson, NoticesAFileChangedByHand) {
  std::string text = to_json(rich());
  text.replace(text.find("\"N.m\""), 5, "\"J\"");
  EXPECT_TRUE(refusal(text).starts_with("$.fingerprint: the file was changed: its content gives "));
}

TEST(DescriptorJson, RefusesHostileText) {
  EXPECT_EQ(refusal(std::string(300'000, ' ')), "$: 300000 bytes, at most 262144 are allowed");
  EXPECT_EQ(refusal(std::string(200'000, '[')), "$: nested deeper than 32");
  EXPECT_TRUE(refusal("{").starts_with("$: parse error at line 1, column 2: "));
  EXPECT_TRUE(refusal("\"\xff\"").starts_with("$: parse error at line 1, column 2: "));
  EXPECT_NE(refusal(changed("\"default_rate_hz\": 0", "\"default_rate_hz\": 1e999")), "accepted");
  EXPECT_EQ(refusal(changed("\"default_rate_hz\": 0", "\"default_rate_hz\": \"inf\"")),
            "$: component gain: default rate inf Hz is not from 1/3600 to 1000000 Hz");
}

TEST(DescriptorJson, NamesTheFileThatCannotBeRead) {
  const auto read = read_descriptor_file("/nowhere/gain.component.json");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().where.view(), "/nowhere/gain.component.json");
  EXPECT_EQ(read.error().message.view(), "cannot be opened: No such file or directory");
}

}  // namespace
}  // namespace chimera
