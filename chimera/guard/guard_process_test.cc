// SPDX-License-Identifier: Apache-2.0
// The guard with real processes as its rtpus; the test writes their memory and their messages.
#include "chimera/guard/guard.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <optional>
#include <string>

#include "chimera/base/testing/await.h"
#include "chimera/base/testing/few_descriptors.h"
#include "chimera/platform/allocation_count.h"
#include "chimera/platform/process.h"
#include "chimera/rtpu/guard_link.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

struct Driver {
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) {}
};

/// Both ends of a pipe; its writes do not wait.
struct Device {
  Device() { EXPECT_EQ(::pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0); }
  ~Device() {
    ::close(ends[0]);
    if (ends[1] >= 0) ::close(ends[1]);
  }
  std::string heard() const {
    char bytes[8192];
    const ssize_t got = ::read(ends[0], bytes, sizeof bytes);
    return got > 0 ? std::string(bytes, static_cast<std::size_t>(got)) : "";
  }
  /// Fills the pipe: from here on the device accepts no byte.
  void fill() const {
    const char bytes[4096] = {};
    while (::write(ends[1], bytes, sizeof bytes) > 0) continue;
    while (::write(ends[1], bytes, 1) > 0) continue;
  }
  int ends[2] = {-1, -1};
};

/// One incarnation of the rtpu: an idle process, memory as an rtpu makes it, and the rtpu's end of its line.
struct Life {
  Life(const ApplicationSpec& spec, std::uint32_t rtpu, std::uint32_t incarnation, int line)
      : link(line, rtpu, incarnation) {
    const PeerLayout layout = *PeerLayout::of(spec, rtpu, heap);
    const auto tasks = static_cast<std::uint32_t>(spec.tasks.size());
    memory = *MemoryRegion::create("rtpu", peer_segment_bytes(layout.table(), tasks));
    const auto table = SegmentOwner::format(memory.writable(), layout.table());
    block = BlockOwner(memory.writable().data() + block_offset(layout.table()), rtpu, incarnation, tasks, 3);
    for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
      if (spec.tasks[t].rtpu != RtpuId(std::size_t{rtpu})) continue;
      outputs.push_back(table->writer(SegmentView::planned(layout.table(), layout.outputs(TaskId(t), 0), 0)));
    }
    const char* const words[] = {"sleep", "60"};
    process = *Process::start("/bin/sleep", words, {});
  }
  ~Life() {
    process.signal(SIGKILL);
    ProcessEnd how;
    process.wait(how, kHangLimit.count);
  }
  void publish(std::size_t task) {
    const double value = 1;
    outputs[task].write(reinterpret_cast<const std::byte*>(&value), {1}, 1);
  }
  void put(std::size_t task, std::uint32_t frame, const std::string& text) {
    block.safe_frames(TaskId(task))[frame].put(std::as_bytes(std::span(text)));
  }

  HeapMemory heap;
  MemoryRegion memory;
  BlockOwner block;
  std::vector<GroupWriter> outputs;
  Process process;
  GuardLink link;
};

