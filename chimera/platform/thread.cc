// SPDX-License-Identifier: Apache-2.0
// Changes and reads the scheduling of threads, starts ordinary threads, halts threads by a signal, and sees by a
// restartable sequence (rseq) that a thread lost its processor.
#include "chimera/platform/thread.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <locale.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/rseq.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>
#include <string_view>

#include "chimera/platform/descriptor.h"

namespace chimera {
namespace {

static_assert(kPolicyOther == SCHED_OTHER && kPolicyFifo == SCHED_FIFO && kPolicyRoundRobin == SCHED_RR);

// The clock of another thread of this process; pthread_getcpuclockid makes it from the number of the thread too.
clockid_t cpu_clock_of(pid_t thread) noexcept {
  constexpr unsigned kPerThread = 4, kSchedulerTime = 2;
  return static_cast<clockid_t>((~static_cast<unsigned>(thread) << 3) | kPerThread | kSchedulerTime);
}

Nanoseconds read_clock(clockid_t clock) noexcept {
  timespec t{};
  if (::clock_gettime(clock, &t) != 0) return kNever;
  return {static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec};
}

void* run_work(void* given) {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are for the threads that wait for them
  use_decimal_point();
  const std::unique_ptr<std::function<void()>> work(static_cast<std::function<void()>*>(given));
  (*work)();
  return nullptr;
}

void make_ordinary(pthread_attr_t& attributes) noexcept {
  const sched_param none{.sched_priority = 0};
  cpu_set_t any;
  std::memset(&any, 0xff, sizeof any);
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
  pthread_attr_setschedparam(&attributes, &none);
  pthread_attr_setaffinity_np(&attributes, sizeof any, &any);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
}

// Returns the size before. If the size cannot be set, it stays.
std::size_t exchange_stack_size(std::size_t bytes) noexcept {
  pthread_attr_t attributes;
  if (::pthread_getattr_default_np(&attributes) != 0) return 0;
  std::size_t before = 0;
  ::pthread_attr_getstacksize(&attributes, &before);
  ::pthread_attr_setstacksize(&attributes, bytes);
  ::pthread_setattr_default_np(&attributes);
  ::pthread_attr_destroy(&attributes);
  return before;
}

thread_local Halt* mine = nullptr;

int halt_signal() noexcept { return SIGRTMIN + 5; }

bool install_halt(void (*handler)(int)) noexcept {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  return ::sigaction(halt_signal(), &action, nullptr) == 0;
}

// The kernel would resume an interrupted sequence behind the signature. This sequence is empty: no thread goes there.
const std::uint32_t nowhere[2] = {RSEQ_SIG, 0};

std::uint64_t address(const void* p) noexcept { return reinterpret_cast<std::uintptr_t>(p); }

rseq_cs empty_sequence() noexcept {
  rseq_cs sequence{};
  sequence.start_ip = sequence.abort_ip = address(&nowhere[1]);
  return sequence;
}

const rseq_cs sequence = empty_sequence();

// The word of the calling thread that the kernel clears; the C library has registered the word.
volatile __u64& sequence_word() noexcept {
  char* const thread = static_cast<char*>(__builtin_thread_pointer());
  return reinterpret_cast<rseq*>(thread + __rseq_offset)->rseq_cs;
}

// A kernel may lack these sequences, or may check the word on return from an interrupt only.
bool sees_a_sleep() noexcept {
  if (__rseq_size == 0) return false;
  SwitchWatch::begin();
  const timespec shortly{0, 1'000};
  ::clock_nanosleep(CLOCK_MONOTONIC, 0, &shortly, nullptr);
  return !SwitchWatch::end();
}

}  // namespace

pid_t this_thread() noexcept { return static_cast<pid_t>(::syscall(SYS_gettid)); }

void use_decimal_point() noexcept {
  static const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr);
  if (plain != nullptr) ::uselocale(plain);
}

bool set_level(pid_t thread, int level) noexcept {
  sched_param p{};
  p.sched_priority = level;
  return ::sched_setscheduler(thread, SCHED_FIFO | SCHED_RESET_ON_FORK, &p) == 0;
}

bool set_below_all(pid_t thread) noexcept {
  const sched_param p{};
  return ::sched_setscheduler(thread, SCHED_OTHER | SCHED_RESET_ON_FORK, &p) == 0;
}

int level_of(pid_t thread) noexcept {
  sched_param p{};
  return ::sched_getparam(thread, &p) == 0 ? p.sched_priority : 0;
}

Nanoseconds used_by(pid_t thread) noexcept { return read_clock(cpu_clock_of(thread)); }

Nanoseconds used_by_this_thread() noexcept { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

bool is_asleep(pid_t thread) noexcept {
  char path[48], text[128];
  std::snprintf(path, sizeof path, "/proc/self/task/%d/stat", thread);
  const OwnedDescriptor file{::open(path, O_RDONLY | O_CLOEXEC)};
  if (file.fd < 0) return false;
  const ssize_t n = ::read(file.fd, text, sizeof text);
  const std::string_view all(text, n > 0 ? static_cast<std::size_t>(n) : 0);
  const std::size_t name_end = all.rfind(')');  // a name of at most 15 characters, which may be parentheses
  if (name_end == all.npos || name_end + 2 >= all.size()) return false;
  const char state = all[name_end + 2];
  return state == 'S' || state == 'D';
}

std::uint64_t sleeps_of_this_thread() noexcept {
  rusage usage{};
  (void)::getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_nvcsw);
}

bool look_up_rights(pid_t thread, ThreadRights& rights) noexcept {
  sched_param param{};
  cpu_set_t set;
  CPU_ZERO(&set);
  const int policy = ::sched_getscheduler(thread);
  if (policy < 0 || ::sched_getparam(thread, &param) != 0 || ::sched_getaffinity(thread, sizeof set, &set) != 0)
    return false;
  rights = {thread, policy & ~SCHED_RESET_ON_FORK, param.sched_priority, -1};
  for (int cpu = 0; CPU_COUNT(&set) == 1 && cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &set)) rights.only_cpu = cpu;
  return true;
}

