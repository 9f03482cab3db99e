// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/receipt/receipt_text.h"

#include <gtest/gtest.h>

#include <limits>

#include "chimera/control/receipt/receipt_json.h"

namespace chimera::control {
namespace {

constexpr TaskId kPid{0u}, kTorque{1u};
constexpr VariableId kTau{0u};

/// A switch from 'pid' to 'torque', asked for 2 s after the origin of 1 s; a test says how far it came.
struct Told {
  Told() {
    port.kind = CHIMERA_OUT_VAR;
    port.unit = "N.m";
    for (TaskSpec& each : tasks) each.ports = {&port, 1};
    for (TaskSpec& each : tasks) each.deadline = milliseconds(1), each.rtpu = RtpuId(0u);
    tasks[0].name = "pid";
    tasks[1].name = "torque";
    variable.name = "tau";
    spec.tasks = tasks;
    spec.variables = {&variable, 1};
    spec.sets = sets;
    spec.rtpus = {&rtpu, 1};
    receipt.number = 3;
    receipt.before = 0;
    receipt.after = 1;
    receipt.asked = seconds(3);
    parts[0] = {kTorque, TaskMove::kArrives, microseconds(30), Nanoseconds{-1}, 0, microseconds(4), Nanoseconds{-1}};
    parts[1] = {kPid, TaskMove::kLeaves, Nanoseconds{-1}, microseconds(20), 1, Nanoseconds{-1}, microseconds(7)};
    receipt.tasks = parts;
    moved.handover = {kTau, {kPid, 0}, {kTorque, 0}};
    receipt.variables = {&moved, 1};
  }
  void be_done() {
    receipt.end = SwitchEnd::kDone;
    receipt.armed = receipt.at = seconds(3) + microseconds(1500);
    receipt.ended = seconds(3) + milliseconds(2);
  }
  std::string text() const { return receipt_text(receipt, spec, seconds(1)); }
  std::string json() const { return receipt_json(receipt, spec, seconds(1)); }

