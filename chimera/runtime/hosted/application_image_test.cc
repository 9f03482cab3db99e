// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/application_image.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>

#include "chimera/runtime/hosted/links.h"
#include "chimera/runtime/testing/spec_equal.h"

namespace chimera {
namespace {

using testing::first_difference;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// An application in which no field has its default and no two fields of a kind are alike.
struct Sample {
  Sample() {
    ports[0] = {3, CHIMERA_OUT_VAR, 2, kX, {}, "rad", 8, {{1, kN}, {2, kM}}, true, -1.5, 2.5, true, CHIMERA_INT64,
                bytes_of("0123456789abcdef"), {1, 2},
                bytes_of("ABCDEFGHIJKLMNOP"), false};
    ports[1] = {4, CHIMERA_RESOURCE, 0, {}, {}, "", 0, {}, false, 0, 0, false, CHIMERA_STRING, bytes_of("arm.xml"), {},
                {}, true};
    more_ports[0].kind = CHIMERA_IN_VAR;
    more_ports[0].variable = kKp;
    more_ports[1].kind = CHIMERA_OUT_CONST;
    more_ports[1].constant = kM;
    more_ports[2].kind = CHIMERA_IN_CONST;
    more_ports[2].constant = kN;
    more_ports[3].kind = CHIMERA_IN_CONST;
    more_ports[4].kind = CHIMERA_IN_VAR;
    more_ports[4].variable = kX;
    more_ports[5].kind = CHIMERA_IN_VAR;
    more_ports[5].variable = kKi;
    spare_ports[0].kind = CHIMERA_OUT_VAR;
    spare_ports[0].variable = kX;
    spare_ports[1].kind = CHIMERA_IN_VAR;
    spare_ports[1].variable = kKp;
    tasks[0] = {.name = "pid", .component = "pid_joint", .period = Nanoseconds{10}, .offset = Nanoseconds{1},
                .deadline = Nanoseconds{9}, .budget = Nanoseconds{4}, .min_time = Nanoseconds{2}, .criticality = 2,
                .user_priority = 7, .on_miss = OnMiss::kHold, .on_overrun = OnMiss::kSwitch,
                .on_fault = OnFault::kSwitch, .max_consecutive = 5, .place = 3, .aperiodic = true, .is_hardware = true,
                .rtpu = RtpuId{1u}, .on_overrun_set = 1, .on_fault_set = 0, .ports = ports,
                .server = ServerSpec{ServerKind::kSporadic, Nanoseconds{3}, Nanoseconds{10}}};
    tasks[1] = {.name = "plain", .component = "gain", .period = Nanoseconds{20}, .offset = {},
                .deadline = Nanoseconds{20}, .budget = {}, .min_time = {}, .has_events = true, .aperiodic = true,
                .rtpu = RtpuId{0u}, .ports = more_ports,
                .server = {}};
    tasks[2] = {.name = "spare", .component = "spare", .period = Nanoseconds{5}, .offset = {},
                .deadline = Nanoseconds{5}, .budget = {}, .min_time = {}, .on_fault = OnFault::kRestart,
                .rtpu = RtpuId{0u}, .on_fault_set = 1, .ports = spare_ports, .server = {}};
    variables[kKp.index].name = "kp";
    variables[kKi.index].name = "ki";
    variables[kX.index].name = "x";
    constants[0] = {"n", CHIMERA_INT32, 4, bytes_of("abcdefgh"), {2, 0}, {}};
    constants[1] = {"m", CHIMERA_INT64, 8, {}, {}, {}};
    operators[0] = {"kp", kKp, CHIMERA_FLOAT32, 4, {}, bytes_of("abcd"), {}};
    operators[1] = {"ki", kKi, CHIMERA_FLOAT64, 8, {}, bytes_of("abcdefgh"), {}};
    spec = {"arm",     rtpus,      tasks, variables, constants,
            operators, init_order, start, on_order,  end_order, sets,
            standbys, restarts, stale};
    links.fill(tasks, operators, variables, constants);
  }

