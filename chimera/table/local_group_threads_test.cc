// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/local_group.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

namespace chimera::local_group_threads_test {
namespace {

constexpr std::uint32_t kPayload = 1u << 20;  // the copy takes so much time that another thread runs during it

struct alignas(kCacheLine) Group {
  std::byte bytes[group_bytes(kPayload)]{};
};
struct alignas(kCacheLine) Local {
  std::byte bytes[local_group_bytes(kPayload)]{};
};

TEST(LocalGroupThreads, AnOvertakenReadKeepsThePreviousCopyAndCounts) {
  auto group = std::make_unique<Group>();
  auto memory = std::make_unique<Local>();
  GroupWriter writer(group->bytes, kPayload);
  const std::vector<std::byte> ones(kPayload, std::byte{1});
  writer.write(ones.data(), Nanoseconds{1}, 1);
  LocalGroup local(GroupReader(group->bytes, kPayload), memory->bytes);
  ASSERT_TRUE(local.refresh());

  std::atomic<bool> stop{false};
  std::thread flood([&] {  // publishes without pause, so fast that no copy ends in time
    GroupWriter fast(group->bytes, kPayload);
    while (!stop.load(std::memory_order_relaxed)) fast.publish(Nanoseconds{2}, 1);
  });
  chimera_slot before = *local.slot();
  const chimera_slot* place = local.slot();
  while (local.stale() == 0) {
    if (local.refresh()) {
      before = *local.slot();
      place = local.slot();
    }
  }
  stop = true;
  flood.join();
  EXPECT_EQ(local.stale(), 1u);
  EXPECT_EQ(local.slot(), place);
  EXPECT_EQ(local.slot()->sequence, before.sequence);
  EXPECT_TRUE(local.refresh()) << "reads again once the writer is at rest";
  EXPECT_GT(local.slot()->sequence, before.sequence);
}

}  // namespace
}  // namespace chimera::local_group_threads_test
