// SPDX-License-Identifier: Apache-2.0
// Reads the state, processor time and tracer of a process from /proc.
#include "chimera/platform/process_state.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "chimera/platform/owned_descriptor.h"

namespace chimera {
namespace {

// Zero-terminated; empty when it cannot be read.
template <std::size_t n>
void read_text(const char* path, char (&text)[n]) noexcept {
  text[0] = '\0';
  const OwnedDescriptor file(::open(path, O_RDONLY | O_CLOEXEC));
  const ssize_t got = file.fd < 0 ? 0 : ::read(file.fd, text, n - 1);
  text[got < 0 ? 0 : got] = '\0';
}

}  // namespace

ProcessState process_state(pid_t pid) noexcept {
  ProcessState state;
  char path[64], text[4096];
  std::snprintf(path, sizeof path, "/proc/%d/task/%d/stat", pid, pid);
  read_text(path, text);
  const char* at = std::strrchr(text, ')');  // the name before it may hold anything
  unsigned long user = 0, system = 0;
  constexpr const char* kFields = ") %c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu";
  if (at == nullptr || std::sscanf(at, kFields, &state.letter, &user, &system) != 3) return {};
  state.used = Nanoseconds{static_cast<std::int64_t>(user + system) * (1'000'000'000 / ::sysconf(_SC_CLK_TCK))};
  std::snprintf(path, sizeof path, "/proc/%d/status", pid);
  read_text(path, text);
  const char* tracer = std::strstr(text, "\nTracerPid:");
  if (tracer != nullptr)
    state.tracer = static_cast<pid_t>(std::strtol(tracer + std::strlen("\nTracerPid:"), nullptr, 10));
  return state;
}

}  // namespace chimera
