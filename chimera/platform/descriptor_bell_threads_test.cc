// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/descriptor_bell.h"

#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <thread>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

void write_one(int descriptor) {
  const std::uint64_t one = 1;
  EXPECT_EQ(::write(descriptor, &one, sizeof one), 8);
}

TEST(DescriptorBell, SaysWhetherTheDescriptorIsReadable) {
  DescriptorBell bell;
  const OwnedDescriptor event(::eventfd(0, EFD_CLOEXEC));
  EXPECT_FALSE(bell.await(event.fd, {0}));
  bell.ring();
  EXPECT_FALSE(bell.await(event.fd, kNever)) << "a ring before the wait ends it";
  write_one(event.fd);
  EXPECT_TRUE(bell.await(event.fd, kNever));
  bell.ring();
  EXPECT_TRUE(bell.await(event.fd, kNever)) << "both at once";
  EXPECT_TRUE(bell.await(event.fd, {0})) << "until somebody reads it";
  EXPECT_FALSE(bell.await(-1, {0}));
}

TEST(DescriptorBell, IsWokenByOthers) {
  DescriptorBell bell;
  const OwnedDescriptor event(::eventfd(0, EFD_CLOEXEC));
  std::thread ringer([&] { bell.ring(); });
  EXPECT_FALSE(bell.await(event.fd, kNever));
  ringer.join();
  std::thread writer([&] { write_one(event.fd); });
  EXPECT_TRUE(bell.await(event.fd, kNever));
  writer.join();
}

}  // namespace
}  // namespace chimera
