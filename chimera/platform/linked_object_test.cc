// SPDX-License-Identifier: Apache-2.0
// Sealed copies. The tests of chimera/load link objects.
#include "chimera/platform/linked_object.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>

#include "chimera/platform/file.h"

namespace chimera {
namespace {

std::string content(int file) {
  std::string text(static_cast<std::size_t>(file_size(file)), '\0');
  EXPECT_EQ(read_at(file, 0, std::as_writable_bytes(std::span(text))), std::ssize(text));
  return text;
}

TEST(SealedCopy, HasTheBytesAndRefusesOthers) {
  std::FILE* file = std::tmpfile();
  const std::string text(100'000, 'x');
  ASSERT_EQ(std::fwrite(text.data(), 1, text.size(), file), text.size());
  std::rewind(file);
  const auto copy = sealed_copy(::fileno(file), "copy", "a.so");
  std::fclose(file);
  ASSERT_TRUE(copy);
  EXPECT_EQ(content(copy->fd), text);
  EXPECT_EQ(::pwrite(copy->fd, "y", 1, 0), -1);
  EXPECT_NE(::ftruncate(copy->fd, 0), 0);
  const auto linked = link_object(OwnedDescriptor(::dup(copy->fd)));
  EXPECT_EQ(linked.error().message.view(), "invalid ELF header");
}

TEST(SealedCopy, RefusesAFileThatCannotBeRead) {
  const OwnedDescriptor file(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  const auto refused = sealed_copy(file.fd, "copy", "a.so");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.view(), "cannot be read: Bad file descriptor");
  EXPECT_EQ(refused.error().where.view(), "a.so");
}

}  // namespace
}  // namespace chimera