  PortSpec port;
  TaskSpec tasks[2];
  Variable variable;
  RtpuSpec rtpu{"servo", 1};
  NamedSet sets[2] = {{"pid", {}}, {"torque", {}}};
  ApplicationSpec spec;
  TaskPart parts[2];
  VariablePart moved;
  SwitchReceipt receipt;
};

TEST(ReceiptText, ADoneSwitchNamesTheVariableThatMovedAndItsStep) {
  Told told;
  told.be_done();
  told.moved.step_of_on = {0.25, 5, true, false};
  EXPECT_EQ(told.text(), "switch 3 at 2.000 s from 'pid' to 'torque' after 1.500 ms: 1 task arrives, 1 leaves, "
                         "1 cycle lost; tau moves by 0.25 N.m, limit 5 N.m\n");
  told.moved.step_of_cycle = {6, 5, true, true};
  EXPECT_EQ(told.text(), "switch 3 at 2.000 s from 'pid' to 'torque' after 1.500 ms: 1 task arrives, 1 leaves, "
                         "1 cycle lost; tau moves by 6 N.m, limit 5 N.m\n"
                         "bump: after switch 3 the first cycle of task 'torque' moved 'tau' by 6 N.m, limit 5 N.m\n");
}

TEST(ReceiptText, AnAbortedSwitchNamesItsCause) {
  Told told;
  told.receipt.end = SwitchEnd::kAborted;
  told.receipt.why = NoSwitch::kOnFailed;
  told.receipt.task = kTorque;
  told.receipt.said.assign("no current");
  const std::string begin = "switch 3 at 2.000 s from 'pid' to 'torque' ";
  EXPECT_EQ(told.text(), begin + "aborted: on of task 'torque': no current\n");
  told.receipt.why = NoSwitch::kStepTooLarge;
  told.receipt.variable = kTau;
  told.moved.step_of_on = {9, 5, true, true};
  EXPECT_EQ(told.text(), begin + "aborted: on of task 'torque' would move 'tau' too far: by 9 N.m, limit 5 N.m\n");
  told.receipt.why = NoSwitch::kNoValue;
  EXPECT_EQ(told.text(), begin + "aborted: task 'torque' had no value of 'tau'\n");
  told.receipt.ended = told.receipt.asked + milliseconds(300) + microseconds(420);
  EXPECT_EQ(told.text(), begin + "aborted: task 'torque' had no value of 'tau', for 300 ms\n");
  told.receipt.why = NoSwitch::kNoGap;
  told.receipt.ended = told.receipt.asked + seconds(10) + milliseconds(3);
  EXPECT_EQ(told.text(), begin + "aborted: the processor was never idle for as long as on of task 'torque' takes, "
                                 "for 10 s\n");
  told.receipt.why = NoSwitch::kNoAnswer;
  told.receipt.task = {};
  EXPECT_EQ(told.text(), begin + "aborted: an rtpu did not answer, for 10 s\n");
  told.receipt.task = kTorque;
  told.receipt.end = SwitchEnd::kRefused;
  told.receipt.why = NoSwitch::kInError;
  EXPECT_EQ(told.text(), begin + "refused: task 'torque' is in ERROR: clear it first\n");
  told.receipt.end = SwitchEnd::kDone;
  told.receipt.at = seconds(3) + milliseconds(12);
  told.receipt.flag = milliseconds(11);
  told.receipt.way = {kSlowForDeadlines, {}, {NoSwitch::kNotSchedulable, kTorque, kNever}, {}, {}, {}, {}};
  const std::string slow = begin + "slowly, for the transition from 'pid' to 'torque' is not schedulable on CPU 1: "
                                   "a cycle of task 'torque' may ";
  const std::string after = ", after 12.000 ms, 11 ms under the flag: 1 task arrives, 1 leaves, 1 cycle lost\n";
  told.moved = {told.moved.handover, {}, {}, {}};
  EXPECT_EQ(told.text(), slow + "take longer than its deadline of 1 ms" + after);
  told.receipt.way.deadline.takes = microseconds(1200);
  EXPECT_EQ(told.text(), slow + "take 1.2 ms, its deadline is 1 ms" + after);
  told.receipt.way = {};
  told.receipt.end = SwitchEnd::kRefused;
  told.receipt.before = kNoSet;
  told.receipt.why = NoSwitch::kUnderWay;
  told.receipt.said = {};
  EXPECT_EQ(told.text(), "switch 3 at 2.000 s to 'torque' refused: another switch is under way\n");
}

TEST(ReceiptText, ASlowSwitchNamesCauseTimeUnderTheFlagAndReinitialisedTasks) {
  Told told;
  ConstantSpec mass;
  mass.name = "mass";
  told.spec.constants = {&mass, 1};
  told.be_done();
  told.receipt.way = {kSlowForConstants, {kPid, ConstantId(0u)}, {}, {}, {}, {}, {}};
  told.receipt.flag = microseconds(1400);
  TaskId again[] = {kPid, kTorque};
  told.receipt.reinitialised = again;
  const std::string begin = "switch 3 at 2.000 s from 'pid' to 'torque' slowly, for constant 'mass' of task 'pid', "
                            "which stays, changes, ";
  EXPECT_EQ(told.text(), begin + "after 1.500 ms, 1.4 ms under the flag: 1 task arrives, 1 leaves, 1 cycle lost; "
                                 "pid, torque re-initialised\n");
  const std::string json = told.json();
  EXPECT_NE(json.find(R"("way": "slow", "slow_because": ["constants"], "slow_why": "constant 'mass' of task 'pid', )"
                      R"(which stays, changes", "flag_ns": 1400000, "reinitialised": ["pid", "torque"], )"
                      R"("not_back": null)"),
            std::string::npos)
      << json;
  told.receipt.end = SwitchEnd::kAborted;
  told.receipt.why = NoSwitch::kStepFailed;
  told.receipt.task = kPid;
  told.receipt.said.assign("no");
  EXPECT_EQ(told.text(), begin + "aborted: a method of task 'pid' failed: no; rolled back, 1.4 ms under the flag\n");
  told.receipt.not_back = kPid;
  EXPECT_EQ(told.text(), begin + "aborted: a method of task 'pid' failed: no; rolled back, 1.4 ms under the flag; "
                                 "task 'pid' did not come back\n");
  told.receipt.flag = {};
  told.receipt.not_back = {};
  told.receipt.why = NoSwitch::kBadConstant;
  told.receipt.said.assign("extent n = 5 of port q is outside 1 to 4");
  EXPECT_EQ(told.text(), begin + "aborted: task 'pid' cannot be initialised with the constants of 'torque': "
                                 "extent n = 5 of port q is outside 1 to 4\n");
}

