// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/standard_streams.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "chimera/platform/descriptor.h"

namespace chimera::standard_streams_process_test {
namespace {

/// The exit code of `body` in a process of its own.
template <class Body>
int in_a_process(const Body& body) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
}

void put(const char* path, int number) {
  const int made = ::open(path, O_WRONLY);
  ::dup2(made, number);
  ::close(made);
}

TEST(StandardOutput, KeepsTheNumberOfAClosedDescriptor) {
  EXPECT_EQ(in_a_process([] {
              for (const int number : {0, 1, 2}) ::close(number);
              hold_standard_streams();
              const int next = ::open("/dev/null", O_RDONLY);
              const bool fails = ::write(1, "x", 1) < 0 && errno == EBADF && ::write(2, "x", 1) < 0;
              return next > 2 && fails ? 7 : 8;
            }),
            7);
}

TEST(StandardOutput, LossGivesExitCode1AndIsRemembered) {
  EXPECT_EQ(in_a_process([] {
              put("/dev/full", 1);
              std::fputs("lost", stdout);
              if (flush_and_look(stdout) != ENOSPC) return 8;
              put("/dev/null", 1);
              std::fputs("not lost", stdout);
              loss_is_told();
              return flush_and_look(stdout) == ENOSPC ? report_lost_output(0) : 9;
            }),
            1);
  EXPECT_EQ(in_a_process([] {
              put("/dev/full", 2);
              std::fputs("lost", stderr);
              return report_lost_output(0);
            }),
            1);
}

TEST(StandardOutput, KeepsTheExitCodeWithoutALoss) {
  EXPECT_EQ(in_a_process([] {
              put("/dev/null", 1);
              put("/dev/full", 2);  // no message goes there
              std::fputs("text", stdout);
              return report_lost_output(0);
            }),
            0);
  EXPECT_EQ(in_a_process([] { return report_lost_output(2); }), 2);
}

TEST(StandardOutput, ReportsAFileThatMayNotGrowWithoutASignal) {
  EXPECT_EQ(in_a_process([] {
              hold_standard_streams();
              return std::raise(SIGXFSZ);
            }),
            0);
  EXPECT_STREQ(why_lost_text(EFBIG), "File too large");
  EXPECT_STREQ(why_lost_text(kNobodyReads), "no process reads it");
}

TEST(Terminal, PipeIsNoTerminalAndHasTheSizeFromTheEnvironment) {
  const auto pipe = Pipe::open();
  ASSERT_TRUE(pipe);
  EXPECT_FALSE(is_terminal(pipe->reading.fd));
  ::setenv("COLUMNS", "132", 1);
  ::setenv("LINES", "5000", 1);
  EXPECT_EQ(screen_size(pipe->reading.fd).width, 132u);
  EXPECT_EQ(screen_size(pipe->reading.fd).height, 24u);
  ::unsetenv("COLUMNS");
  ::unsetenv("LINES");
  EXPECT_EQ(screen_size(pipe->reading.fd).width, 80u);
}

}  // namespace
}  // namespace chimera::standard_streams_process_test
