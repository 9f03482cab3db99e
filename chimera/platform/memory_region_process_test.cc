// SPDX-License-Identifier: Apache-2.0
// What a reader of a shared region may do: read, and nothing else. Tried by a second process, as the same user.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string>

#include "chimera/platform/memory_region.h"

namespace chimera {
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

TEST(MemoryRegion, ASecondMappingSeesWhatTheOwnerWrites) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value()) << owner.error().message.view();
  owner->writable()[4000] = std::byte{42};
  EXPECT_EQ(in_child([&] {
              const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
              return reader && reader->writable().empty() && reader->bytes()[4000] == std::byte{42} ? 0 : 1;
            }),
            0);
}

TEST(MemoryRegion, AReaderThatWritesDies) {
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

TEST(MemoryRegion, AReaderCannotMakeItsMappingWritable) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
  ASSERT_TRUE(reader.has_value());
  auto* page = const_cast<std::byte*>(reader->bytes().data());
  EXPECT_EQ(::mprotect(page, kBytes, PROT_READ | PROT_WRITE), -1);
  EXPECT_EQ(errno, EACCES);
}

TEST(MemoryRegion, ReopeningItThroughProcGivesNoWayToWrite) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  const auto reader = MemoryRegion::open_read_only(owner->descriptor(), kBytes);
  ASSERT_TRUE(reader.has_value());
  const int again = ::open(self_fd(reader->descriptor()).c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(again, 0) << "the same user may open it; the seal is what holds";
  EXPECT_EQ(::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, again, 0), MAP_FAILED);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::write(again, "x", 1), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fallocate(again, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, 4096), -1);
  EXPECT_EQ(errno, EPERM);
  ::close(again);
}

TEST(MemoryRegion, NobodyChangesItsSizeOrItsSeals) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  EXPECT_EQ(::ftruncate(owner->descriptor(), 0), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::ftruncate(owner->descriptor(), 2 * kBytes), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(::fcntl(owner->descriptor(), F_ADD_SEALS, F_SEAL_WRITE), -1);
  EXPECT_EQ(errno, EPERM);
}

TEST(MemoryRegion, IsForItsUserAlone) {
  const Result<MemoryRegion> owner = MemoryRegion::create("test", kBytes);
  ASSERT_TRUE(owner.has_value());
  struct stat status {};
  ASSERT_EQ(::fstat(owner->descriptor(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
}

TEST(MemoryRegion, RefusesWhatIsNotSealedOrNotOfTheRightSize) {
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

TEST(MemoryRegion, RefusesMoreThanTheSystemHas) {
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

}  // namespace
}  // namespace chimera