  static constexpr VariableId kKi{0u}, kX{1u}, kKp{2u};
  static constexpr ConstantId kN{0u}, kM{1u};

  LinkSpec link{"/dev/ttyS0", false, 9600, milliseconds(10), milliseconds(30)};
  RtpuSpec rtpus[2] = {{"spare", 3, Policy::kMuf, false, link},
                       {"servo", 1, Policy::kRm}};
  PortSpec ports[2], more_ports[6], spare_ports[2];
  TaskSpec tasks[3];
  Variable variables[3];
  ConstantSpec constants[2];
  GivenSpec operators[2];
  Links links;
  TaskId init_order[3] = {TaskId{1u}, TaskId{0u}, TaskId{2u}}, start[1] = {TaskId{1u}};
  TaskId on_order[3] = {TaskId{2u}, TaskId{1u}, TaskId{0u}}, end_order[3] = {TaskId{0u}, TaskId{1u}, TaskId{2u}};
  TaskId other[2] = {TaskId{0u}, TaskId{1u}};
  StandbySpec standbys[1] = {{TaskId{0u}, TaskId{2u}, {}, true}};
  RestartSpec restarts[1] = {{TaskId{2u}, 4, seconds(10), OnFault::kSwitch}};
  StaleSpec stale[1] = {{TaskId{1u}, milliseconds(3)}};
  NamedSet sets[2] = {{"both", other, {kX, 7, Relation::kAtLeast, -2.5}}, {"alone", start}};
  ComponentPlace places[3] = {{"/usr/lib/pid.so", 0x123456789abcdef0}, {"gain.so", 2}, {"spare.so", 3}};
  RunSettings settings{40, milliseconds(5)};
  ApplicationSpec spec;
};

// Offsets of the fields of the header: docs/formats/image.md.
constexpr std::size_t kVersionAt = 8, kHashAt = 24, kBodyAt = 32;

void set_hash(std::vector<std::byte>& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = kBodyAt; i < bytes.size(); ++i)
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
  std::memcpy(bytes.data() + kHashAt, &hash, sizeof hash);
}

std::string refusal(std::span<const std::byte> bytes) {
  const auto image = ApplicationImage::decode(bytes);
  return image ? "accepted" : image.error().message.c_str();
}

TEST(ApplicationImage, EveryFieldComesBack) {
  const Sample sample;
  const auto bytes = encode(sample.spec, sample.places, sample.settings);
  auto image = ApplicationImage::decode(bytes);
  ASSERT_TRUE(image) << image.error().message.c_str();
  const ApplicationImage moved = std::move(*image);
  EXPECT_EQ(first_difference(moved.spec(), sample.spec), "");
  ASSERT_EQ(moved.places().size(), 3u);
  EXPECT_EQ(moved.places()[0].object_file, "/usr/lib/pid.so");
  EXPECT_EQ(moved.places()[0].fingerprint, 0x123456789abcdef0u);
  EXPECT_EQ(moved.settings().priority, 40);
  EXPECT_EQ(moved.settings().method_limit, milliseconds(5));
}

TEST(ApplicationImage, ADifferenceInAnySpecIsSeen) {  // so that the test above is worth something
  Sample a, b;
  b.ports[0].listed[1] = 9;
  EXPECT_EQ(first_difference(a.spec, b.spec), "tasks[0].ports[0].listed");
  a.operators[1].value = bytes_of("abcdefgi");
  EXPECT_EQ(first_difference(a.spec, Sample().spec), "operators[1].value");
  Sample c, d;
  c.more_ports[4].variable = Sample::kKi;
  c.links.fill(c.tasks, c.operators, c.variables, c.constants);
  EXPECT_EQ(first_difference(c.spec, Sample().spec), "tasks[1].ports[4].variable");
  d.end_order[0] = TaskId{1u};
  EXPECT_EQ(first_difference(d.spec, Sample().spec), "end_order");
  Sample e, f;
  e.other[0] = TaskId{1u};
  EXPECT_EQ(first_difference(e.spec, Sample().spec), "sets[0].order");
  f.ports[0].max_step = {};
  EXPECT_EQ(first_difference(f.spec, Sample().spec), "tasks[0].ports[0].max_step");
  Sample g, h;
  g.standbys[0].primary = TaskId{1u};
  EXPECT_EQ(first_difference(g.spec, Sample().spec), "standbys[0].primary");
  h.restarts[0].within = seconds(9);
  EXPECT_EQ(first_difference(h.spec, Sample().spec), "restarts[0].within");
  Sample i;
  i.stale[0].after = seconds(1);
  EXPECT_EQ(first_difference(i.spec, Sample().spec), "stale[0].after");
  Sample j, k;
  j.standbys[0].hot = false;
  EXPECT_EQ(first_difference(j.spec, Sample().spec), "standbys[0].hot");
  k.standbys[0].stale_after = seconds(1);
  EXPECT_EQ(first_difference(k.spec, Sample().spec), "standbys[0].stale_after");
  Sample l;
  l.ports[1].shared = false;
  EXPECT_EQ(first_difference(l.spec, Sample().spec), "tasks[0].ports[1].shared");
}

TEST(ApplicationImage, StrangersAreRefusedByName) {
  const Sample sample;
  const auto good = encode(sample.spec, sample.places, sample.settings);
  EXPECT_EQ(refusal({}), "not an application image: 0 bytes");
  auto bytes = good;
  bytes[0] = std::byte{'X'};
  EXPECT_EQ(refusal(bytes), "not an application image");
  bytes = good;
  bytes[kVersionAt] = std::byte{14};
  EXPECT_EQ(refusal(bytes), "image version 14, this program reads 13");
  bytes = good;
  bytes.pop_back();
  EXPECT_EQ(refusal(bytes), "the image says it has " + std::to_string(good.size()) + " bytes, here are " +
                                std::to_string(good.size() - 1));
  bytes = good;
  bytes.back() ^= std::byte{1};
  EXPECT_EQ(refusal(bytes), "damaged image: its bytes have another hash");
}

template <class Change>
std::string refusal_of(Change change) {
  Sample sample;
  change(sample);
  return refusal(encode(sample.spec, sample.places, sample.settings));
}

bool says(const std::string& refusal, const char* why) {
  return refusal.starts_with(std::string("damaged image: ") + why + ", before byte ");
}

constexpr const char* kMisplacedEvents = "events of a periodic task, or behind a server";

TEST(ApplicationImage, RefusesSpecificationsThatVerificationNeverMakes) {
  EXPECT_EQ(refusal_of([](Sample&) {}), "accepted");
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].rtpu = RtpuId{2u}; }), "an rtpu that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.start[0] = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.init_order[0] = TaskId{}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[1].period = {}; }), "times that are not in order"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[1].deadline = seconds(1); }), "times that are not in order"));
  const char* disordered = "a server that is not in order";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].server->capacity = Nanoseconds{11}; }), disordered));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].server->period = Nanoseconds{11}; }), disordered));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].aperiodic = false; }), disordered));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].has_events = true; }), kMisplacedEvents));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].type = CHIMERA_ANY; }), "a type that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].kind = 99; }), "a port that cannot be declared"));
  const char* unfilled = "a value that does not fill its variable";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].extent[1].max = 3; }), unfilled));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].extent[0].max = 0; }), unfilled));
  EXPECT_TRUE(says(refusal_of([](Sample& s) {
    s.ports[0].value = {};
    s.ports[0].extent[0].max = s.ports[0].extent[1].max = 1u << 31;
  }), unfilled));
  const char *no_variable = "a variable that does not exist", *no_constant = "a constant that does not exist";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].variable = VariableId{3u}; }), no_variable));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].variable = {}; }), no_variable));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[1].variable = VariableId{0u}; }), no_variable));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.operators[1].variable = VariableId{3u}; }), no_variable));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.operators[1].variable = {}; }), no_variable));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.more_ports[2].constant = ConstantId{2u}; }), no_constant));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.more_ports[1].constant = {}; }), no_constant));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].constant = ConstantId{0u}; }), no_constant));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].extent[0].constant = ConstantId{2u}; }),
                   "an extent of a constant that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.operators[1].variable = Sample::kKp; }),
                   "a variable with two operator values"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.more_ports[5].variable = Sample::kX; }), "a variable without a port"));
  const char* unsettled = "a constant that is not either given or produced";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.constants[0].value = {}; }), unsettled));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.constants[1].value = bytes_of("abcdefgh"); }), unsettled));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.constants[0].value = bytes_of("abc"); }),
                   "a value that does not fill its constant"));
  const char* unordered = "an order that does not hold every task once";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.on_order[0] = TaskId{0u}; }), unordered));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.end_order[0] = TaskId{1u}; }), unordered));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.spec.init_order = s.spec.init_order.first(1); }), unordered));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.on_order[0] = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.other[0] = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.other[0] = TaskId{1u}; }), "a set that holds a task twice"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.sets[0].name = "alone"; }), "two sets of one name"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.sets[1].order = s.sets[0].order; }),
                   "a start that is none of the sets"));
  const char* misfit = "a largest step that does not fill an output";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.ports[0].max_step = bytes_of("ABCDEFGH"); }), misfit));
  EXPECT_TRUE(says(refusal_of([](Sample& s) {
    s.more_ports[0].element_bytes = 8;
    s.more_ports[0].max_step = bytes_of("ABCDEFGH");
  }), misfit));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.rtpus[0].policy = static_cast<Policy>(9); }),
                   "a choice that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.settings.priority = 100; }), "settings out of range"));
}

