// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/own_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string_view>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/desk/under_way.h"
#include "chimera/platform/process.h"

namespace chimera::desk {
namespace {

using Clock = std::chrono::steady_clock;

constexpr long kLookEvery = 100'000'000;  // ns
constexpr auto kLimit = std::chrono::seconds(kMakingLimitSeconds);

/// Somebody steps through this process: the code that he wants to see stays in it.
bool is_debugged() {
  const auto status = read_ordinary("/proc/self/status", 4096);
  const std::size_t at = status ? status->find("TracerPid:\t") : std::string::npos;
  return at != std::string::npos && (*status)[at + 11] != '0';
}

/// SIGINT, SIGTERM and SIGCHLD wait until they are asked for.
class HeldSignals {
 public:
  HeldSignals() {
    ::sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM, SIGCHLD}) ::sigaddset(&set_, number);
    ::sigprocmask(SIG_BLOCK, &set_, &before_);
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals() { let_go(); }
  void let_go() { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  /// The next of them within 100 ms; 0: none came.
  int next(siginfo_t& about) const {
    const timespec limit{0, kLookEvery};
    return std::max(0, ::sigtimedwait(&set_, &about, &limit));
  }

 private:
  sigset_t set_{}, before_{};
};

[[noreturn]] void live(const std::function<int()>& work, pid_t parent, UnderWay& place, HeldSignals& held) {
  (void)follow_parent(parent, SIGKILL);
  held.let_go();
  write_under_way_to(place);
  const int code = work();
  place.has_returned = true;
  std::exit(code);
}

/// Something that must not go on for longer than the limit.
class Patience {
 public:
  /// True when `word` has been the same, and not 0, for the limit.
  bool is_over(std::uint32_t word) {
    if (word == 0 || word != word_) word_ = word, since_ = Clock::now();
    return word != 0 && Clock::now() - since_ > kLimit;
  }

 private:
  std::uint32_t word_ = 0;
  Clock::time_point since_ = Clock::now();
};

/// Waits for the child; why it was killed, "" when it was not.
std::string watch(pid_t child, const UnderWay& place, const HeldSignals& held, int& status) {
  Patience making;
  std::string why;
  Clock::time_point asked = Clock::time_point::max();
  std::uint32_t then = 0;
  while (true) {
    siginfo_t about{};
    const int number = held.next(about);
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) return why;
    if (number == SIGINT || number == SIGTERM) {
      if (about.si_code <= 0) ::kill(child, number);  // that of a terminal has reached it already; ours: not reaped
      if (asked == Clock::time_point::max()) asked = Clock::now(), then = place.running;
    }
    if (!why.empty()) continue;
    if (making.is_over(place.making)) why = "did not end within " + std::to_string(kMakingLimitSeconds) + " s";
    else if (asked != Clock::time_point::max() && Clock::now() - asked > kLimit && place.running == then)
      why = "did not end within " + std::to_string(kMakingLimitSeconds) + " s of being asked to";
    if (!why.empty()) ::kill(child, SIGKILL);  // ours: not reaped
  }
}

}  // namespace

std::string end_text(int status) {
  if (!WIFSIGNALED(status)) return "ended by itself with exit code " + std::to_string(WEXITSTATUS(status));
  const char* name = ::sigabbrev_np(WTERMSIG(status));
  const std::string number = "ended by signal " + std::to_string(WTERMSIG(status));
  return name == nullptr ? number : number + " (SIG" + name + ")";
}

int in_own_process(const std::function<int()>& work, const std::function<int(const std::string&)>& died) {
  UnderWay* place = is_debugged() ? nullptr : make_shared_under_way();
  if (place == nullptr) return work();
  std::fflush(nullptr);  // or both would write it
  HeldSignals held;
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) live(work, parent, *place, held);
  if (child < 0) {
    held.let_go();
    release(place);
    return work();
  }
  int status = 0;
  std::string why = watch(child, *place, held, status);
  const bool is_clean = WIFEXITED(status) && place->has_returned;
  if (why.empty()) why = end_text(status);
  const std::string what = place->text();
  release(place);
  return is_clean ? WEXITSTATUS(status) : died(what.empty() ? why : why + " " + what);
}

}  // namespace chimera::desk
