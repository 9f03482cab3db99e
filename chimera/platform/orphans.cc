// SPDX-License-Identifier: Apache-2.0
// Reads origin, name and children of processes from /proc; reaps adopted processes and ends those of a dead rtpu.
#include "chimera/platform/orphans.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdio>

#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/process_state.h"

namespace chimera {
namespace {

constexpr std::string_view kMemoryHolder = "memory-holder";
constexpr Nanoseconds kMemoryHolderLimit = milliseconds(100);  // ten times the wait of a memory holder
// During exec the origin of a process cannot be read for a moment.
constexpr Nanoseconds kDoubtful = seconds(1), kLookAgain = milliseconds(50);
constexpr int kCleanRounds = 3;
constexpr Nanoseconds kMoment = microseconds(200);  // a process that got SIGKILL ends within this time, mostly

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

// The pidfd names one process. The number may get another owner between the check of the origin and the signal.
bool end_if_from(std::string_view origin, pid_t pid) {
  const OwnedDescriptor held(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
  if (held.fd < 0 || origin_of(pid) != origin) return false;
  return ::syscall(SYS_pidfd_send_signal, held.fd, SIGKILL, nullptr, 0) == 0;
}

bool is_among(std::span<const pid_t> pids, pid_t pid) { return std::find(pids.begin(), pids.end(), pid) != pids.end(); }

// With __WCLONE the kernel names traced threads and processes only: all other children report their end by SIGCHLD.
void end_tracing(std::span<const pid_t> held) {
  constexpr int kTraced = WEXITED | WSTOPPED | WNOHANG | WNOWAIT | __WCLONE;
  for (siginfo_t found{}; ::waitid(P_ALL, 0, &found, kTraced) == 0 && found.si_pid != 0; found = {}) {
    const auto signal = reinterpret_cast<void*>(static_cast<std::intptr_t>(found.si_status));  // NOLINT: a number
    const bool has_ended = found.si_code != CLD_TRAPPED && found.si_code != CLD_STOPPED;
    if (has_ended && is_among(held, found.si_pid)) return;  // its Process reaps it
    if (has_ended ? ::waitpid(found.si_pid, nullptr, WNOHANG | __WALL) <= 0  // not reaped yet: keeps its number
                  : ::ptrace(PTRACE_DETACH, found.si_pid, nullptr, signal) != 0)
      return;
  }
}

/// Dead or alive. The list of living children may lack a process that is just becoming a child.
bool has_children() {
  siginfo_t unused{};
  return ::waitid(P_ALL, 0, &unused, WEXITED | WNOHANG | WNOWAIT) == 0;
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
  int clean = 0;  // rounds in a row that found no process; several, because of exec
  for (const Nanoseconds until = clock.now() + limit;;) {
    bool found = false;
    for (const pid_t pid : numbers_in("/proc"))
      if (pid != ::getpid()) found = end_if_from(origin, pid) || found;
    clean = found ? 0 : clean + 1;
    if (clean == kCleanRounds) return true;
    if (clock.now() > until) return false;
    clock.wait_until(clock.now() + milliseconds(found ? 1 : 20));
  }
}

Orphans::Orphans() : strangers_(children_of_this_process()) {
  LinuxClock clock;
  prefix_ = std::to_string(::getpid()) + "." + std::to_string(clock.now().count) + ".";
  (void)::prctl(PR_SET_CHILD_SUBREAPER, 1);
}

Nanoseconds Orphans::first_seen(pid_t pid, Nanoseconds now) {
  const auto known = std::find_if(seen_.begin(), seen_.end(), [pid](const Seen& seen) { return seen.pid == pid; });
  return known != seen_.end() ? known->at : seen_.emplace_back(Seen{pid, now}).at;
}

/// Reaps ended children. Until then the number of a child belongs to no other process.
std::vector<pid_t> Orphans::living(std::span<const pid_t> held) {
  std::vector<pid_t> found;
  for (const pid_t pid : children_of_this_process()) {
    if (is_among(held, pid)) continue;
    const bool lives = ::waitpid(pid, nullptr, WNOHANG) == 0;  // still ours
    if (lives && !is_among(strangers_, pid)) found.push_back(pid);
  }
  std::erase_if(seen_, [&](const Seen& seen) { return !is_among(found, seen.pid); });
  return found;
}

/// A memory holder ends by itself, unless a signal has stopped it.
bool Orphans::has_time(pid_t pid, Nanoseconds now) {
  const Nanoseconds due = first_seen(pid, now) + kMemoryHolderLimit;
  if (now >= due || name_of(pid) != kMemoryHolder) return false;
  due_ = std::min(due_, due);
  return true;
}

/// True for a descendant of an rtpu of this keeper. `is_doubtful` becomes true if the origin cannot be read yet.
bool Orphans::is_ours(pid_t pid, Nanoseconds now, bool& is_doubtful) {
  const std::string origin = origin_of(pid);
  is_doubtful = is_doubtful || (origin.empty() && now - first_seen(pid, now) < kDoubtful);
  return origin.starts_with(prefix_);
}

void Orphans::look(std::span<const pid_t> held, const std::function<bool(std::string_view)>& lives, Nanoseconds now) {
  due_ = kNever;
  end_tracing(held);
  for (const pid_t pid : living(held)) {
    const std::string origin = origin_of(pid);
    const bool is_known = origin.starts_with(prefix_);
    if (!is_known && now - first_seen(pid, now) < kDoubtful) due_ = std::min(due_, now + kLookAgain);
    if (is_known && !lives(origin) && !has_time(pid, now)) ::kill(pid, SIGKILL);  // still ours
  }
}

void Orphans::end_all(Nanoseconds limit) {
  LinuxClock clock;
  const Nanoseconds until = clock.now() + limit;
  std::vector<pid_t> left;
  do {
    left = living({});
    const Nanoseconds now = clock.now();
    bool is_doubtful = false;
    if (!strangers_.empty()) std::erase_if(left, [&](pid_t pid) { return !is_ours(pid, now, is_doubtful); });
    for (const pid_t pid : left)
      if (!has_time(pid, now)) ::kill(pid, SIGKILL);  // still ours
    if (left.empty() && !is_doubtful && (!strangers_.empty() || !has_children())) return;
    clock.wait_until(now + kMoment);
  } while (clock.now() < until);
  // A memory holder that has not ended is no fault: it runs last on a busy machine.
  std::erase_if(left, [](pid_t pid) { return name_of(pid) == kMemoryHolder; });
  for (const pid_t pid : left)
    std::fprintf(stderr, "process %d (%s), started by a component, could not be ended\n", pid, name_of(pid).c_str());
}

}  // namespace chimera
