// SPDX-License-Identifier: Apache-2.0
// Asks the kernel for numbers of processes, and reads states, descriptors and threads from /proc.
#include "chimera/platform/process_state.h"

#include <dirent.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "chimera/platform/file.h"

namespace chimera {
namespace {

/// Calls `body` with the folder and each name in it that does not begin with a dot.
template <class Body>
void for_each_entry(const char* path, Body body) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::opendir(path), [](DIR* open) { return ::closedir(open); });
  while (const dirent* entry = folder ? ::readdir(folder.get()) : nullptr)
    if (entry->d_name[0] != '.') body(::dirfd(folder.get()), entry->d_name);
}

}  // namespace

pid_t own_process_id() noexcept { return ::getpid(); }
pid_t parent_process_id() noexcept { return ::getppid(); }
pid_t own_session() noexcept { return ::getsid(0); }
uid_t own_user() noexcept { return ::getuid(); }

std::string user_name(std::uint32_t user) {
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen("/etc/passwd", "re"));
  char text[1024];
  passwd entry{};
  for (passwd* found = nullptr; file && ::fgetpwent_r(file.get(), &entry, text, sizeof text, &found) == 0;)
    if (entry.pw_uid == user) return entry.pw_name;
  return std::to_string(user);
}

std::uint64_t page_bytes() noexcept { return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)); }

ProcessState process_state(pid_t pid) noexcept {
  ProcessState state;
  char path[64];
  std::snprintf(path, sizeof path, "/proc/%d/task/%d/stat", pid, pid);
  const FileStart stat(path);
  const char* at = std::strrchr(stat.bytes, ')');  // the name before it may hold any character
  unsigned long user = 0, system = 0;
  constexpr const char* kFields = ") %c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu";
  if (at == nullptr || std::sscanf(at, kFields, &state.letter, &user, &system) != 3) return {};
  state.used = Nanoseconds{static_cast<std::int64_t>(user + system) * (1'000'000'000 / ::sysconf(_SC_CLK_TCK))};
  std::snprintf(path, sizeof path, "/proc/%d/status", pid);
  const FileStart status(path);
  const char* tracer = std::strstr(status.bytes, "\nTracerPid:");
  if (tracer != nullptr)
    state.tracer = static_cast<pid_t>(std::strtol(tracer + std::strlen("\nTracerPid:"), nullptr, 10));
  return state;
}

Descriptors open_descriptors() {
  Descriptors found;
  for_each_entry("/proc/self/fd", [&](int folder, const char* name) {
    if (std::to_string(folder) == name) return;
    char target[150];
    const ssize_t got = ::readlinkat(folder, name, target, sizeof target);
    found.names.push_back(std::string(name) + " -> " +
                          std::string(target, static_cast<std::size_t>(std::max<ssize_t>(got, 0))));
  });
  return found;
}

std::vector<pid_t> numbers_in(const std::string& folder) {
  std::vector<pid_t> found;
  for_each_entry(folder.c_str(), [&](int, const char* name) {
    char* end = nullptr;
    const long number = std::strtol(name, &end, 10);
    if (*end == '\0' && number > 0) found.push_back(static_cast<pid_t>(number));
  });
  return found;
}

std::uint32_t threads() { return static_cast<std::uint32_t>(numbers_in("/proc/self/task").size()); }

void name_first_new(const Descriptors& before, const Descriptors& after, std::span<char> text) {
  for (const std::string& name : after.names) {
    if (std::ranges::find(before.names, name) != before.names.end()) continue;
    std::snprintf(text.data(), text.size(), "%s", name.c_str());
    return;
  }
}

}  // namespace chimera
