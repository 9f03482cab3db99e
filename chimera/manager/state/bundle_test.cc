// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/bundle.h"

#include <gtest/gtest.h>

#include <cstring>

#include "chimera/manager/testing/test_bundle.h"

namespace chimera::manager {
namespace {

constexpr const char* kText = R"(subsystem: small
rtpus: {servo: {cpu: 1, policy: muf}}
tasks:
  counter: {component: t_counter, rtpu: servo, rate: 3 Hz}
)";

Bundle sample() { return {"0.1.0", "small.yaml", kText, 7, std::nullopt, 9, test_library()}; }

TEST(Bundle, ReadsBackAsItWas) {
  const Bundle made = sample();
  const auto read = decode_bundle(encode(made));
  ASSERT_TRUE(read) << read.error().message.c_str();
  EXPECT_EQ(read->program, "0.1.0");
  EXPECT_EQ(read->file, "small.yaml");
  EXPECT_EQ(read->description, kText);
  EXPECT_EQ(read->observe_group, 7u);
  EXPECT_EQ(read->operate_group, std::nullopt);
  EXPECT_EQ(read->configure_group, 9u);
  EXPECT_EQ(read->library.units().text(), made.library.units().text());
  EXPECT_EQ(read->library.units().file(), made.library.units().file());
  ASSERT_EQ(read->library.entries().size(), made.library.entries().size());
  ASSERT_GT(made.library.entries().size(), 0u);
  for (std::size_t i = 0; i < made.library.entries().size(); ++i) {
    const LibraryEntry &a = made.library.entries()[i], &b = read->library.entries()[i];
    EXPECT_EQ(a.descriptor, b.descriptor) << a.descriptor.name;
    EXPECT_EQ(a.descriptor_file, b.descriptor_file);
    EXPECT_EQ(a.object_file, b.object_file);
  }
  EXPECT_EQ(encode(*read), encode(made));
}

TEST(Bundle, GivesTheSameConfigurationWithoutTheFiles) {
  const Bundle made = sample();
  const Verdict before = verify(made);
  const auto read = decode_bundle(encode(made));
  ASSERT_TRUE(read);
  const Verdict after = verify(*read);
  ASSERT_TRUE(before.configuration) << before.report.text();
  ASSERT_TRUE(after.configuration) << after.report.text();
  EXPECT_EQ(before.report.json(), after.report.json());
  const ApplicationSpec &a = before.configuration->spec(), &b = after.configuration->spec();
  ASSERT_EQ(a.tasks.size(), b.tasks.size());
  EXPECT_EQ(a.tasks[0].period, b.tasks[0].period);
  ASSERT_EQ(a.tasks[0].ports.size(), b.tasks[0].ports.size());
  for (std::size_t p = 0; p < a.tasks[0].ports.size(); ++p) {
    const PortSpec &x = a.tasks[0].ports[p], &y = b.tasks[0].ports[p];
    EXPECT_EQ(x.variable, y.variable);
    ASSERT_EQ(x.value.size(), y.value.size());
    EXPECT_TRUE(x.value.empty() || std::memcmp(x.value.data(), y.value.data(), x.value.size()) == 0);
  }
}

TEST(Bundle, ZerosBehindItAreTheRestOfAPage) {
  std::string text = encode(sample());
  text.append(1000, '\0');
  EXPECT_TRUE(decode_bundle(text));
}

TEST(Bundle, ATextThatIsNoUtf8ComesBackByteForByte) {
  Bundle made = sample();
  made.file = "caf\xe9.yaml";
  const auto read = decode_bundle(encode(made));
  ASSERT_TRUE(read) << read.error().message.c_str();
  EXPECT_EQ(read->file, "caf\xe9.yaml");
}

TEST(Bundle, WithoutADescriptionTheSubsystemIsIdle) {
  Bundle made = sample();
  made.file = made.description = "";
  const auto read = decode_bundle(encode(made));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->is_idle());
}

TEST(Bundle, RefusesAnotherVersion) {
  std::string text = encode(sample());
  text.replace(text.find("\"version\":1"), 11, "\"version\":2");
  const auto read = decode_bundle(text);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message.view(), "version 2, this program reads 1");
}

TEST(Bundle, RefusesAnInvalidDescriptorAndNamesItsFile) {
  const std::string file = "/x/odd.component.json";
  std::string text = encode(sample());
  const std::string list = "\"components\":[";
  text.insert(text.find(list) + list.size(), R"({"descriptor":"[]","file":")" + file + R"(","object":""},)");
  const auto read = decode_bundle(text);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().where.view(), file);
}

TEST(Bundle, CutShortAnywhereItIsRefused) {
  const std::string text = encode({"0.1.0", "", "", {}, {}, {}, Library::of_entries({}, test_library().units())});
  ASSERT_TRUE(decode_bundle(text));
  for (std::size_t n = 0; n < text.size(); n += 97) EXPECT_FALSE(decode_bundle(text.substr(0, n))) << n;
}

}  // namespace
}  // namespace chimera::manager
