// SPDX-License-Identifier: Apache-2.0
// Children that share memory with this process.
#include "chimera/platform/forked_child.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "chimera/platform/family_memory.h"

namespace chimera {
namespace {

int status_of(const Result<pid_t>& child) {
  int status = -1;
  EXPECT_TRUE(child);
  if (child) ::waitpid(*child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ForkedChild, EndsWithWhatItsWorkReturns) { EXPECT_EQ(status_of(fork_quietly("", [] { return 7; })), 7); }

TEST(ForkedChild, WhatItWroteIntoFamilyMemoryStaysWhenItIsKilled) {
  const auto memory = FamilyMemory::create(10'000);
  ASSERT_TRUE(memory);
  char* text = reinterpret_cast<char*>(memory->bytes().data());
  EXPECT_EQ(memory->bytes().size(), 10'000u);
  EXPECT_EQ(text[9'999], 0);
  EXPECT_EQ(status_of(fork_quietly("/", [text] {
    std::strcpy(text, std::filesystem::current_path().c_str());
    ::kill(::getpid(), SIGKILL);  // still ours
    return 0;
  })), -1);
  EXPECT_STREQ(text, "/");
}

TEST(ForkedChild, PrintsNothing) {
  EXPECT_EQ(status_of(fork_quietly("", [] {
    char name[100] = {};
    const bool is_known = ::readlink("/proc/self/fd/1", name, sizeof name - 1) > 0;
    return is_known && std::strcmp(name, "/dev/null") == 0 ? 0 : 1;
  })), 0);
}

TEST(ForkedChild, EndsWhereItsFolderIsMissing) {
  EXPECT_EQ(status_of(fork_quietly("/no/such/folder", [] { return 0; })), 1);
}

TEST(FamilyMemory, RefusesNothing) { EXPECT_EQ(FamilyMemory::create(0).error().message.view(), "Invalid argument"); }

}  // namespace
}  // namespace chimera
