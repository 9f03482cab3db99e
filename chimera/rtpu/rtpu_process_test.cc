// SPDX-License-Identifier: Apache-2.0
// The real process chimera-rtpu; the test is its keeper and its manager.
#include "chimera/rtpu/rtpu.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "chimera/base/testing/await.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/load/descriptor.h"
#include "chimera/load/sealed_objects.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/platform/wake.h"
#include "chimera/rtpu/keeper_message.h"
#include "chimera/rtpu/peers.h"
#include "chimera/runtime/hosted/application_image.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

constexpr TaskId kCounter{0u};

struct RtpuProcess : ::testing::Test {
  void SetUp() override {
    const std::string object_file = build_path("components/t_counter.so");
    auto object = SharedObject::open(object_file);
    ASSERT_TRUE(object) << object.error().message.c_str();
    const chimera_component* component = *object->component("t_counter");
    app.add("counter", component).rtpu = RtpuId(0u);
    app.make({kCounter}, false);
    const ComponentPlace place{object_file, fingerprint(*describe(*component)) + spoiled};
    objects = *FrozenBytes::create("objects", *SealedObjects::pack({&object_file, 1}));
    image = *FrozenBytes::create("image", encode(app.spec, {&place, 1}, {0, milliseconds(500)}));
    decision_pages = *SharedPages::create("decision", sizeof(DecisionPage));
    decision = new (decision_pages.bytes().data()) DecisionPage;
    keeper_pages = *MemoryRegion::create("keeper", sizeof(KeeperPage));
    keeper = new (keeper_pages.writable().data()) KeeperPage;
    keeper->origin = LinuxClock().now();
    keeper->alive[0] = keeper->alive[1] = 1;
    HeapMemory heap;
    const auto layout = PeerLayout::of(app.spec, 1, heap);
    own = *MemoryRegion::create("manager", peer_segment_bytes(layout->table(), 1));
    ASSERT_TRUE(SegmentOwner::format(own.writable(), layout->table()));
    block = BlockOwner(own.writable().data() + block_offset(layout->table()), 1, 1, 1, 2);
    peers = *MappedPeers::create(app.spec);
    start();
  }
  void start() {
    auto pair = Channel::pair();
    channel = std::move(pair->first);
    const std::string parent = std::to_string(::getpid()), program = build_path("bin/chimera-rtpu");
    const char* arguments[] = {"chimera-rtpu", "--peer", "0", "--incarnation", "1", "--parent", parent.c_str()};
    const int descriptors[] = {pair->second.descriptor(), image.descriptor(), decision_pages.descriptor(),
                               keeper_pages.descriptor(), objects.descriptor()};
    auto started = Process::start(program.c_str(), arguments, descriptors);
    ASSERT_TRUE(started) << started.error().message.c_str();
    process = *std::move(started);
  }
  bool take_segment() {
    KeeperMessage message;
    int descriptor = -1;
    if (channel.receive(bytes_of(message), descriptor) != Channel::Got::kMessage) return false;
    EXPECT_EQ(message.kind, KeeperMessage::Kind::kSegment);
    EXPECT_TRUE(peers->offer(0, message.incarnation, descriptor));
    ::close(descriptor);
    return peers->adopt(0);
  }
  void introduce_manager() {
    ASSERT_TRUE(await_that([&] { return take_segment(); }));
    KeeperMessage message;
    message.kind = KeeperMessage::Kind::kPeer;
    message.index = 1;
    message.incarnation = 1;
    ASSERT_TRUE(channel.send(bytes_of(message), own.descriptor()));
    outbox = Outbox(block.outbox(0), &peers->at(0)->block().progress(1), 1);
    inbox = Inbox(peers->at(0)->block().outbox(1), block.progress(0), 1);
    ASSERT_TRUE(await_that([&] { return outbox.is_followed(); }));
  }
  Post signal(Signal signal) {
    Post post;
    post.command = ++commands;
    post.task = kCounter;
    post.signal = signal;
    EXPECT_TRUE(outbox.try_post(post));
    Doorbell(decision->bells[0].word).ring();
    EXPECT_TRUE(await_that([&] {
      while (inbox.take(post))
        if (post.kind == PostKind::kReport && post.command == commands) return true;
      return false;
    }));
    return post;
  }
  std::int64_t count() {
    const GroupReader group = peers->at(0)->group(peers->layout(0).outputs(kCounter, 1));
    std::vector<std::byte> values(group.payload_bytes());
    chimera_slot slot;
    EXPECT_TRUE(group.try_read(slot, values.data()));
    std::int64_t n;
    std::memcpy(&n, values.data(), sizeof n);
    return n;
  }
  ProcessEnd end() {
    ProcessEnd ended;
    EXPECT_TRUE(process.wait(ended, kHangLimit.count));
    return ended;
  }

