// SPDX-License-Identifier: Apache-2.0
#include "chimera/bake/board_part.h"

#include <gtest/gtest.h>

#include "chimera/bake/bake.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/testing/sample_component.h"

namespace chimera::bake::board_part_test {

PortDescriptor port(std::string name, std::uint32_t kind, std::string unit = "1") {
  return {.name = std::move(name), .unit = std::move(unit), .kind = kind};
}

PortDescriptor device() {
  PortDescriptor made = port("device", CHIMERA_RESOURCE);
  made.type = CHIMERA_STRING;
  made.element_size = 64;
  return made;
}

const Library& library() {
  static const Library kLibrary = Library::of(
      {sample_component("source", {port("y", CHIMERA_OUT_VAR, "V")}),
       sample_component("axis", {port("y", CHIMERA_IN_VAR, "V"), port("q", CHIMERA_OUT_VAR, "rad")}),
       sample_component("sink", {port("q", CHIMERA_IN_VAR, "rad")}),
       sample_component("screen", {port("q", CHIMERA_IN_VAR, "rad"), device()})},
      our_units());
  return kLibrary;
}

constexpr const char* kTarget =
    "version: 1\ncpu: cortex-m3\nboard: mps2\nclock_hz: 25000000\nflash: {address: 0, size: 64 KiB}\n"
    "ram: {address: 0x20000000, size: 20 KiB}\ninterrupts: {rx: 1}\n";
constexpr const char* kUart = "uart: {address: 0x40004000, interrupt: rx, baud: 115200}\n";

Configuration whole(const std::string& link = "serial: /dev/ttyUSB0", const std::string& more = "") {
  const std::string text = "subsystem: s\nrtpus: {linux: {}, board: {target: t, link: {" + link +
                           ", rate: 10 Hz, stale_after: 500 ms}}}\n"
                           "tasks: {source: {rtpu: linux}, axis: {rtpu: board}, sink: {rtpu: linux}" + more + "}\n";
  Verdict verdict = verify(read_description(text, "s.yaml"), library());
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  return *verdict.configuration;
}

BakeResult baked(const Configuration& all, const std::string& target_text) {
  const Verdict part = board_part(all, RtpuId(1u), library());
  EXPECT_TRUE(part.configuration) << part.report.text();
  const ReadTarget target = read_target(target_text, "t.yaml", {});
  EXPECT_TRUE(target.target) << target.report.text();
  return bake({.configuration = *part.configuration,
               .target = *target.target,
               .target_file = "t.yaml",
               .library = library(),
               .acts = {},
               .link = all.rtpus()[1].link});
}

TEST(BoardPart, HasItsTasksAndReadsTheRestAsOperatorVariables) {
  const Verdict part = board_part(whole(), RtpuId(1u), library());
  ASSERT_TRUE(part.configuration) << part.report.text();
  const ApplicationSpec& spec = part.configuration->spec();
  ASSERT_EQ(spec.tasks.size(), 1u);
  EXPECT_EQ(spec.tasks[0].name, "axis");
  ASSERT_EQ(spec.operators.size(), 1u);
  EXPECT_EQ(spec.operators[0].name, "y");
  EXPECT_FALSE(spec.rtpus[0].link.is_there());
}

TEST(BoardPart, IsBakedWithItsLinkAndNothingIsOnAtTheStart) {
  const BakeResult result = baked(whole(), std::string(kTarget) + kUart);
  ASSERT_TRUE(result.is_baked()) << result.description.text() << result.target.text();
  const auto text = [&](const std::string& name) {
    for (const BakedFile& file : result.files)
      if (file.name == name) return file.text;
    return std::string();
  };
  EXPECT_NE(text("tables.cc").find(".link_period = {100000000}"), std::string::npos) << text("tables.cc");
  EXPECT_EQ(text("tables.cc").find(".start = "), std::string::npos);
  EXPECT_NE(text("mechanisms.h").find("kLink = true"), std::string::npos);
}

TEST(BoardPart, IsRefusedWithoutASerialLineOrWithAnotherSpeed) {
  EXPECT_FALSE(baked(whole(), kTarget).is_baked());
  const BakeResult other = baked(whole("serial: /dev/ttyUSB0, baud: 9600"), std::string(kTarget) + kUart);
  EXPECT_FALSE(other.is_baked());
  EXPECT_NE(other.description.text().find("has 9600 baud, and 'uart' of the target 't' has 115200"), std::string::npos)
      << other.description.text();
  EXPECT_TRUE(baked(whole("udp: '10.0.0.1:5000', baud: 9600"), std::string(kTarget) + kUart).is_baked())
      << "UDP has no speed";
}

TEST(BoardPart, IsRefusedIfATaskHasTheSerialLine) {
  const BakeResult result = baked(
      whole("serial: /dev/ttyUSB0", ", screen: {rtpu: board, resources: {device: x}}"),
      std::string(kTarget) + kUart + "resources: {screen: {device: uart}}\n");
  EXPECT_EQ(result.target.text(),
            "t.yaml:9:30: error: 'uart' belongs to task 'screen', and the image has a link [resource-twice]\n"
            "  take 'link' or the task out of the description\n");
}

}  // namespace chimera::bake::board_part_test