TEST(ReceiptText, AnUnsafeSwitchNamesTheValueAndTheCondition) {
  Told told;
  const PortOf producers[] = {{kPid, 0}};
  told.variable.producers = producers;
  told.sets[1].safe_when = {kTau, 0, Relation::kLess, 0.5};
  told.receipt.end = SwitchEnd::kAborted;
  told.receipt.why = NoSwitch::kNotSafe;
  told.receipt.variable = kTau;
  told.receipt.value = 3.25;
  EXPECT_EQ(told.text(), "switch 3 at 2.000 s from 'pid' to 'torque' aborted: 'tau' is 3.25 N.m, and safe_when of "
                         "'torque' asks for tau < 0.5 N.m\n");
  told.receipt.value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(told.text(), "switch 3 at 2.000 s from 'pid' to 'torque' aborted: 'tau' has no value, and safe_when of "
                         "'torque' asks for tau < 0.5 N.m\n");
  told.port.extent[0].max = 6;
  told.sets[1].safe_when.element = 4;
  told.receipt.value = 1;
  EXPECT_EQ(told.text(), "switch 3 at 2.000 s from 'pid' to 'torque' aborted: 'tau[4]' is 1 N.m, and safe_when of "
                         "'torque' asks for tau[4] < 0.5 N.m\n");
}

TEST(ReceiptText, NamesTheTaskThatAsked) {
  Told told;
  told.receipt.cause = SwitchCause::kRequest;
  told.receipt.by = kPid;
  told.receipt.why = NoSwitch::kUnderWay;
  EXPECT_EQ(told.text(),
            "switch 3 at 2.000 s by task pid from 'pid' to 'torque' refused: another switch is under way\n");
  EXPECT_NE(told.json().find("\"asked_by\": {\"task\": \"pid\"}, \"end\""), std::string::npos) << told.json();
  told.receipt.cause = SwitchCause::kMiss;
  EXPECT_NE(told.json().find("\"asked_by\": {\"reaction\": \"on_miss\", \"task\": \"pid\"}, \"end\""),
            std::string::npos);
}

TEST(ReceiptText, ATakeoverNamesThePrimaryAndItsEnd) {
  Told told;
  told.be_done();
  told.receipt.cause = SwitchCause::kStandby;
  told.receipt.after = 0;
  told.receipt.by = kTorque;
  told.receipt.in_place_of = kPid;
  told.moved.step_of_on = {7, 5, true, true};
  told.parts[1].lost = 0;
  EXPECT_EQ(told.text(),
            "takeover 3 at 2.000 s by 'torque' from 'pid', which is in ERROR, after 1.500 ms: 0 cycles lost; tau moves "
            "by 7 N.m, limit 5 N.m\n"
            "bump: after takeover 3 the first value of task 'torque' moved 'tau' by 7 N.m, limit 5 N.m\n");
  told.receipt.was_death = true;
  told.receipt.flag = microseconds(500);
  told.moved.step_of_cycle = {1, 5, true, false};
  EXPECT_EQ(told.text(),
            "takeover 3 at 2.000 s by 'torque' from 'pid', whose rtpu died, after 1.500 ms, 500 us under the "
            "flag: 0 cycles lost; tau moves by 1 N.m, limit 5 N.m\n");
  const std::string json = told.json();
  EXPECT_NE(json.find("\"from\": \"pid\", \"to\": \"pid\", \"way\": \"takeover\", "), std::string::npos) << json;
  EXPECT_NE(json.find("\"asked_by\": {\"reaction\": \"standby_for\", \"lost\": \"pid\", \"by\": \"death\", \"task\": "
                      "\"torque\"}, \"end\": \"done\""),
            std::string::npos)
      << json;
  told.receipt.end = SwitchEnd::kAborted;
  told.receipt.why = NoSwitch::kOnFailed;
  told.receipt.task = kTorque;
  told.receipt.said.assign("no voltage");
  EXPECT_EQ(told.text(),
            "takeover 3 at 2.000 s by 'torque' from 'pid', whose rtpu died, aborted: on of task 'torque': no "
            "voltage\n");
}

