// SPDX-License-Identifier: Apache-2.0
// Events in the C face (chimera/task/pbo.h), seen through a component written in C.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Relay : Rig {
  explicit Relay(const char* pipe) : Rig("t_relay") { resource("pipe", pipe); }
};

TEST(CFace, TheEventSourceIsTheDescriptorThatSyncReads) {
  const std::string path = "/tmp/t_relay_" + std::to_string(::getpid());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  Relay rig(path.c_str());
  ASSERT_TRUE(rig.init());
  ASSERT_GE(rig.event_source(), 0);
  EXPECT_EQ(rig.sync().status, CHIMERA_NO_EVENT);
  ASSERT_EQ(::write(rig.event_source(), "ab", 2), 2);
  EXPECT_TRUE(rig.sync());
  EXPECT_TRUE(rig.sync());
  EXPECT_EQ(rig.sync().status, CHIMERA_NO_EVENT);
  EXPECT_TRUE(rig.kill());
  EXPECT_EQ(std::remove(path.c_str()), 0);
}

TEST(CFace, WithoutADescriptorTheDoorbellIsTheOnlySource) {
  Relay rig("none");
  ASSERT_TRUE(rig.init());
  EXPECT_LT(rig.event_source(), 0);
  EXPECT_TRUE(rig.sync());
}

TEST(CFace, ADoorbellIsRungByName) {
  Relay rig("none");
  rig.set("target", Text<64>("lamp"));
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.signals(), std::vector<std::string>{"wakeup lamp"});
}

TEST(CFace, AConfigurationIsAskedForByName) {
  Relay rig("none");
  rig.set("set", Text<64>("figure_9"));
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.signals(), std::vector<std::string>{"request figure_9"});
}

TEST(CFace, CycleMayPublishAPartialResult) {
  Relay rig("none");
  rig.set("target", Text<64>("lamp"));
  rig.expire(true);
  EXPECT_EQ(rig.cycle().status, CHIMERA_PARTIAL);
  EXPECT_EQ(rig.get<std::int64_t>("passed"), 1);
  EXPECT_TRUE(rig.signals().empty());
}

}  // namespace
}  // namespace chimera
