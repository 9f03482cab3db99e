// SPDX-License-Identifier: Apache-2.0
// Starts the program at the other end of a device, with a shell that connects a pipe for its first line.
#include "chimera/component_test/partner.h"

#include <csignal>

#include "chimera/base/message.h"
#include "chimera/platform/descriptor.h"

namespace chimera::component_test {
namespace {

constexpr std::int64_t kEnd = 2'000'000'000;  // ns between SIGTERM and SIGKILL

}  // namespace

// A shell makes a pipe the standard output of the program; its first line arrives there.
Result<Partner> Partner::start(const std::string& program, Nanoseconds patience) {
  auto pipe = Pipe::open();
  if (!pipe) return Message(pipe.error().message.view()).error(ErrorCode::kSystem, program);
  // The folder of the program contains components. Without this, a Python program could import select.so as a module.
  constexpr const char* kScript =
      "cd \"$(dirname \"$1\")\" && PYTHONSAFEPATH=1 && export PYTHONSAFEPATH && exec \"$1\" >&3 3>&- </dev/null";
  const char* words[] = {"sh", "-c", kScript, "sh", program.c_str()};
  const int handed[] = {pipe->writing.fd};
  auto process = Process::start("/bin/sh", words, handed);
  pipe->writing = OwnedDescriptor();
  if (!process) return process.error();
  Partner partner(*std::move(process));
  partner.line_ = pipe->first_line(patience);
  if (partner.line_.empty()) return (Message() << "printed no first line").error(ErrorCode::kBadInput, program);
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

}  // namespace chimera::component_test