struct GuardTest : ::testing::Test {
  GuardTest() {
    app.rtpus = {{"a", 0, Policy::kEdf}, {"b", 1, Policy::kEdf}};
    app.add("first", testing::component<Driver>("first"), milliseconds(2)).rtpu = RtpuId(std::size_t{0});
    app.add("second", testing::component<Driver>("second"), milliseconds(2)).rtpu = RtpuId(std::size_t{0});
    app.add("spare", testing::component<Driver>("second"), milliseconds(2)).rtpu = RtpuId(std::size_t{1});
    app.link(0, 0, "a");
    app.link(1, 0, "b");
    app.link(2, 0, "b");
    make_image();
  }
  /// `spare` takes over from `second` when `second` is silent for 40 ms.
  void make_image(std::vector<StandbySpec> standbys = {}) {
    ApplicationSpec spec = app.make();
    spec.standbys = standbys;
    const std::vector<ComponentPlace> places(3);
    bytes = encode(spec, places, {});
    image.emplace(*ApplicationImage::decode(bytes));
  }
  void start(std::vector<SilenceLimit> limits = {}) {
    auto ends = Channel::pair();
    keeper = std::move(ends->first);
    guard = *Guard::create(std::move(ends->second), *image, limits);
  }
  /// The next incarnation of the rtpu. The guard knows it only from the keeper: the rtpu has sent no message yet.
  std::unique_ptr<Life> begin(std::uint32_t rtpu = 0) {
    auto ends = Channel::pair();
    const int line = ::fcntl(ends->second.descriptor(), F_DUPFD_CLOEXEC, 0);
    auto life = std::make_unique<Life>(image->spec(), rtpu, ++incarnation, line);
    tell(GuardMessage::Kind::kRtpu, rtpu, life->process.pidfd());
    tell(GuardMessage::Kind::kLine, rtpu, ends->first.descriptor());
    life->link.show(life->memory.descriptor(), life->block);
    return life;
  }
  void tell(GuardMessage::Kind kind, std::uint32_t rtpu, int passed) {
    const GuardMessage message{.kind = kind, .index = rtpu, .incarnation = incarnation};
    ASSERT_TRUE(keeper.send(bytes_of(message), passed));
  }
  bool step() { return guard->step(milliseconds(1)); }
  bool until(const std::function<bool()>& is_so) {
    return await_that([&] { return step(), is_so(); });
  }
  /// "kind good/bad" of the next message of the guard.
  std::string told() {
    GuardMessage message;
    int passed = -1;
    std::string text;
    until([&] { return keeper.receive(bytes_of(message), passed) == Channel::Got::kMessage; });
    text = std::to_string(static_cast<int>(message.kind)) + " " + std::to_string(message.good) + "/" +
           std::to_string(message.bad);
    last = message;
    return text;
  }
  const std::string kWritten = std::to_string(static_cast<int>(GuardMessage::Kind::kWritten)) + " ";

  testing::TestApplication app;
  std::vector<std::byte> bytes;
  std::optional<ApplicationImage> image;
  Channel keeper;
  std::unique_ptr<Guard> guard;
  std::uint32_t incarnation = 0;
  GuardMessage last;
};

TEST_F(GuardTest, WritesTheFramesOfAnRtpuThatIsDeadAndNotBefore) {
  start();
  const Device one, other;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, one.ends[1], {}));
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{1}), 3, other.ends[1], {}));
  life->put(0, 0, "stop");
  life->put(1, 3, "hold");
  life->put(1, 2, "without a device");
  for (int i = 0; i < 20; ++i) step();
  EXPECT_EQ(one.heard(), "");
  life->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "2/0");
  EXPECT_EQ(one.heard(), "stop");
  EXPECT_EQ(other.heard(), "hold");
  EXPECT_GE(last.at, last.died);
  EXPECT_GT(last.died, Nanoseconds{});
}

TEST_F(GuardTest, WritesFramesPostedBeforeTheDeathAndReadAfterIt) {
  start();
  const Device device;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
  life->put(0, 0, "stop");
  life->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_EQ(device.heard(), "stop");
}

TEST_F(GuardTest, AFrameThatWasTakenBackIsNotWritten) {
  start();
  const Device device, given_up;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{1}), 0, given_up.ends[1], {}));
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{1}), 0, -1, {}));
  life->put(0, 0, "stop");
  life->put(1, 0, "stop");
  life->link.take_back(TaskId(std::size_t{0}));
  life->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "0/0");
  EXPECT_EQ(device.heard() + given_up.heard(), "");
}

TEST_F(GuardTest, GoesOnWithoutAKeeperUntilTheLastRtpuIsDead) {
  start();
  const Device device;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
  life->put(0, 0, "stop");
  step();
  keeper = Channel();
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(step());
  life->process.signal(SIGKILL);
  EXPECT_TRUE(until([&] { return !guard->step(milliseconds(1)); }));
  EXPECT_EQ(device.heard(), "stop");
}

