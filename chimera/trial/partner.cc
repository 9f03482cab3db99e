// SPDX-License-Identifier: Apache-2.0
#include "chimera/trial/partner.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "chimera/base/message.h"

namespace chimera::trial {
namespace {

constexpr std::int64_t kEnd = 2'000'000'000;  // ns between SIGTERM and SIGKILL

// The first line of what comes through `from`, without its end; empty when none came in time.
std::string first_line(int from, Nanoseconds patience) {
  std::string text;
  pollfd wait{from, POLLIN, 0};
  for (auto left = static_cast<int>(patience.count / 1'000'000); left > 0; left -= 20) {
    char byte = 0;
    if (::poll(&wait, 1, 20) <= 0) continue;
    while (::read(from, &byte, 1) == 1) {
      if (byte == '\n') return text;
      if (text.size() < 200) text += byte;
    }
    if ((wait.revents & POLLHUP) != 0) return {};
  }
  return {};
}

}  // namespace

// The program's first line comes through a pipe that a shell makes its standard output.
Result<Partner> Partner::start(const std::string& program, Nanoseconds patience) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return (Message() << std::strerror(errno)).error(ErrorCode::kSystem, program);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  // In its folder lie components, and one in Python must not take select.so for its module.
  constexpr const char* kScript =
      "cd \"$(dirname \"$1\")\" && PYTHONSAFEPATH=1 && export PYTHONSAFEPATH && exec \"$1\" >&3 3>&- </dev/null";
  const char* words[] = {"sh", "-c", kScript, "sh", program.c_str()};
  const int handed[] = {ends[1]};
  auto process = Process::start("/bin/sh", words, handed);
  ::close(ends[1]);
  if (!process) {
    ::close(ends[0]);
    return process.error();
  }
  Partner partner(*std::move(process));
  partner.line_ = first_line(ends[0], patience);
  ::close(ends[0]);
  if (partner.line_.empty()) return (Message() << "says no first line").error(ErrorCode::kBadInput, program);
  return partner;
}

Partner::~Partner() {
  if (!process_.is_held()) return;
  ProcessEnd end;
  (void)process_.signal(SIGTERM);
  if (process_.wait(end, kEnd)) return;
  (void)process_.signal(SIGKILL);
  (void)process_.wait(end, kEnd);
}

}  // namespace chimera::trial
