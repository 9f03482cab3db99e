// SPDX-License-Identifier: Apache-2.0
// Lowers the priority of a process, bounds its memory, and lets the kernel end it first when memory runs out.
#include "chimera/platform/background.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace chimera {
namespace {

constexpr int kNice = 10;
constexpr char kFirstToEnd[] = "1000";  // of oom_score_adj

}  // namespace

void run_in_background(std::uint64_t memory) noexcept {
  (void)::setpriority(PRIO_PROCESS, 0, kNice);
  const rlimit no_core{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &no_core);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit bound{memory, memory};
  (void)::setrlimit(RLIMIT_AS, &bound);
#else
  (void)memory;
#endif
  const int score = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score < 0) return;
  (void)!::write(score, kFirstToEnd, sizeof kFirstToEnd - 1);
  ::close(score);
}

}  // namespace chimera
