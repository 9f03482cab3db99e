// SPDX-License-Identifier: Apache-2.0
// Two producers of a variable in one configuration, including tasks with a standby.
#include <gtest/gtest.h>

#include <string>

#include "chimera/base/hosted/wording.h"
#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/testing/sample_component.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

Library valves() {
  return Library::of({sample_component("valve", {{.name = "u", .kind = CHIMERA_OUT_VAR}})}, our_units());
}

/// Codes of the faults of a configuration of a valve, its two standbys and one more valve.
std::string faults_of(const std::string& members) {
  const std::string text =
      "subsystem: demo\n"
      "rtpus: {a: , b: {cpu: 1}}\n"
      "tasks:\n"
      "  valve:\n"
      "  spare: {component: valve, rtpu: b, standby_for: valve}\n"
      "  third: {component: valve, rtpu: b, standby_for: valve}\n"
      "  other: {component: valve}\n"
      "configurations: {run: [" + members + "]}\n";
  const Verdict verdict = verify(read_description(text, "app.yaml"), valves());
  std::string codes;
  for (const Fault& fault : verdict.report.faults())
    if (fault.severity == Severity::kError) append_joined(codes, " ", fault.rule);
  return codes;
}

TEST(RuleLinks, AConfigurationMayNameAStandbyInPlaceOfItsPrimary) {
  EXPECT_EQ(faults_of("valve"), "");
  EXPECT_EQ(faults_of("spare"), "");
}

TEST(RuleLinks, AStandbyDoesNotExcuseAnotherProducer) {
  EXPECT_EQ(faults_of("valve, other"), "two-producers");
  EXPECT_EQ(faults_of("spare, other"), "two-producers");
  EXPECT_EQ(faults_of("spare, third"), "two-producers");
}

TEST(RuleLinks, ATaskAndItsOwnStandbyAreOneFault) {
  EXPECT_EQ(faults_of("valve, spare"), "standby-in-configuration");
  EXPECT_EQ(faults_of("valve, spare, third"), "standby-in-configuration standby-in-configuration");
  EXPECT_EQ(faults_of("valve, spare, other"), "two-producers standby-in-configuration");
}

}  // namespace
}  // namespace chimera