TEST(ApplicationImage, AReactionWithoutItsSetIsRefused) {
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].on_fault_set = 2; }), "a reaction with a wrong set"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[0].on_miss_set = 0; }), "a reaction with a wrong set"));
}

TEST(ApplicationImage, AStandbyThatCannotStandInIsRefused) {
  const char* unlike = "a standby without an output of its primary";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.standbys[0].primary = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.standbys[0].standby = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.standbys[0].standby = TaskId{1u}; }), unlike));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.standbys[0].standby = TaskId{0u}; }), "a standby of a standby"));
  const StandbySpec twice[2] = {{TaskId{0u}, TaskId{2u}}, {TaskId{0u}, TaskId{2u}}};
  EXPECT_TRUE(says(refusal_of([&](Sample& s) { s.spec.standbys = twice; }), "a standby of two tasks"));
}

/// The primary is released by a clock, every 10 ns, and may be killed for its silence.
void make_stale(Sample& s) {
  s.tasks[0].aperiodic = false;
  s.tasks[0].server = {};
  s.standbys[0].stale_after = Nanoseconds{20};
}

TEST(ApplicationImage, ALimitOfTheSilenceOfAPrimaryComesBackOrIsRefused) {
  const char* never = "a primary that cannot be killed for its silence";
  Sample sample;
  make_stale(sample);
  const auto bytes = encode(sample.spec, sample.places, sample.settings);
  const auto image = ApplicationImage::decode(bytes);
  ASSERT_TRUE(image) << image.error().message.c_str();
  EXPECT_EQ(first_difference(image->spec(), sample.spec), "");
  const auto refused = [&](auto change) {
    return refusal_of([&](Sample& s) {
      make_stale(s);
      change(s);
    });
  };
  EXPECT_TRUE(says(refused([](Sample& s) { s.standbys[0].stale_after = Nanoseconds{19}; }), never));
  EXPECT_TRUE(says(refused([](Sample& s) { s.standbys[0].stale_after = Nanoseconds{-1}; }), never));
  EXPECT_TRUE(says(refused([](Sample& s) { s.tasks[2].rtpu = RtpuId{1u}; }), never)) << "the standby dies with it";
  EXPECT_TRUE(says(refused([](Sample& s) { s.tasks[0].aperiodic = true; }), never));
}

