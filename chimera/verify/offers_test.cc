// SPDX-License-Identifier: Apache-2.0
// Offered edits: each leaves a text that is better, and what would not help is not offered.
#include "chimera/verify/offers.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/library.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/testing/sample_component.h"

namespace chimera {
namespace {

PortDescriptor port_in(std::string name, std::string unit) {
  return {.name = std::move(name), .unit = std::move(unit)};
}
PortDescriptor port_out(std::string name, std::string unit) {
  return {.name = std::move(name), .unit = std::move(unit), .kind = CHIMERA_OUT_VAR};
}
PortDescriptor ports_in(std::string name, std::string unit) {
  return {.name = std::move(name), .unit = std::move(unit), .repeated = true, .max_instances = 16};
}

const Library& offers_library() {
  static const Library kLibrary = Library::of(
      {sample_component("arm", {port_out("q", "rad"), port_out("qd", "rad/s")}),
       sample_component("law", {port_in("q", "rad"), port_in("kd", "V.s/rad"), port_out("u", "V")}),
       sample_component("gauge", {port_in("angle", "rad")}), sample_component("follower", {port_in("q_ref", "rad")}),
       sample_component("slow", {port_in("q", "deg")}),
       sample_component("deg", {port_in("x", "rad"), port_out("y", "deg")}, 0),
       sample_component("norate", {port_in("q", "rad")}, 0),
       sample_component("camera",
                        {{.name = "eye", .kind = CHIMERA_RESOURCE, .type = CHIMERA_STRING, .element_size = 256}}),
       sample_component("plant", {port_in("u", "V"), port_out("q", "rad")}),
       sample_component(
           "chain", {{.name = "mass", .unit = "kg", .kind = CHIMERA_IN_CONST, .has_range = true, .min = 2, .max = 9}}),
       sample_component("scales", {{.name = "weight", .unit = "kg", .kind = CHIMERA_OUT_CONST}}),
       sample_component("join_mean", {ports_in("in", "U"), port_out("out", "U")}),
       sample_component("join_priority", {ports_in("in", "U"), port_out("out", "U"), port_out("chosen", "1")}),
       sample_component("select", {ports_in("in", "U"), port_in("which", "1"), port_out("out", "U")})},
      our_units());
  return kLibrary;
}

/// "label | label" of the faults of a rule; each edit is done and must leave less errors or warnings.
std::string offered(const std::string& text, std::string_view rule, std::size_t most_tries = kMostEditTries) {
  const ReadDescription reading = read_description(text, "a.yaml");
  Outlined outlined = verify_with_outline(reading, offers_library());
  offer_edits(reading, offers_library(), outlined, most_tries);
  const Report& before = outlined.verdict.report;
  std::string labels;
  for (const Fault& fault : before.faults()) {
    if (fault.rule != rule) continue;
    for (const Offer& offer : fault.offers) {
      append_joined(labels, " | ", offer.label);
      const auto after = edit_text(text, offer.acts);
      EXPECT_TRUE(after) << (after ? "" : after.error().message.c_str());
      if (!after) continue;
      const Report report = verify(read_description(*after, "a.yaml"), offers_library()).report;
      EXPECT_LT(report.errors() + report.warnings(), before.errors() + before.warnings()) << *after << report.text();
    }
  }
  return labels;
}

constexpr const char* kArmAlone = "subsystem: a\ntasks:\n  arm:\n";

TEST(Offers, LinkAnInputToVariablesOfItsUnitOrGiveItAValue) {
  const std::string text = std::string(kArmAlone) + "  gauge:\n";
  EXPECT_EQ(offered(text, "input-unmet"), "link to 'q' | operator: {angle: 0 rad}, to be changed");
}

TEST(Offers, DoNotMakeAVariableItsOwnReference) {
  const std::string text = std::string(kArmAlone) + "  follower:\n";
  EXPECT_EQ(offered(text, "input-unmet"), "operator: {q_ref: 0 rad}, to be changed");
}

TEST(Offers, DoNotLinkAGainToAVelocityOfANearName) {
  const std::string text = std::string(kArmAlone) + "  law:\n";
  EXPECT_EQ(offered(text, "input-unmet"), "operator: {kd: 0 V.s/rad}, to be changed");
}

TEST(Offers, JoinTwoProducersInThreeWays) {
  const std::string text =
      std::string(kArmAlone) + "  spare: {component: arm, alias: {qd: qd_2}}\n  norate: {rate: 1 Hz}\n";
  EXPECT_EQ(offered(text, "two-producers"),
            "join by mean | join by priority | join by selection | "
            "link 'q' of 'spare' to a new variable 'q_2'");
}

TEST(Offers, AddTheProducerToTheConfiguration) {
  const std::string text =
      std::string(kArmAlone) + "  norate: {rate: 1 Hz}\nconfigurations:\n  run: [norate]\n  idle: {tasks: [arm]}\n";
  EXPECT_EQ(offered(text, "input-unmet"), "add 'arm' to 'run'");
}

TEST(Offers, InsertAConverterInEachConfigurationOfItsReader) {
  EXPECT_EQ(offered(std::string(kArmAlone) + "  slow:\n", "unit-clash"), "insert 'deg'");
  const std::string sets = "configurations: {run: [arm, slow], also: {tasks: [slow, arm]}}\n";
  EXPECT_EQ(offered(std::string(kArmAlone) + "  slow:\n" + sets, "unit-clash"), "insert 'deg'");
}

TEST(Offers, LinkAPortThatClashesToAnotherVariableOfItsUnit) {
  const std::string text = std::string(kArmAlone) + "  gauge: {alias: {angle: qd}}\n";
  EXPECT_EQ(offered(text, "unit-clash"), "link to 'q'");
}

TEST(Offers, WriteARateANearNameAndTakeOut) {
  EXPECT_EQ(offered(std::string(kArmAlone) + "  norate:\n", "rate-missing"), "rate: 100 Hz");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  amr: {component: arn}\n", "component-unknown"), "write 'arm'");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {alias: {q_d: v}}\n", "port-unknown"), "rename to 'qd'");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {rat: 5 Hz}\n", "key-unknown"), "rename to 'rate'");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {magic: 5 Hz}\n", "key-unknown"), "take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm:\noperator: {x: 1}\n", "unused"), "take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm:\noperator: {q: 1 rad}\n", "operator-produced"), "take it out");
}