TEST_F(GuardTest, ASuccessorHasDevicesOfItsOwn) {
  start();
  const Device before, after;
  const auto first = begin();
  ASSERT_TRUE(first->link.keep(TaskId(std::size_t{0}), 0, before.ends[1], {}));
  first->put(0, 0, "first");
  first->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "1/0");
  const auto second = begin();
  second->put(0, 0, "none yet");
  second->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "0/0") << "the device of the first one is not its";
  const auto third = begin();
  ASSERT_TRUE(third->link.keep(TaskId(std::size_t{0}), 0, after.ends[1], {}));
  third->put(0, 0, "third");
  third->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_EQ(before.heard(), "first");
  EXPECT_EQ(after.heard(), "third");
}

/// The guard was stopped while an rtpu died and its successor began to drive one of two devices.
TEST_F(GuardTest, WritesNoLateFrameToADeviceThatTheSuccessorDrives) {
  start();
  const Device driven, left_alone, own;
  const auto first = begin();
  ASSERT_TRUE(first->link.keep(TaskId(std::size_t{0}), 0, driven.ends[1], {}));
  ASSERT_TRUE(first->link.keep(TaskId(std::size_t{1}), 0, left_alone.ends[1], {}));
  first->put(0, 0, "first");
  first->put(1, 0, "first");
  step();
  first->process.signal(SIGKILL);
  const auto second = begin();
  ASSERT_TRUE(second->link.keep(TaskId(std::size_t{0}), 0, own.ends[1], {}));
  second->put(0, 0, "second");
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_EQ(last.late, 1u);
  EXPECT_EQ(last.incarnation, 1u);
  EXPECT_EQ(driven.heard(), "");
  EXPECT_EQ(left_alone.heard(), "first") << "the successor has no frame for it: it commands nothing yet";
  second->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_EQ(last.incarnation, 2u);
  EXPECT_EQ(own.heard(), "second");
}

TEST_F(GuardTest, WritesTheFramesOfEveryLifeThatItMissed) {
  start();
  const Device devices[3];
  std::vector<std::unique_ptr<Life>> lives;
  for (const Device& device : devices) {
    lives.push_back(begin());
    ASSERT_TRUE(lives.back()->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
    if (&device != &devices[1]) lives.back()->put(0, 0, "stop");
    lives.back()->process.signal(SIGKILL);
  }
  EXPECT_EQ(told(), kWritten + "1/0") << "the second one had not begun to drive";
  EXPECT_EQ(told(), kWritten + "0/0");
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_EQ(devices[0].heard() + devices[1].heard() + devices[2].heard(), "stopstop");
}

TEST_F(GuardTest, SaysWhyItCannotWriteTheFramesOfAnRtpu) {
  const std::string unguarded = std::to_string(static_cast<int>(GuardMessage::Kind::kUnguarded)) + " 0/";
  // Room for: nothing; process and line; the memory as well, but not its mapping; all but the second device.
  for (const int room : {0, 2, 3, 4}) {
    start();
    const Device device;
    const auto life = begin();
    ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
    ASSERT_TRUE(life->link.keep(TaskId(std::size_t{1}), 0, device.ends[1], {}));
    {
      const FewDescriptors few(room);
      for (int i = 0; i < 3; ++i) step();
    }
    EXPECT_EQ(told(), unguarded + std::to_string(EMFILE)) << room;
    EXPECT_EQ(last.index, 0u);
    EXPECT_EQ(last.incarnation, incarnation);
  }
}

TEST_F(GuardTest, ADeviceThatTakesNothingHoldsUpNoOther) {
  start();
  const Device full, free;
  full.fill();
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, full.ends[1], {}));
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 1, free.ends[1], {}));
  life->put(0, 0, "stop");
  life->put(0, 1, "stop");
  life->process.signal(SIGKILL);
  ASSERT_TRUE(until([&] { return free.heard() == "stop"; }));
  EXPECT_EQ(told(), kWritten + "1/1") << "given up after its time";
}