TEST(ApplicationImage, AHotStandbyThatOthersWouldNoticeIsRefused) {
  const char* noticed = "a hot standby that others would notice";
  EXPECT_TRUE(says(refusal_of([](Sample& s) {
    s.spare_ports[1].kind = CHIMERA_RESOURCE;
    s.spare_ports[1].variable = {};
    s.spare_ports[1].element_bytes = 0;
    s.spare_ports[1].type = CHIMERA_STRING;
  }), noticed));
  EXPECT_TRUE(says(refusal_of([](Sample& s) {
    s.spare_ports[1].kind = CHIMERA_OUT_CONST;
    s.spare_ports[1].variable = {};
    s.spare_ports[1].constant = Sample::kM;
  }), noticed));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[2].aperiodic = true; }), noticed));
}

TEST(ApplicationImage, ARestartThatCannotBeDoneIsRefused) {
  const char* beyond = "a restart out of range";
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].task = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].most = 0; }), beyond));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].most = kMostRestarts + 1; }), beyond));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].within = {}; }), beyond));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].then = OnFault::kRestart; }),
                   "a choice that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].task = TaskId{1u}; }),
                   "a restart of a task without that reaction"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.spec.restarts = {}; }), "a reaction restart that is not told"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.restarts[0].then = OnFault::kFlag; }), "a reaction with a wrong set"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.tasks[2].on_fault_set = UINT16_MAX; }), "a reaction with a wrong set"));
  const RestartSpec restart = {TaskId{2u}, 1, seconds(1), OnFault::kSwitch}, twice[2] = {restart, restart};
  EXPECT_TRUE(says(refusal_of([&](Sample& s) { s.spec.restarts = twice; }), "two restarts of a task"));
}