TEST(Offers, TakeOutWhatTheDescriptionMayMiss) {
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {deadline: 1 min}\n", "time-range"), "take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm:\n  perpetuum_mobile:\n", "component-unknown"), "take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm:\nconfigurations: {run: [arm, zzzzzzz]}\n", "task-unknown"),
            "take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {alias: {zzzzzzz: q}}\n", "port-unknown"), "take it out");
}

TEST(Offers, WriteAWordOrAUnitThatIsExpected) {
  const std::string rtpus = "rtpus: {servo: {cpu: 1, policy: fifo}}\n";
  EXPECT_EQ(offered(kArmAlone + rtpus, "word-unknown"),
            "write 'rm' | write 'edf' | write 'llf' | write 'muf' | take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {rate: 50}\n", "quantity-bad"), "write '50 Hz' | take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  arm: {budget: 5}\n", "quantity-bad"),
            "write '5 us' | write '5 ms' | take it out");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  gauge:\noperator: {angle: 1}\n", "value-unit"), "write '1 rad'");
  EXPECT_EQ(offered("tasks:\n  arm:\n", "key-missing"), "subsystem: untitled");
}

TEST(Offers, GiveAConstantItsSmallestLegalValueOrLinkItToAnOutput) {
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  chain:\n", "constant-unmet"), "constants: {mass: 2 kg}, to be changed");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  chain:\n  scales:\n", "constant-unmet"),
            "constants: {mass: 2 kg}, to be changed | link to 'weight'");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  chain: {alias: {mass: m}}\n", "constant-unmet"),
            "constants: {m: 2 kg}, to be changed");
}

TEST(Offers, PartTwoProducersOfAConstant) {
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  scales:\n  other: {component: scales}\n", "constant-two-producers"),
            "link 'weight' of 'other' to a new variable 'weight_2'");
}

