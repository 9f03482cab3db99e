// SPDX-License-Identifier: Apache-2.0
// What a second process of the same user may do with shared memory.
#include "chimera/platform/shared_memory.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>

#include "chimera/platform/wake.h"

namespace chimera::shared_memory_process_test {
namespace {

constexpr std::uint64_t kBytes = 8192;

// Runs `body` in a child process; its exit status, or 256 + signal.
template <class Body>
int in_child(Body body) {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(body());
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
}

std::string self_fd(int fd) { return "/proc/self/fd/" + std::to_string(fd); }

TEST(MemoryRegion, SecondMappingSeesWritesOfTheOwner) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value()) << owner.error().message.view();
  owner->writable()[4000] = std::byte{42};
  EXPECT_EQ(in_child([&] {
              const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
              return reader && reader->writable().empty() && reader->bytes()[4000] == std::byte{42} ? 0 : 1;
            }),
            0);
}

TEST(MemoryRegion, ReaderThatWritesDies) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  EXPECT_EQ(in_child([&] {
              const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
              if (!reader) return 1;
              std::signal(SIGSEGV, SIG_DFL);
              const_cast<std::byte&>(reader->bytes()[0]) = std::byte{1};
              return 2;
            }),
            256 + SIGSEGV);
  EXPECT_EQ(owner->bytes()[0], std::byte{0});
}

TEST(MemoryRegion, ReaderCannotMakeItsMappingWritable) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
  ASSERT_TRUE(reader.has_value());
  auto* page = const_cast<std::byte*>(reader->bytes().data());
  EXPECT_EQ(::mprotect(page, kBytes, PROT_READ | PROT_WRITE), -1);
  EXPECT_EQ(errno, EACCES);
}

TEST(MemoryRegion, ReopeningThroughProcGivesNoWayToWrite) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
  ASSERT_TRUE(reader.has_value());
  const int again = ::open(self_fd(reader->descriptor()).c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(again, 0) << "the same user may open the file; the seal protects it";
  EXPECT_EQ(::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, again, 0), MAP_FAILED);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::write(again, "x", 1), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fallocate(again, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, 4096), -1);
  EXPECT_EQ(errno, EPERM);
  ::close(again);
}

TEST(MemoryRegion, KeepsItsSizeAndItsSeals) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  EXPECT_EQ(::ftruncate(owner->descriptor(), 0), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::ftruncate(owner->descriptor(), 2 * kBytes), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fcntl(owner->descriptor(), F_ADD_SEALS, F_SEAL_WRITE), -1);
  EXPECT_EQ(errno, EPERM);
}