bool start_ordinary_thread(std::function<void()> work) {
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return false;
  make_ordinary(attributes);
  auto given = std::make_unique<std::function<void()>>(std::move(work));
  pthread_t thread;
  const bool made = pthread_create(&thread, &attributes, &run_work, given.get()) == 0;
  if (made) (void)given.release();
  pthread_attr_destroy(&attributes);
  return made;
}

ThreadStack::ThreadStack(std::size_t bytes) noexcept : before_(bytes == 0 ? 0 : exchange_stack_size(bytes)) {}

ThreadStack::~ThreadStack() {
  if (before_ != 0) exchange_stack_size(before_);
}

Halt::Halt() noexcept {
  [[maybe_unused]] static const bool installed = install_halt([](int signal) { handle(signal); });
}

void Halt::attach() noexcept {
  mine = this;
  thread_ = this_thread();
}

void Halt::handle(int) noexcept {
  const int before = errno;
  if (mine != nullptr) mine->sleep();
  errno = before;
}

void Halt::sleep() noexcept {
  while (word_.load(std::memory_order_acquire) == (kOpen | kAsked))  // pairs with lift()
    ::syscall(SYS_futex, &word_, FUTEX_WAIT_PRIVATE, kOpen | kAsked, nullptr, nullptr, 0);
}

void Halt::open() noexcept {
  (void)word_.fetch_or(kOpen, std::memory_order_acq_rel);
  sleep();
}

void Halt::ask() noexcept {
  (void)word_.fetch_or(kAsked, std::memory_order_acq_rel);
  (void)::syscall(SYS_tgkill, ::getpid(), thread_, halt_signal());
}

void Halt::lift() noexcept {
  (void)word_.fetch_and(~kAsked, std::memory_order_acq_rel);  // pairs with sleep(), which reads the word again
  ::syscall(SYS_futex, &word_, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
}

bool SwitchWatch::can_tell() noexcept {
  static const bool can = sees_a_sleep();
  return can;
}

void SwitchWatch::begin() noexcept { sequence_word() = address(&sequence); }

bool SwitchWatch::end() noexcept {
  const bool kept = sequence_word() == address(&sequence);
  sequence_word() = 0;
  return kept;
}

}  // namespace chimera