TEST(Offers, LowerTheHeaviestRateUntilItFitsOrMoveTheTask) {
  const std::string task = "subsystem: a\ntasks:\n  arm: {rate: 1 kHz, budget: 800 us}\n";
  const std::string other = "  arm2: {component: arm, alias: {q: q2, qd: qd2}, rate: 100 Hz, budget: 5 ms}\n";
  EXPECT_EQ(offered(task + other, "utilisation"), "rate of 'arm': 500 Hz");
  const std::string third = "  arm3: {component: arm, alias: {q: q3, qd: qd3}, rate: 100 Hz, budget: 6 ms}\n";
  EXPECT_EQ(offered(task + other + third, "utilisation"),
            "rate of 'arm': 250 Hz, rate of 'arm2': 50 Hz, rate of 'arm3': 50 Hz");
  const std::string rtpus = "rtpus: {one: {cpu: 0}, also: {cpu: 0}, two: {cpu: 1}}\n";
  EXPECT_EQ(offered(rtpus + task + other, "utilisation"), "rate of 'arm': 500 Hz | move 'arm' to rtpu 'two'");
}

TEST(Offers, GiveAnOutputThatClashesItsOwnVariable) {
  const std::string text = std::string(kArmAlone) +
                           "  deg: {rate: 1 Hz, alias: {x: angle, y: q}}\n"
                           "configurations: {one: [arm], two: [deg]}\noperator: {angle: 1 rad}\n";
  EXPECT_EQ(offered(text, "unit-clash"), "link 'y' of 'deg' to a new variable 'q_2'");
}

TEST(Offers, LinkAnInstanceOfARepeatedPortAndTakeOutTooMany) {
  EXPECT_EQ(offered(std::string(kArmAlone) + "  join_mean: {rate: 1 Hz}\n", "repeated-port"),
            "link to 'q' | link to 'qd'");
  std::string many;
  for (int i = 0; i < 18; ++i) many += i == 0 ? "q" : ", q";
  EXPECT_EQ(
      offered(std::string(kArmAlone) + "  join_mean: {rate: 1 Hz, alias: {in: [" + many + "]}}\n", "repeated-port"),
      "take out all beyond 16");
}

TEST(Offers, PutAStandbyInItsPlace) {
  const std::string text = "subsystem: a\nrtpus: {one: {cpu: 0}, two: {cpu: 1}}\ntasks:\n  arm: {rtpu: one}\n";
  const std::string outputs = "  spare: {component: arm, rtpu: two, standby_for: arm, alias: {q: x}}\n";
  EXPECT_EQ(offered(text + outputs, "standby-outputs"), "link 'q' to 'q'");
  const std::string spare =
      "  spare: {component: arm, rtpu: one, standby_for: arm}\n  gauge: {rtpu: two}\n"
      "operator: {angle: 1 rad}\n";
  EXPECT_EQ(offered(text + spare, "standby-same-rtpu"), "move 'spare' to rtpu 'two'");
  EXPECT_EQ(offered(text + spare + "configurations: {run: [arm, gauge, spare]}\n", "standby-in-configuration"),
            "take 'spare' out of 'run'");
}

TEST(Offers, AddATaskThatIsInNoConfiguration) {
  EXPECT_EQ(
      offered(std::string(kArmAlone) + "  deg: {rate: 1 Hz, alias: {x: q}}\nconfigurations: {run: [arm]}\n", "unused"),
      "add 'deg' to 'run' | take it out");
}

TEST(Offers, NameAMissingResourceAndGiveALoopItsInitialValue) {
  EXPECT_EQ(offered(std::string(kArmAlone) + "  camera:\n", "resource-missing"),
            "resources: {eye: eye}, to be changed");
  EXPECT_EQ(offered("subsystem: a\ntasks:\n  law: {alias: {kd: gain}}\n  plant:\noperator: {gain: 1 V.s/rad}\n",
                    "loop-without-initial"),
            "initial: {q: 0 rad}");
}

TEST(Offers, EndWithTheTries) {
  EXPECT_EQ(offered(std::string(kArmAlone) + "  gauge:\n", "input-unmet", 1), "link to 'q'");
  EXPECT_EQ(offered(std::string(kArmAlone) + "  gauge:\n", "input-unmet", 0), "");
}

TEST(Offers, BeginWithTheLikeliestOfEachFault) {
  const std::string text = std::string(kArmAlone) + "  gauge:\n  other: {component: gauge, alias: {angle: x}}\n";
  EXPECT_EQ(offered(text, "input-unmet", 2), "link to 'q' | link to 'q'");
}

TEST(Offers, AreNoneForATextThatIsNoTree) { EXPECT_EQ(offered("tasks: [", "yaml-syntax"), ""); }

}  // namespace
}  // namespace chimera