TEST(MemoryRegion, IsForItsUserOnly) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  struct stat status {};
  ASSERT_EQ(::fstat(owner->descriptor(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
}

TEST(MemoryRegion, RefusesAFileWithoutSealsOrOfAnotherSize) {
  const int plain = ::memfd_create("plain", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  ASSERT_EQ(::ftruncate(plain, kBytes), 0);
  const auto unsealed = MemoryRegion::open_read_only(plain, kBytes);
  ASSERT_FALSE(unsealed.has_value());
  EXPECT_EQ(unsealed.error().message.view(),
            "descriptor " + std::to_string(plain) +
                " is not a sealed memory region: its owner could shrink it, or a stranger write to it");
  ::close(plain);
  EXPECT_FALSE(MemoryRegion::open_read_only(-1, kBytes).has_value());
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  const auto wrong = MemoryRegion::open_read_only(owner->descriptor(), kBytes + 1);
  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().message.view(), "memory region has 8192 bytes, expected 12288");
  const auto none = MemoryRegion::create("test", 0);
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().message.view(), "shared memory of 0 bytes makes no sense");
}

TEST(MemoryRegion, RefusesMoreMemoryThanTheSystemHas) {
  const auto huge = MemoryRegion::create("test", std::uint64_t{1} << 62);
  ASSERT_FALSE(huge.has_value());
  EXPECT_EQ(huge.error().code, ErrorCode::kSystem);
  EXPECT_TRUE(huge.error().message.view().starts_with("shared memory of 4611686018427387904 bytes: "));
}

TEST(MemoryRegion, MovesWithoutLosingOrClosingTwice) {
  Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  const int fd = owner->descriptor();
  {
    MemoryRegion moved = std::move(*owner);
    EXPECT_EQ(moved.descriptor(), fd);
    EXPECT_EQ(owner->descriptor(), -1);
    moved.writable()[0] = std::byte{1};
  }
  EXPECT_EQ(::fcntl(fd, F_GETFD), -1);
}

std::span<const std::byte> text(const char* words) { return std::as_bytes(std::span(words, std::strlen(words))); }

TEST(SharedPages, AreWrittenByEveryProcessThatMapsThem) {
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

TEST(SharedPages, BellRungInOneProcessWakesAnother) {
  const auto pages = SharedPages::create("test", 4096);
  ASSERT_TRUE(pages.has_value());
  const Doorbell bell(*reinterpret_cast<std::atomic<std::uint32_t>*>(pages->bytes().data()));
  const std::uint32_t seen = bell.read();
  const pid_t ringer = ::fork();
  if (ringer == 0) {
    LinuxClock clock;
    const Nanoseconds until = clock.now() + milliseconds(5);
    while (clock.wait_until(until) != WaitEnd::kReached) {
    }
    const auto mine = SharedPages::open(pages->descriptor(), 4096);
    if (!mine) ::_exit(1);
    Doorbell(*reinterpret_cast<std::atomic<std::uint32_t>*>(mine->bytes().data())).ring();
    ::_exit(0);
  }
  LinuxClock clock;
  const Nanoseconds limit = clock.now() + seconds(60);
  while (bell.read() == seen && clock.now() < limit) bell.wait_until(seen, limit);
  EXPECT_EQ(bell.read(), seen + 1);
  int status = -1;
  ::waitpid(ringer, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(SharedPages, KeepTheirSizeAndSeals) {
  const auto pages = SharedPages::create("test", 4096);
  ASSERT_TRUE(pages.has_value());
  EXPECT_EQ(::ftruncate(pages->descriptor(), 0), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::ftruncate(pages->descriptor(), 8192), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fcntl(pages->descriptor(), F_ADD_SEALS, F_SEAL_WRITE), -1);
  EXPECT_EQ(errno, EPERM);
}

TEST(SharedPages, RefuseAFileWithoutSealsOrOfAnotherSize) {
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
  EXPECT_FALSE(SharedPages::open(owned->descriptor(), 4096).has_value()) << "a MemoryRegion has one writer";
}

TEST(FrozenBytes, AreReadByAProcessWithTheDescriptor) {
  const auto bytes = FrozenBytes::create("test", text("the application"));
  ASSERT_TRUE(bytes.has_value()) << bytes.error().message.view();
  EXPECT_EQ(in_child([&] {
              const auto mine = FrozenBytes::open(bytes->descriptor());
              if (!mine || mine->bytes().size() != 15) return 1;
              return std::memcmp(mine->bytes().data(), "the application", 15) == 0 ? 0 : 2;
            }),
            0);
}

TEST(FrozenBytes, KeepTheirContent) {
  const auto bytes = FrozenBytes::create("test", text("the application"));
  ASSERT_TRUE(bytes.has_value());
  const std::string path = "/proc/self/fd/" + std::to_string(bytes->descriptor());
  const int again = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(again, 0) << "the same user may open the file; the seal protects it";
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

TEST(FrozenBytes, RefuseAFileThatCouldChange) {
  const auto pages = SharedPages::create("test", 4096);
  const auto refused = FrozenBytes::open(pages->descriptor());
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().message.view(),
            "descriptor " + std::to_string(pages->descriptor()) +
                " is not a sealed memory region: its owner could shrink it, or a stranger write to it");
  EXPECT_FALSE(FrozenBytes::open(-1).has_value());
  EXPECT_EQ(FrozenBytes::create("test", {}).error().message.view(), "shared memory of 0 bytes makes no sense");
}

TEST(FamilyMemory, RefusesZeroBytes) { EXPECT_EQ(FamilyMemory::create(0).error().message.view(), "Invalid argument"); }

}  // namespace
}  // namespace chimera::shared_memory_process_test
