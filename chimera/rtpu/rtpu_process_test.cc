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
    const ComponentPlace place{object_file, fingerprint(*describe(*component)) + 1};  // another component
    objects = *FrozenBytes::create("objects", *SealedObjects::pack({&object_file, 1}));
    image = *FrozenBytes::create("image", encode(app.spec, {&place, 1}, {0, milliseconds(500)}));
    decision_pages = *SharedPages::create("decision", sizeof(DecisionPage));
    new (decision_pages.bytes().data()) DecisionPage;
    keeper_pages = *MemoryRegion::create("keeper", sizeof(KeeperPage));
    auto* const keeper = new (keeper_pages.writable().data()) KeeperPage;
    keeper->origin = LinuxClock().now();
    keeper->alive[0] = keeper->alive[1] = 1;
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
  ProcessEnd end() {
    ProcessEnd ended;
    EXPECT_TRUE(process.wait(ended, kHangLimit.count));
    return ended;
  }

  testing::TestApplication app;
  FrozenBytes image, objects;
  SharedPages decision_pages;
  MemoryRegion keeper_pages;
  std::unique_ptr<MappedPeers> peers;
  Channel channel;
  Process process;
};

TEST_F(RtpuProcess, SaysWhyItCannotStart) {
  ASSERT_TRUE(await_that([&] { return take_segment(); }));
  EXPECT_EQ(end().code, 1);
  EXPECT_STREQ(peers->at(0)->block().head().grant,
               "component t_counter was rebuilt after it was verified; run again");
}

}  // namespace
}  // namespace chimera
