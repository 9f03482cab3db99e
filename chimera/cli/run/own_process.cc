// SPDX-License-Identifier: Apache-2.0
// Forks a child for work that may crash or hang, waits with limits of time, and says how the child ended.
#include "chimera/cli/run/own_process.h"

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
#include "chimera/cli/run/under_way.h"
#include "chimera/platform/orphans.h"
#include "chimera/platform/process.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/not_off.h"

namespace chimera::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr long kLongestWaitNs = 100'000'000;
constexpr std::chrono::seconds kMakingLimit{kMakingLimitSeconds}, kEndingLimit{kEndingLimitSeconds};

/// True if a debugger is attached: the code to step through then stays in this process.
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
  ~HeldSignals() { release(); }
  void release() { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  /// The next of them within 100 ms; 0: none came.
  int next(siginfo_t& about) const {
    const timespec limit{0, kLongestWaitNs};
    return std::max(0, ::sigtimedwait(&set_, &about, &limit));
  }

 private:
  sigset_t set_{}, before_{};
};

[[noreturn]] void live(const std::function<int()>& work, pid_t parent, UnderWay& place, HeldSignals& held) {
  if (!follow_parent(parent, SIGKILL)) ::_exit(1);  // the parent was killed before
  held.release();
  write_under_way_to(place);
  const int code = report_lost_output(work());
  place.has_returned = true;
  std::exit(code);
}

/// Something that must not go on for longer than the limit.
class Patience {
 public:
  explicit Patience(std::chrono::seconds limit) : limit_(limit) {}
  /// True when `word` has been the same, and not 0, for the limit.
  bool is_over(std::uint64_t word) {
    if (word == 0 || word != word_) word_ = word, since_ = Clock::now();
    return word != 0 && Clock::now() - since_ > limit_;
  }

 private:
  const std::chrono::seconds limit_;
  std::uint64_t word_ = 0;
  Clock::time_point since_ = Clock::now();
};

/// Time limits of the work in a child. exceeded() names the one that is over; "": none is.
class Limits {
 public:
  std::string exceeded(const UnderWay& place, bool is_asked) {
    if (making_.is_over(place.making))
      return "the run did not end within " + std::to_string(kMakingLimitSeconds) + " s " + place.text();
    if (exit_.is_over(place.has_returned ? 1 : 0))
      return "the run did not end within " + std::to_string(kMakingLimitSeconds) +
             " s of its last method: an exit handler or destructor of a component does not return";
    if (!method_.is_over(is_asked || place.is_ending ? place.words() : 0)) return "";
    const UnderWay::Method method = place.method();
    const std::string within = " within " + std::to_string(kEndingLimitSeconds) + " s";
    if (method.task.empty()) return "the run did not end" + within + " of being asked to";
    return method.task + "." + method.name + " did not return" + within;
  }

 private:
  Patience making_{kMakingLimit}, method_{kEndingLimit}, exit_{kMakingLimit};
};

/// Waits for the child; why it was killed, "" when it was not.
std::string watch(pid_t child, const UnderWay& place, const HeldSignals& held, int& status) {
  Limits limits;
  std::string why;
  bool is_asked = false;
  while (true) {
    siginfo_t about{};
    const int number = held.next(about);
    const pid_t ended = ::waitpid(child, &status, WNOHANG);  // still ours
    if (ended == child || (ended < 0 && errno != EINTR)) return why;
    if (number == SIGINT || number == SIGTERM) {
      const bool has_reached_it = about.si_code > 0;    // that of a terminal
      if (!has_reached_it) ::kill(child, number);       // still ours: not reaped
      is_asked = true;
    }
    if (!why.empty()) continue;
    why = limits.exceeded(place, is_asked);
    if (!why.empty()) ::kill(child, SIGKILL);  // still ours: not reaped
  }
}

}  // namespace

std::string end_text(int status) {
  if (!WIFSIGNALED(status)) return "ended with status " + std::to_string(WEXITSTATUS(status));
  const char* name = ::sigabbrev_np(WTERMSIG(status));
  const std::string number = "ended by signal " + std::to_string(WTERMSIG(status));
  return name == nullptr ? number : number + " (SIG" + name + ")";
}

int in_own_process(const std::function<int()>& work, const std::function<int(const BrokenRun&)>& died) {
  UnderWay* place = is_debugged() ? nullptr : make_shared_under_way();
  if (place == nullptr) return work();
  std::fflush(nullptr);  // or both would write it
  HeldSignals held;
  Orphans orphans;  // this process adopts what components start in the child
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) live(work, parent, *place, held);
  if (child < 0) {
    held.release();
    release(place);
    return work();
  }
  int status = 0;
  std::string why = watch(child, *place, held, status);
  orphans.end_all(seconds(1));
  const bool is_clean = WIFEXITED(status) && place->has_returned;
  const std::string what = place->text();
  const UnderWay::Method method = place->making == 0 ? place->method() : UnderWay::Method{};
  release(place);
  if (is_clean) return WEXITSTATUS(status);
  if (why.empty()) why = "the run " + end_text(status) + (what.empty() ? "" : " " + what);
  return died({method.task, method.turns_off ? not_off_text(why) : why});
}

}  // namespace chimera::cli