TEST(ApplicationImage, ALimitOfAgeThatMakesNoSenseIsRefused) {
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.stale[0].task = TaskId{3u}; }), "a task that does not exist"));
  EXPECT_TRUE(says(refusal_of([](Sample& s) { s.stale[0].after = {}; }), "a limit of age out of range"));
  const StaleSpec twice[2] = {{TaskId{1u}, seconds(1)}, {TaskId{1u}, seconds(2)}};
  EXPECT_TRUE(says(refusal_of([&](Sample& s) { s.spec.stale = twice; }), "two limits of age for a task"));
}

TEST(ApplicationImage, NoTruncationAndNoChangedByteIsEverMoreThanARefusal) {
  const Sample sample;
  const auto good = encode(sample.spec, sample.places, sample.settings);
  int accepted = 0;
  for (std::size_t size = kBodyAt; size < good.size(); ++size) {
    std::vector<std::byte> bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    const std::uint64_t total = size;
    std::memcpy(bytes.data() + 16, &total, sizeof total);
    set_hash(bytes);
    EXPECT_TRUE(refusal(bytes).starts_with("damaged image: ")) << size;
  }
  std::mt19937 random(4);
  for (std::size_t at = kBodyAt; at < good.size(); ++at) {
    for (int i = 0; i < 6; ++i) {
      auto bytes = good;
      bytes[at] = i == 0 ? std::byte{0xff} : static_cast<std::byte>(random());
      set_hash(bytes);
      const auto image = ApplicationImage::decode(bytes);
      if (!image) continue;
      ++accepted;
      EXPECT_EQ(encode(image->spec(), image->places(), image->settings()), bytes);  // nothing was overlooked
    }
  }
  EXPECT_GT(accepted, 0);
}

TEST(ApplicationImage, BytesBehindTheEndAreRefused) {
  const Sample sample;
  auto bytes = encode(sample.spec, sample.places, sample.settings);
  bytes.push_back({});
  const std::uint64_t total = bytes.size();
  std::memcpy(bytes.data() + 16, &total, sizeof total);
  set_hash(bytes);
  EXPECT_TRUE(says(refusal(bytes), "more than there should be"));
}

}  // namespace
}  // namespace chimera
