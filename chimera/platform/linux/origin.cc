// SPDX-License-Identifier: Apache-2.0
// Reads the environment, name and children of processes from /proc, and ends all processes of one origin.
#include "chimera/platform/origin.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdlib>
#include <memory>

#include "chimera/platform/linux_clock.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {
namespace {

std::string content(const std::string& path) {
  const OwnedDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::string all;
  char part[4096];
  for (ssize_t n; file.fd >= 0 && (n = ::read(file.fd, part, sizeof part)) > 0;)
    all.append(part, static_cast<std::size_t>(n));
  return all;
}

pid_t number(std::string_view text) {
  pid_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

/// The numbers among the names in a folder of the kernel.
std::vector<pid_t> numbers_in(const char* path) {
  std::vector<pid_t> found;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::opendir(path), [](DIR* open) { return ::closedir(open); });
  while (const dirent* entry = folder ? ::readdir(folder.get()) : nullptr)
    if (const pid_t pid = number(entry->d_name); pid > 0) found.push_back(pid);
  return found;
}

// The descriptor is held while the question is asked: the number may be another's, the descriptor is not.
bool end_if_from(std::string_view origin, pid_t pid) {
  const OwnedDescriptor held(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
  if (held.fd < 0 || origin_of(pid) != origin) return false;
  return ::syscall(SYS_pidfd_send_signal, held.fd, SIGKILL, nullptr, 0) == 0;
}

}  // namespace

std::string origin_of(pid_t pid) {
  const std::string all = '\0' + content("/proc/" + std::to_string(pid) + "/environ");
  const std::string begin = '\0' + std::string(kOriginVariable) + "=";
  const std::size_t at = all.find(begin);
  if (at == all.npos) return "";
  const std::size_t from = at + begin.size();
  return all.substr(from, all.find('\0', from) - from);
}

std::string name_of(pid_t pid) {
  std::string name = content("/proc/" + std::to_string(pid) + "/comm");
  while (!name.empty() && name.back() == '\n') name.pop_back();
  return name;
}

std::vector<pid_t> children_of_this_process() {
  std::vector<pid_t> children;
  for (const pid_t thread : numbers_in("/proc/self/task")) {
    const std::string all = content("/proc/self/task/" + std::to_string(thread) + "/children");
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t end = std::min(all.find(' ', at), all.size());
      if (const pid_t pid = number(std::string_view(all).substr(at, end - at)); pid > 0) children.push_back(pid);
      at = end + 1;
    }
  }
  return children;
}

bool end_all_from(std::string_view origin, Nanoseconds limit) {
  if (origin.empty()) return true;
  LinuxClock clock;
  // The origin of one that is just becoming another program cannot be read for a moment: nobody must be found thrice.
  int clean = 0;
  for (const Nanoseconds until = clock.now() + limit;;) {
    bool found = false;
    for (const pid_t pid : numbers_in("/proc"))
      if (pid != ::getpid()) found = end_if_from(origin, pid) || found;
    clean = found ? 0 : clean + 1;
    if (clean == 3) return true;
    if (clock.now() > until) return false;
    clock.wait_until(clock.now() + milliseconds(found ? 1 : 20));
  }
}

}  // namespace chimera
