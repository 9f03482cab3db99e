// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/print/outlet.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string>
#include <thread>
#include <utility>

#include "chimera/platform/standard_streams.h"

namespace chimera::cli {
namespace {

struct Pipe {
  Pipe() { EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0); }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  std::string read(std::size_t n) {
    std::string text(n, '\0');
    std::size_t got = 0;
    for (ssize_t some; got < n && (some = ::read(ends[0], text.data() + got, n - got)) > 0;)
      got += static_cast<std::size_t>(some);
    return text.substr(0, got);
  }
  int ends[2] = {-1, -1};
};

TEST(Outlet, OutputArrivesInOrder) {
  Pipe pipe;
  Outlet outlet(pipe.ends[1]);
  for (int i = 0; i < 3; ++i) std::fprintf(outlet.stream(), "line %d\n", i);
  outlet.finish(seconds(60));
  EXPECT_EQ(outlet.why_lost(), 0);
  EXPECT_EQ(pipe.read(21), "line 0\nline 1\nline 2\n");
}

TEST(Outlet, AWriterNeverWaitsForAReaderAndTheLossIsKnown) {
  Pipe pipe;
  const std::string line(999, 'x');
  Outlet outlet(pipe.ends[1]);
  for (std::size_t n = 0; n < 2 * kOutletBytes; n += 1000) std::fprintf(outlet.stream(), "%s\n", line.c_str());
  std::fflush(outlet.stream());
  EXPECT_EQ(outlet.why_lost(), kNobodyReads);
  std::thread reader([&pipe] { pipe.read(4 << 20); });
  outlet.finish(seconds(60));
  ::close(std::exchange(pipe.ends[1], -1));
  reader.join();
}

TEST(Outlet, AShortPatienceAtTheEndIsALoss) {
  Pipe pipe;
  const std::string much(200 << 10, 'x');  // more than a pipe takes
  Outlet outlet(pipe.ends[1]);
  std::fputs(much.c_str(), outlet.stream());
  outlet.finish(milliseconds(20));
  EXPECT_EQ(outlet.why_lost(), kNobodyReads);
  EXPECT_EQ(pipe.read(much.size()).size(), much.size()) << "the text arrives when a reader comes later";
  outlet.finish(seconds(60));
}

TEST(Outlet, AFullDeviceAndABrokenPipeAreReasons) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  Outlet outlet(full);
  std::fputs("text\n", outlet.stream());
  outlet.finish(seconds(60));
  EXPECT_EQ(outlet.why_lost(), ENOSPC);
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  ::close(std::exchange(pipe.ends[0], -1));
  Outlet broken(pipe.ends[1]);
  std::fputs("text\n", broken.stream());
  broken.finish(seconds(60));
  EXPECT_EQ(broken.why_lost(), EPIPE);
  std::signal(SIGPIPE, before);
  ::close(full);
}

}  // namespace
}  // namespace chimera::cli