TEST_F(GuardTest, TheLineRestsBefore) {
  start();
  const Device device;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], milliseconds(30)));
  life->put(0, 0, "stop");
  life->process.signal(SIGKILL);
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_GE(last.at - last.died, milliseconds(30));
}

TEST_F(GuardTest, EndsTheRtpuOfATaskThatIsSilentForTooLong) {
  start({{TaskId(std::size_t{1}), 20}});
  const Device device;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
  life->put(0, 0, "stop");
  life->block.set_status(TaskId(std::size_t{0}), {State::kOn, false, 0});  // has no limit
  life->block.set_status(TaskId(std::size_t{1}), {State::kOn, false, 0});
  LinuxClock clock;
  for (const Nanoseconds end = clock.now() + milliseconds(100); clock.now() < end;) {
    life->publish(1);
    step();
  }
  EXPECT_EQ(device.heard(), "");
  EXPECT_EQ(told(), std::to_string(static_cast<int>(GuardMessage::Kind::kSilent)) + " 0/0");
  EXPECT_EQ(last.task, 1u);
  EXPECT_EQ(told(), kWritten + "1/0");
  EXPECT_EQ(device.heard(), "stop");
}

TEST_F(GuardTest, EndsTheRtpuOfASilentPrimaryIfAStandbyCanTakeOver) {
  make_image({{TaskId(std::size_t{1}), TaskId(std::size_t{2}), milliseconds(40), false}});
  start();
  const auto primary = begin(0), standby = begin(1);
  primary->block.set_status(TaskId(std::size_t{1}), {State::kOn, false, 0});
  const auto stays = [&](Nanoseconds for_so_long) {
    LinuxClock clock;
    for (const Nanoseconds end = clock.now() + for_so_long; clock.now() < end;) step();
    ProcessEnd how;
    return !primary->process.has_ended(how);
  };
  EXPECT_TRUE(stays(milliseconds(80))) << "no standby could take over";
  standby->block.set_status(TaskId(std::size_t{2}), {State::kError, false, 0});
  EXPECT_TRUE(stays(milliseconds(80)));
  LinuxClock clock;
  standby->block.set_status(TaskId(std::size_t{2}), {State::kOff, false, 0});
  const Nanoseconds since = clock.now();
  EXPECT_EQ(told(), std::to_string(static_cast<int>(GuardMessage::Kind::kSilent)) + " 1/0") << "for a standby";
  EXPECT_GE(clock.now() - since, milliseconds(40));
  EXPECT_EQ(last.task, 1u);
  EXPECT_EQ(last.index, 0u);
  EXPECT_EQ(told(), kWritten + "0/0");
}

TEST_F(GuardTest, ALimitForATaskThatThereIsNotIsRefused) {
  auto ends = Channel::pair();
  const SilenceLimit wrong[] = {{TaskId(std::size_t{3}), 3}}, none[] = {{TaskId(std::size_t{0}), 0}};
  EXPECT_FALSE(Guard::create(Channel(), *image, wrong));
  EXPECT_FALSE(Guard::create(Channel(), *image, none));
}

TEST_F(GuardTest, AsksTheHeapForNothingOnceItRuns) {
  watch_allocations();
  start();
  const Device device;
  const auto life = begin();
  ASSERT_TRUE(life->link.keep(TaskId(std::size_t{0}), 0, device.ends[1], {}));
  life->put(0, 0, "stop");
  const std::uint64_t before = allocations_of_this_thread();
  guard->step(milliseconds(1));
  life->process.signal(SIGKILL);
  std::string heard;  // short enough to need no heap
  for (int i = 0; i < 60'000 && (i < 20 || heard.empty()); ++i) {  // it dies when it gets a CPU
    guard->step(milliseconds(1));
    heard += device.heard();
  }
  EXPECT_EQ(allocations_of_this_thread(), before);
  EXPECT_EQ(heard, "stop");
}

}  // namespace
}  // namespace chimera
