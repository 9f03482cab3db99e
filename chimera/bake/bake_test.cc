// SPDX-License-Identifier: Apache-2.0
#include "chimera/bake/bake.h"

#include <gtest/gtest.h>

#include <set>

#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/testing/sample_component.h"
#include "chimera/verify/verify.h"

namespace chimera::bake::bake_test {

PortDescriptor port(std::string name, std::uint32_t kind, std::string shape = "") {
  return {.name = std::move(name), .unit = "1", .shape = std::move(shape), .kind = kind};
}

PortDescriptor resource(std::string name) {
  PortDescriptor made = port(std::move(name), CHIMERA_RESOURCE);
  made.type = CHIMERA_STRING;
  made.element_size = 64;
  return made;
}

Descriptor with(Descriptor made, bool background, bool sync, bool event_source) {
  made.background = background;
  made.methods[CHIMERA_SYNC] = sync;
  made.event_source = event_source;
  return made;
}

const Library& library() {
  static const Library kLibrary = Library::of(
      {sample_component("source", {port("y", CHIMERA_OUT_VAR)}), sample_component("sink", {port("y", CHIMERA_IN_VAR)}),
       sample_component("wide", {port("z", CHIMERA_OUT_VAR, "[2000]")}),
       sample_component("device", {resource("tty"), port("y", CHIMERA_OUT_VAR)}),
       sample_component("key", {resource("pin"), port("y", CHIMERA_OUT_VAR)}),
       sample_component("screen", {resource("device"), port("y", CHIMERA_IN_VAR)}),
       with(sample_component("writer", {port("y", CHIMERA_IN_VAR)}), true, false, false),
       with(sample_component("waiter", {port("y", CHIMERA_OUT_VAR)}), false, true, true)},
      our_units());
  return kLibrary;
}

const std::string kTarget =
    "version: 1\ncpu: cortex-m3\nboard: mps2\nclock_hz: 25000000\nflash: {address: 0, size: 64 KiB}\n"
    "ram: {address: 0x20000000, size: 20 KiB}\ninterrupts: {timer0: 8, timer1: 9}\n"
    "pins: {led0: {register: 0x40028000, bit: 0, access: write}}\n";
const std::string kUart = "uart: {address: 64, interrupt: timer1, baud: 9600}\n";
const std::string kFit = "tasks: {source: {}, sink: {}}\n";

struct Case {
  std::string text = kFit;
  std::string target{};  ///< added to kTarget
  const RecordedProfile* profile = nullptr;
};

Configuration verified(const std::string& text) {
  Verdict verdict = verify(read_description("version: 1\nsubsystem: s\n" + text, "s.yaml"), library(), Overload::kTold);
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  return *verdict.configuration;
}

BakeResult baked(const Case& of) {
  const Configuration configuration = verified(of.text);
  const ReadTarget target = read_target(kTarget + of.target, "t.yaml", {});
  EXPECT_TRUE(target.target) << target.report.text();
  return bake({.configuration = configuration,
               .target = *target.target,
               .target_file = "t.yaml",
               .library = library(),
               .profile = of.profile,
               .acts = {}});
}

/// All faults, of the description first; "" if files were made.
std::string refusal(const Case& of) {
  const BakeResult result = baked(of);
  const std::string text = result.description.text() + result.target.text();
  EXPECT_EQ(result.is_baked(), text.empty()) << text;
  return text;
}

TEST(Bake, GivesTheSameBytesTwice) {
  const BakeResult one = baked({}), other = baked({});
  ASSERT_TRUE(one.is_baked());
  ASSERT_EQ(one.files.size(), other.files.size());
  for (std::size_t i = 0; i < one.files.size(); ++i) {
    EXPECT_EQ(one.files[i].name, other.files[i].name);
    EXPECT_EQ(one.files[i].text, other.files[i].text);
    EXPECT_EQ(one.files[i].text.find("s.yaml"), std::string::npos) << "a path";
  }
  EXPECT_EQ(one.files[0].text, "sink\nsource\n");
  EXPECT_EQ(one.files[1].text, "-mcpu=cortex-m3 -mthumb\n");
}

TEST(Bake, NamesTheNearestRateOfWholeTicks) {
  EXPECT_EQ(refusal({.text = "tasks: {source: {rate: 300 Hz, offset: 1.5 ms}, sink: {}}\n"}),
            "s.yaml:3:24: error: the period of task 'source' is 3.333 ms, which is no multiple of the tick of 1 ms "
            "[time-range]\n  write 'rate: 333.333333 Hz', a period of 3 ms\n"
            "s.yaml:3:40: error: the offset of task 'source' is 1.5 ms, which is no multiple of the tick of 1 ms "
            "[time-range]\n  write 'offset: 2 ms', or 'tick: 500 us' in the target\n");
}

TEST(Bake, RefusesADeadlineOfBrokenTicks) {
  EXPECT_EQ(refusal({.text = "tasks: {source: {deadline: 2.25 ms}, sink: {}}\n"}),
            "s.yaml:3:28: error: the deadline of task 'source' is 2.25 ms, which is no multiple of the tick of 1 ms "
            "[time-range]\n  write 'deadline: 2 ms', or 'tick: 250 us' in the target\n");
}

TEST(Bake, RefusesWhatNeedsMoreThanOneLoop) {
  const std::string text = refusal(
      {.text = "rtpus: {a: {cpu: 0, executor: preemptive, policy: llf}, b: {cpu: 1, policy: muf-laxity}}\n"
               "tasks:\n  source: {rtpu: a, stack: 64 KiB, on_miss: demote}\n  sink: {rtpu: b, isolation: process}\n"
               "  spare: {component: source, standby_for: source, rtpu: b, on_overrun: demote}\n"});
  for (const char* each :
       {"an image cannot have 2 rtpus; an image has 1 [not-built]\n  put every task on 'a'",
        "an image cannot have the executor 'preemptive' of rtpu 'a' [not-built]\n  write 'executor: executive'",
        "an image cannot have the policy 'llf' of rtpu 'a' [not-built]\n  write 'policy: rm', 'edf' or 'muf'",
        "an image cannot have the policy 'muf-laxity' of rtpu 'b'",
        "an image cannot have 'stack' of task 'source' [not-built]\n  write 'stack' in the target",
        "an image cannot have 'on_miss: demote' of task 'source'",
        "an image cannot have 'on_overrun: demote' of task 'spare'",
        "an image cannot have 'isolation: process' of task 'sink'",
        "an image cannot have 'standby_for' of task 'spare'"})
    EXPECT_NE(text.find(each), std::string::npos) << each << "\nnot in\n" << text;
}

TEST(Bake, RefusesAServer) {
  const std::string text = refusal({.text = "rtpus: {a: {cpu: 0, executor: preemptive}}\n"
                                            "tasks: {w: {component: waiter, "
                                            "server: {kind: sporadic, capacity: 1 ms, period: 10 ms}}}\n",
                                    .target = "events: {w: timer0}\n"});
  EXPECT_NE(text.find("error: an image cannot have 'server' of task 'w' [not-built]\n"
                      "  leave it out: without a server the task looks for an event at its rate\n"),
            std::string::npos)
      << text;
}

TEST(Bake, RefusesBackgroundWork) {
  EXPECT_EQ(refusal({.text = "tasks: {source: {}, writer: {}}\n"}),
            "s.yaml:3:21: error: an image cannot have the component 'writer' of task 'writer': its background work "
            "needs a thread of Linux [not-built]\n  use a component without 'background: true'\n");
}

TEST(Bake, RefusesATaskWithADescriptorThatHasNoInterrupt) {
  EXPECT_EQ(refusal({.text = "tasks: {waiter: {}, sink: {}}\n"}),
            "s.yaml:3:9: error: the events of task 'waiter' come from a descriptor on Linux, and the target 't' gives "
            "it no interrupt [resource-missing]\n  write 'events: {waiter: INTERRUPT}' in the target\n");
}

TEST(Bake, GivesATaskTheInterruptOfTheTarget) {
  const BakeResult result = baked({.text = "tasks: {waiter: {}, sink: {}}\n", .target = "events: {waiter: timer0}\n"});
  ASSERT_TRUE(result.is_baked());
  const std::string& tables = result.files.back().text;
  EXPECT_NE(tables.find("kEvents[] = {\n    {TaskId(0u), 8u},\n};"), std::string::npos) << tables;
  EXPECT_NE(tables.find(".has_events = true"), std::string::npos) << tables;
}

TEST(Bake, RefusesEventsOfTasksAndInterruptsThatCannotHaveThem) {
  EXPECT_EQ(refusal({.text = "tasks: {waiter: {}, other: {component: waiter, alias: {y: z}}, sink: {}}\n",
                     .target = "uart: {address: 64, interrupt: timer1, baud: 9600}\n"
                               "events: {waiter: timer0, other: timer0, sink: timer1}\n"}),
            "t.yaml:10:33: error: the interrupt 'timer0' belongs to task 'waiter' [resource-twice]\n"
            "  give each task an interrupt of its own\n"
            "t.yaml:10:41: error: task 'sink' has no method 'sync', so it takes no events [not-built]\n"
            "  take the line out of 'events'\n"
            "t.yaml:10:47: error: the interrupt 'timer1' belongs to 'uart' [resource-twice]\n"
            "  give each task an interrupt of its own\n");
}

TEST(Bake, RefusesAResourceWithoutATextInTheTarget) {
  const std::string text = refusal({.text = "tasks: {device: {resources: {tty: /dev/ttyS0}}, sink: {}}\n"});
  EXPECT_NE(text.find("error: resource 'tty' of task 'device' has no text in the target 't' [resource-missing]\n"
                      "  write 'resources: {device: {tty: TEXT}}' in the target\n"),
            std::string::npos)
      << text;
}

TEST(Bake, PutsTheTextOfTheTargetIntoTheTables) {
  const BakeResult result = baked({.text = "tasks: {device: {resources: {tty: /dev/ttyS0}}, sink: {}}\n",
                                   .target = "resources: {device: {tty: AB}}\n"});
  ASSERT_TRUE(result.is_baked());
  EXPECT_NE(result.files.back().text.find("{0x41_b, 0x42_b,}"), std::string::npos) << result.files.back().text;
}

TEST(Bake, RefusesUnknownLinesOfTheTarget) {
  EXPECT_EQ(refusal({.text = "tasks: {key: {resources: {pin: x}}, sink: {}}\n",
                     .target = "resources: {key: {pin: led1}, kee: {pin: a}, sink: {tty: a}}\n"}),
            "t.yaml:9:24: error: the target has no pin 'led1' [word-unknown]\n  did you mean 'led0'?\n"
            "t.yaml:9:31: error: the description has no task 'kee' [word-unknown]\n  did you mean 'key'?\n"
            "t.yaml:9:53: error: task 'sink' has no resource port 'tty' [word-unknown]\n  its resource ports: none\n");
}

TEST(Bake, GivesTheSerialLineToOneTask) {
  const std::string text = "tasks: {source: {}, a: {component: screen, resources: {device: x}},\n"
                           "  b: {component: screen, resources: {device: x}}}\n";
  EXPECT_EQ(refusal({.text = text, .target = "resources: {a: {device: uart}, b: {device: uart}}\n"}),
            "t.yaml:9:25: error: the target has no serial line 'uart' [word-unknown]\n  its serial lines: none\n"
            "t.yaml:9:44: error: the target has no serial line 'uart' [word-unknown]\n  its serial lines: none\n");
  EXPECT_EQ(refusal({.text = text, .target = kUart + "resources: {a: {device: uart}, b: {device: uart}}\n"}),
            "t.yaml:10:44: error: 'uart' belongs to task 'a' [resource-twice]\n  take one of the two tasks out\n");
  EXPECT_EQ(refusal({.text = text, .target = kUart + "resources: {a: {device: uart}, b: {device: urt}}\n"}),
            "t.yaml:10:44: error: the target has no serial line 'urt' [word-unknown]\n  did you mean 'uart'?\n");
}

TEST(Bake, RefusesAWrongNumberOfResourceTexts) {
  EXPECT_NE(refusal({.text = "tasks: {device: {resources: {tty: a}}, sink: {}}\n",
                     .target = "resources: {device: {tty: [a, b]}}\n"})
                .find("resource 'tty' of task 'device' has 2 texts; the description has 1 instance"),
            std::string::npos);
}

TEST(Bake, RefusesValuesThatExceedTheRam) {
  EXPECT_EQ(refusal({.text = "tasks: {wide: {}}\n"}),
            "t.yaml:6:6: error: stacks, records, ports and values of the tasks need at least 82.1 KiB; 'ram' has 20.0 "
            "KiB [table-limit]\n  use fewer tasks and smaller lists, smaller stacks, or a chip with more RAM\n");
}

RecordedProfile profile_of(std::int64_t source_us, std::int64_t sink_us) {
  const auto task = [](const char* name, std::int64_t us) {
    return RecordedTask{.task = name, .samples = 1000, .worst = microseconds(us), .mean = microseconds(us),
                        .response = microseconds(us), .jitter = {}};
  };
  return {"s", {task("source", source_us), task("sink", sink_us)}};
}

TEST(Bake, JudgesDeadlinesByTheProfileAndNotByBudgets) {
  const RecordedProfile fits = profile_of(300, 300);
  const std::string text = "tasks: {source: {rate: 1 kHz, budget: 900 us}, sink: {rate: 1 kHz, budget: 900 us}}\n";
  EXPECT_EQ(refusal({.text = text, .profile = &fits}), "");
}

TEST(Bake, RefusesADeadlineBehindAJobThatCannotBePreempted) {
  const RecordedProfile late = profile_of(300, 900);
  const std::string text =
      refusal({.text = "tasks: {source: {rate: 1 kHz}, sink: {rate: 10 Hz}}\n", .profile = &late});
  EXPECT_TRUE(text.starts_with("s.yaml:3:9: error: by the profile task 'source' takes up to 300 us of every 1 ms"))
      << text;
  EXPECT_NE(text.find(": its deadline of 1 ms is not guaranteed [unschedulable]\n  all keep their deadlines with"),
            std::string::npos)
      << text;
}

TEST(Bake, CountsTheShellAsBlocking) {
  const RecordedProfile tight = profile_of(450, 450);
  const std::string text = "tasks: {source: {rate: 1 kHz}, sink: {rate: 1 kHz}}\n";
  EXPECT_EQ(refusal({.text = text, .profile = &tight}), "");
  EXPECT_NE(refusal({.text = text, .target = "uart: {address: 64, interrupt: timer0, baud: 9600}\n", .profile = &tight})
                .find("its deadline of 1 ms is not guaranteed"),
            std::string::npos);
}

TEST(Bake, RefusesATaskThatTheProfileLacks) {
  RecordedProfile profile = profile_of(1, 1);
  profile.tasks.pop_back();
  EXPECT_EQ(refusal({.profile = &profile}),
            "s.yaml:3:21: error: the profile has no measured cycle of task 'sink', and a budget of the description "
            "does not count on the target [unschedulable]\n"
            "  record the profile on the target with every task ON, or bake without --profile\n");
}

const std::string kTwoSets =
    "tasks: {source: {rate: 1 kHz}, spare: {component: source, rate: 1 kHz}, sink: {rate: 10 Hz}}\n"
    "configurations: {a: [source, sink], b: [spare, sink]}\nstart: a\n";

TEST(Bake, WritesAPlanForEachPairOfConfigurations) {
  const BakeResult result = baked({.text = kTwoSets});
  ASSERT_TRUE(result.is_baked());
  const std::string& text = result.files.back().text;
  EXPECT_NE(text.find("constexpr TaskId kArriving1[] = {\n    TaskId(1u),\n};\n"
                      "constexpr TaskId kLeaving1[] = {\n    TaskId(0u),\n};\n"
                      "constexpr TaskId kStaying1[] = {\n    TaskId(2u),\n};\n"
                      "constexpr Handover kHandovers1[] = {\n"
                      "    {.variable = VariableId(0u), .from = {.task = TaskId(0u)}, "
                      ".to = {.task = TaskId(1u)}},\n};\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("constexpr SwitchPlan kPlans[] = {\n    {},\n"
                      "    {.before = 0, .after = 1, .arriving = kArriving1,"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(".plans = kPlans}"), std::string::npos);
}

TEST(Bake, CountsTheMemoryOfSwitches) {
  const MemoryNeed with = baked({.text = kTwoSets}).memory;
  const std::string without_sets = kTwoSets.substr(0, kTwoSets.find("spare")) + "sink: {rate: 10 Hz}}\n";
  const MemoryNeed without = baked({.text = without_sets}).memory;
  EXPECT_GT(with.shared_flash_bytes, without.shared_flash_bytes + 4 * 48);
  EXPECT_GT(with.shared_ram_bytes, without.shared_ram_bytes + 3 * kSwitchTaskBytes + kSwitchVariableBytes);
}

TEST(Bake, SaysWhichSwitchesAreSlowByTheProfile) {
  RecordedProfile profile = profile_of(7000, 10);
  profile.tasks.push_back(profile.tasks[0]);
  profile.tasks.back().task = "spare";
  profile.tasks.back().worst = profile.tasks.back().mean = milliseconds(6);
  const BakeResult result = baked(
      {.text = "tasks: {source: {rate: 100 Hz}, spare: {component: source, rate: 100 Hz, offset: 5 ms, "
               "deadline: 7 ms}, sink: {rate: 10 Hz}}\n"
               "configurations: {a: [source, sink], b: [spare, sink]}\nstart: a\n",
       .profile = &profile});
  ASSERT_TRUE(result.is_baked()) << result.description.text();
  EXPECT_EQ(result.notes.back(),
            "the switch from 'b' to 'a' turns tasks OFF first: otherwise task 'source' could miss its deadline of "
            "10 ms (it would end up to 27.01 ms after its release)");
  EXPECT_NE(result.files.back().text.find(".deadline = &kDeadline2"), std::string::npos);
}

TEST(Bake, LeavesBudgetsOutWithoutAProfile) {
  const BakeResult result = baked({.text = "tasks: {source: {budget: 2 ms, on_overrun: hold}, sink: {}}\n"});
  ASSERT_TRUE(result.is_baked());
  EXPECT_EQ(result.files.back().text.find(".budget"), std::string::npos);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes.back().find("left out: 'source'"), std::string::npos) << result.notes.back();
}

TEST(Bake, TurnsOnTheMechanismsThatAreUsed) {
  const auto used = [](const Case& of) {
    std::set<std::string> names;
    for (const Mechanism& each : baked(of).mechanisms)
      if (each.is_used) names.emplace(each.name);
    return names;
  };
  EXPECT_EQ(used({}), (std::set<std::string>{"kSignals"}));
  EXPECT_EQ(used({.text = "tasks: {source: {on_fault: {restart: 2, within: 1 s, then: error}}, sink: {on_miss: hold}}\n"
                          "configurations: {all: [source, sink], one: [source]}\nstart: all\n",
                  .target = "watchdog: 1 s\nuart: {address: 64, interrupt: timer0, baud: 9600}\n"}),
            (std::set<std::string>{"kSignals", "kSwitch", "kRestart", "kReactions", "kSerial", "kShell", "kWatchdog"}));
  EXPECT_EQ(used({.text = "tasks: {source: {}, screen: {resources: {device: x}}}\n",
                  .target = kUart + "resources: {screen: {device: uart}}\n"}),
            (std::set<std::string>{"kSignals", "kSerial"}));
}

}  // namespace chimera::bake::bake_test