TEST(ReceiptText, AReceiptOfAManagerHasRequesterWallClockAndTries) {
  Told told;
  told.be_done();
  told.receipt.tries = 2;
  const std::string json = receipt_json(told.receipt, told.spec, seconds(1), {"operate:ann", 1'700'000'000});
  EXPECT_TRUE(json.starts_with("{\"number\": 3, \"origin_ns\": 1000000000, \"from\": \"pid\", ")) << json;
  EXPECT_NE(json.find("\"asked_by\": {\"role\": \"operate\", \"user\": \"ann\"}, "), std::string::npos) << json;
  EXPECT_NE(json.find("\"tries\": 2, \"wall_ns\": 1700000000, \"asked_ns\": 2000000000, "), std::string::npos) << json;
  told.receipt.end = SwitchEnd::kAborted;
  told.receipt.why = NoSwitch::kCancelled;
  EXPECT_TRUE(told.text().ends_with("to 'torque' aborted: cancelled\n")) << told.text();
  told.receipt.said.assign("operate:ben");
  EXPECT_TRUE(told.text().ends_with("to 'torque' aborted: cancelled by operate:ben\n")) << told.text();
}

TEST(ReceiptText, ASwitchToTheSetInForceHasNoReceipt) {
  Told told;
  told.receipt.end = SwitchEnd::kNothingToDo;
  EXPECT_EQ(told.text(), "switch at 2.000 s: 'torque' is in force, nothing to do\n");
  EXPECT_EQ(told.json(), "");
  told.receipt.after = kNoSet;
  EXPECT_EQ(told.text(), "switch at 2.000 s: these tasks are in force, nothing to do\n");
}

TEST(ReceiptText, AsJsonHasEveryKey) {
  Told told;
  told.be_done();
  told.moved.step_of_on = {0.25, 5, true, false};
  told.moved.usual = {0.125, 0, true, false};
  EXPECT_EQ(told.json(),
            "{\"number\": 3, \"origin_ns\": null, \"from\": \"pid\", \"to\": \"torque\", \"way\": \"fast\", "
            "\"slow_because\": [], \"slow_why\": null, \"flag_ns\": 0, \"reinitialised\": [], \"not_back\": null, "
            "\"asked_by\": {\"script\": \"--at\"}, \"end\": \"done\", \"reason\": null, \"why\": null, \"tries\": 1, "
            "\"wall_ns\": null, \"asked_ns\": 2000000000, \"armed_ns\": 2001500000, "
            "\"at_ns\": 2001500000, \"ended_ns\": 2002000000, "
            "\"took_ns\": {\"arming\": 1500000, \"agreeing\": 0, \"ending\": 500000}, "
            "\"tasks\": [{\"task\": \"torque\", "
            "\"move\": \"arrives\", \"on_ns\": 30000, \"off_ns\": null, \"lost\": 0, \"delay_ns\": 4000, "
            "\"delay_before_ns\": null}, {\"task\": \"pid\", "
            "\"move\": \"leaves\", \"on_ns\": null, \"off_ns\": 20000, \"lost\": 1, \"delay_ns\": null, "
            "\"delay_before_ns\": 7000}], \"variables\": "
            "[{\"variable\": \"tau\", \"from\": \"pid\", \"to\": \"torque\", \"step_of_on\": 0.25, \"step\": 0.25, "
            "\"usual_step\": 0.125, \"unit\": \"N.m\", \"limit\": 5, \"beyond\": false}]}");
  told.receipt.before = kNoSet;
  told.receipt.end = SwitchEnd::kAborted;
  told.receipt.why = NoSwitch::kRunEnded;
  told.receipt.at = kNever;
  EXPECT_NE(told.json().find("\"from\": null"), std::string::npos);
  EXPECT_NE(told.json().find("\"reason\": \"run-ended\", \"why\": \"the run ended\""), std::string::npos);
  EXPECT_NE(told.json().find("\"at_ns\": null"), std::string::npos);
  EXPECT_NE(told.json().find("\"took_ns\": {\"arming\": 1500000, \"agreeing\": null, \"ending\": null}"),
            std::string::npos);
  told.receipt.end = SwitchEnd::kRefused;
  EXPECT_NE(told.json().find("\"tries\": 0, "), std::string::npos);
}

}  // namespace
}  // namespace chimera::control