  std::uint64_t spoiled = 0;
  testing::TestApplication app;
  FrozenBytes image, objects;
  SharedPages decision_pages;
  MemoryRegion keeper_pages, own;
  DecisionPage* decision = nullptr;
  KeeperPage* keeper = nullptr;
  BlockOwner block;
  std::unique_ptr<MappedPeers> peers;
  Channel channel;
  Process process;
  Outbox outbox;
  Inbox inbox;
  std::uint64_t commands = 0;
};

TEST_F(RtpuProcess, CyclesTasksThatAreTurnedOnAndGoesOnWithoutAManager) {
  introduce_manager();
  EXPECT_EQ(signal(Signal::kSpawn).detail, 1u);
  EXPECT_EQ(signal(Signal::kOn).after, State::kOn);
  EXPECT_TRUE(await_that([&] { return count() > 20; }));
  keeper->alive[1] = 0;  // the manager is dead
  const std::int64_t then = count();
  EXPECT_TRUE(await_that([&] { return count() > then + 20; }));
  EXPECT_TRUE(await_that([&] { return peers->at(0)->block().profile(kCounter).cycles > 20; }));
  EXPECT_TRUE(std::string_view(peers->at(0)->block().head().grant).starts_with("WARNING: not real time\n"));
}

TEST_F(RtpuProcess, EndsItsTasksOnFinish) {
  introduce_manager();
  signal(Signal::kSpawn);
  signal(Signal::kOn);
  KeeperMessage message;
  message.kind = KeeperMessage::Kind::kFinish;
  ASSERT_TRUE(channel.send(bytes_of(message)));
  const ProcessEnd ended = end();
  EXPECT_FALSE(ended.by_signal);
  EXPECT_EQ(ended.code, 0);
  EXPECT_EQ(peers->at(0)->block().status(kCounter).state, State::kNotCreated);
  EXPECT_EQ(peers->at(0)->block().head().phase, PeerPhase::kEnded);
}

TEST_F(RtpuProcess, EndsItsTasksWhenItsKeeperIsGone) {
  introduce_manager();
  signal(Signal::kSpawn);
  signal(Signal::kOn);
  channel = Channel();
  EXPECT_EQ(end().code, 0);
  EXPECT_EQ(peers->at(0)->block().status(kCounter).state, State::kNotCreated);
}

TEST_F(RtpuProcess, ItsBlockKeepsTheRunningMethodWhenItDies) {
  introduce_manager();
  signal(Signal::kSpawn);
  signal(Signal::kOn);
  EXPECT_TRUE(await_that([&] { return count() > 3; }));
  process.signal(SIGKILL);
  EXPECT_TRUE(end().by_signal);
  EXPECT_EQ(peers->at(0)->block().status(kCounter).state, State::kOn);
}

struct RtpuWithAnotherComponent : RtpuProcess {
  RtpuWithAnotherComponent() { spoiled = 1; }
};

TEST_F(RtpuWithAnotherComponent, SaysWhyItCannotStart) {
  ASSERT_TRUE(await_that([&] { return take_segment(); }));
  EXPECT_EQ(end().code, 1);
  EXPECT_STREQ(peers->at(0)->block().head().grant,
               "component t_counter was rebuilt after it was verified; run again");
}

TEST(RtpuProgram, SaysThatItIsNotForPeople) {
  const std::string program = build_path("bin/chimera-rtpu");
  const char* arguments[] = {"chimera-rtpu"};
  auto process = Process::start(program.c_str(), arguments, {});
  ASSERT_TRUE(process);
  ProcessEnd ended;
  ASSERT_TRUE(process->wait(ended, kHangLimit.count));
  EXPECT_EQ(ended.code, 2);
}

}  // namespace
}  // namespace chimera
