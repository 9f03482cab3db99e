// SPDX-License-Identifier: Apache-2.0
// Does to its process what no component should, in its cycles, while a file exists.
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "chimera/task/component.h"

using namespace chimera;

struct Misdeed {
  InConst<Text<16>> how{"how", initial = "nothing",
                        doc =
                            "child daemon chain exec stays: a child that outlives the cycle; leak; ordinary top strays "
                            "unlocked traced: the rights of its thread; close; timer: closes those in init; spin; "
                            "strict: the next system call of the thread ends the thread"};
  InConst<std::int64_t> number{"number", "1", initial = -1, doc = "the one descriptor to close; -1: all above 2"};
  InConst<std::int64_t> for_ns{"for_ns", "ns", initial = 20'000'000, doc = "how long each spin takes"};
  Resource armed{"armed", shared, doc = "the file whose existence lets it happen"};
  Out<double> y{"y", "1", initial = 0.0};

  void init() {
    if (is("timer") && ::access(armed.c_str(), F_OK) == 0) close_timers();
  }
  void cycle(Cycle c) {
    *y = static_cast<double>(c.count());
    if (is("nothing") || ::access(armed.c_str(), F_OK) != 0) return;
    if (is("leak")) leak();
    if (is("spin")) spin(*for_ns);
    if (is_done_) return;
    is_done_ = true;
    act();
  }

 private:
  static constexpr std::size_t kLeak = 64 * 1024;

  bool is(const char* way) const { return *how == way; }

  void act() {
    if (is("child") && ::fork() == 0) spin_for_ever();
    if (is("daemon") && detached()) spin_for_ever();
    if (is("chain") && detached()) fork_on();
    if (is("exec") && ::fork() == 0) {
      ::execlp("sleep", "sleep", "1000", static_cast<char*>(nullptr));
      ::_exit(1);
    }
    if (is("stays")) (void)!::fork();  // the child goes on as if it were the task
    if (is("ordinary")) set_policy(SCHED_OTHER, 0);
    if (is("top")) set_policy(SCHED_FIFO, 99);
    if (is("strays")) stray();
    if (is("unlocked")) ::munlockall();
    if (is("strict")) end_thread_at_next_call();
    if (is("traced")) ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    if (is("close") && *number < 0) ::close_range(3, ~0u, 0);
    if (is("close") && *number >= 0) ::close(static_cast<int>(*number));
  }

  static void close_timers() {
    for (int fd = 3; fd < 256; ++fd) {
      char link[64], what[64] = {};
      std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
      if (::readlink(link, what, sizeof what - 1) > 0 && std::strstr(what, "timerfd") != nullptr) ::close(fd);
    }
  }
  static void end_thread_at_next_call() {
    sock_filter kill{BPF_RET | BPF_K, 0, 0, SECCOMP_RET_KILL_THREAD};
    const sock_fprog program{1, &kill};
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
  }
  // In a process whose parent has ended, in a session of its own.
  static bool detached() {
    const pid_t middle = ::fork();
    if (middle != 0) return false;
    ::setsid();
    if (::fork() != 0) ::_exit(0);
    return true;
  }
  // Asleep at a real-time priority: it would keep the machine that it is tested on from telling so.
  [[noreturn]] static void spin_for_ever() {
    while (::sched_getscheduler(0) != SCHED_OTHER) ::pause();
    for (;;) (void)::getppid();
  }
  // Every process of the chain lives for a moment only.
  [[noreturn]] static void fork_on() {
    const timespec moment{0, 2'000'000};
    for (;; ::nanosleep(&moment, nullptr))
      if (::fork() > 0) ::_exit(0);
  }
  void leak() {
    if (void* more = std::malloc(kLeak); more != nullptr) std::memset(more, 1, kLeak);
  }
  static void set_policy(int policy, int priority) {
    sched_param p{};
    p.sched_priority = priority;
    ::sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &p);
  }
  static void stray() {
    cpu_set_t all;
    CPU_ZERO(&all);
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) CPU_SET(cpu, &all);
    ::sched_setaffinity(0, sizeof all, &all);
  }
  static std::int64_t now() {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
  }
  static void spin(std::int64_t ns) {
    for (const std::int64_t end = now() + ns; now() < end;) {
    }
  }

  bool is_done_ = false;
};
CHIMERA_COMPONENT(Misdeed, "t_misdeed", "Misuses its process on demand.", rate = 1000.0);
