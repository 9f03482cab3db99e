// SPDX-License-Identifier: Apache-2.0
// The two other kinds of shared memory: writable for everybody, and for nobody.
#include "chimera/platform/shared_pages.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "chimera/platform/doorbell.h"
#include "chimera/platform/frozen_bytes.h"
#include "chimera/platform/linux_clock.h"
#include "chimera/platform/memory_region.h"

namespace chimera {
namespace {

template <class Body>
int in_child(Body body) {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(body());
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
}

std::span<const std::byte> text(const char* words) { return std::as_bytes(std::span(words, std::strlen(words))); }

TEST(SharedPages, EveryProcessThatMapsThemMayWrite) {
  const auto pages = SharedPages::create("test", 100);
  ASSERT_TRUE(pages.has_value()) << pages.error().message.view();
  EXPECT_EQ(pages->bytes().size(), 4096u);
  EXPECT_EQ(in_child([&] {
              const auto mine = SharedPages::open(pages->descriptor(), 100);
              if (!mine) return 1;
              mine->bytes()[7] = std::byte{42};
              return 0;
            }),
            0);
  EXPECT_EQ(pages->bytes()[7], std::byte{42});
}

TEST(SharedPages, ABellRungInOneProcessWakesAnother) {
  const auto pages = SharedPages::create("test", 4096);
  ASSERT_TRUE(pages.has_value());
  const Doorbell bell(*reinterpret_cast<std::atomic<std::uint32_t>*>(pages->bytes().data()));
  const std::uint32_t seen = bell.read();
  const pid_t ringer = ::fork();
  if (ringer == 0) {
    LinuxClock clock;
    const Nanoseconds until = clock.now() + milliseconds(5);
    while (clock.wait_until(until) != WaitEnd::kReached) {}
    const auto mine = SharedPages::open(pages->descriptor(), 4096);
    if (!mine) ::_exit(1);
    Doorbell(*reinterpret_cast<std::atomic<std::uint32_t>*>(mine->bytes().data())).ring();
    ::_exit(0);
  }
  LinuxClock clock;
  const Nanoseconds limit = clock.now() + seconds(10);
  while (bell.read() == seen && clock.now() < limit) bell.wait_until(seen, limit);
  EXPECT_EQ(bell.read(), seen + 1);
  int status = -1;
  ::waitpid(ringer, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(SharedPages, NobodyChangesTheirSizeOrSeals) {
  const auto pages = SharedPages::create("test", 4096);
  ASSERT_TRUE(pages.has_value());
  EXPECT_EQ(::ftruncate(pages->descriptor(), 0), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::ftruncate(pages->descriptor(), 8192), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fcntl(pages->descriptor(), F_ADD_SEALS, F_SEAL_WRITE), -1);
  EXPECT_EQ(errno, EPERM);
}

TEST(SharedPages, RefuseWhatIsNotSealedOrNotOfTheRightSize) {
  const int plain = ::memfd_create("plain", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  ASSERT_EQ(::ftruncate(plain, 4096), 0);
  const auto unsealed = SharedPages::open(plain, 4096);
  ASSERT_FALSE(unsealed.has_value());
  EXPECT_EQ(unsealed.error().message.view(),
            "descriptor " + std::to_string(plain) +
                " is not a sealed memory region: its owner could shrink it, or a stranger write to it");
  ::close(plain);
  const auto pages = SharedPages::create("test", 4096);
  const auto wrong = SharedPages::open(pages->descriptor(), 4097);
  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().message.view(), "shared pages have 4096 bytes, expected 8192");
  EXPECT_EQ(SharedPages::create("test", 0).error().message.view(), "shared memory of 0 bytes makes no sense");
  const auto owned = MemoryRegion::create("test", 4096);
  EXPECT_FALSE(SharedPages::open(owned->descriptor(), 4096).has_value()) << "has one owner";
}

TEST(FrozenBytes, AreReadByWhoeverHasTheDescriptor) {
  const auto bytes = FrozenBytes::create("test", text("the application"));
  ASSERT_TRUE(bytes.has_value()) << bytes.error().message.view();
  EXPECT_EQ(in_child([&] {
              const auto mine = FrozenBytes::open(bytes->descriptor());
              if (!mine || mine->bytes().size() != 15) return 1;
              return std::memcmp(mine->bytes().data(), "the application", 15) == 0 ? 0 : 2;
            }),
            0);
}

TEST(FrozenBytes, NobodyChangesThem) {
  const auto bytes = FrozenBytes::create("test", text("the application"));
  ASSERT_TRUE(bytes.has_value());
  const std::string path = "/proc/self/fd/" + std::to_string(bytes->descriptor());
  const int again = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(again, 0) << "the same user may open it; the seal is what holds";
  EXPECT_EQ(::write(again, "x", 1), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, again, 0), MAP_FAILED);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::ftruncate(again, 4), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fcntl(again, F_ADD_SEALS, F_SEAL_FUTURE_WRITE), -1);
  EXPECT_EQ(errno, EPERM);
  ::close(again);
}

TEST(FrozenBytes, RefuseWhatCouldStillChange) {
  const auto pages = SharedPages::create("test", 4096);
  const auto refused = FrozenBytes::open(pages->descriptor());
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().message.view(),
            "descriptor " + std::to_string(pages->descriptor()) +
                " is not a sealed memory region: its owner could shrink it, or a stranger write to it");
  EXPECT_FALSE(FrozenBytes::open(-1).has_value());
  EXPECT_EQ(FrozenBytes::create("test", {}).error().message.view(), "shared memory of 0 bytes makes no sense");
}

}  // namespace
}  // namespace chimera
