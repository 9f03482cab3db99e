// SPDX-License-Identifier: Apache-2.0
// Reaps adopted processes, and ends those whose real-time unit has ended.
#include "chimera/platform/orphans.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "chimera/platform/linux_clock.h"
#include "chimera/platform/origin.h"
#include "chimera/platform/process.h"

namespace chimera {
namespace {

constexpr std::string_view kMemoryHolder = "memory-holder";
constexpr Nanoseconds kMemoryHolderLimit = milliseconds(100);  // ten times what they wait
// The origin of one that is just becoming another program cannot be read for a moment.
constexpr Nanoseconds kDoubtful = seconds(1), kLookAgain = milliseconds(50);
constexpr Nanoseconds kMoment = microseconds(200);  // for what was sent SIGKILL to end

bool is_among(std::span<const pid_t> pids, pid_t pid) { return std::find(pids.begin(), pids.end(), pid) != pids.end(); }

/// Dead or alive: a list of the living may leave out one that is just becoming a child of this process.
bool has_children() {
  siginfo_t nobody{};
  return ::waitid(P_ALL, 0, &nobody, WEXITED | WNOHANG | WNOWAIT) == 0;
}

}  // namespace

Orphans::Orphans() : strangers_(children_of_this_process()) {
  LinuxClock clock;
  prefix_ = std::to_string(::getpid()) + "." + std::to_string(clock.now().count) + ".";
  adopt_orphans();
}

Nanoseconds Orphans::first_seen(pid_t pid, Nanoseconds now) {
  const auto known = std::find_if(seen_.begin(), seen_.end(), [pid](const Seen& seen) { return seen.pid == pid; });
  return known != seen_.end() ? known->at : seen_.emplace_back(Seen{pid, now}).at;
}

/// Those that have ended are reaped here: until then a number is nobody else's.
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

/// A memory holder ends by itself, unless somebody stopped it.
bool Orphans::has_time(pid_t pid, Nanoseconds now) {
  const Nanoseconds due = first_seen(pid, now) + kMemoryHolderLimit;
  if (now >= due || name_of(pid) != kMemoryHolder) return false;
  due_ = std::min(due_, due);
  return true;
}

/// Began with a unit of this keeper. `is_doubtful` becomes true for one of which that cannot be told yet.
bool Orphans::is_ours(pid_t pid, Nanoseconds now, bool& is_doubtful) {
  const std::string origin = origin_of(pid);
  is_doubtful = is_doubtful || (origin.empty() && now - first_seen(pid, now) < kDoubtful);
  return origin.starts_with(prefix_);
}

void Orphans::look(std::span<const pid_t> held, const std::function<bool(std::string_view)>& lives, Nanoseconds now) {
  due_ = kNever;
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
  // Nothing is wrong with a memory holder that has not ended: it comes last on a busy machine.
  std::erase_if(left, [](pid_t pid) { return name_of(pid) == kMemoryHolder; });
  for (const pid_t pid : left)
    std::fprintf(stderr, "process %d (%s), started by a component, could not be ended\n", pid, name_of(pid).c_str());
}

}  // namespace chimera
