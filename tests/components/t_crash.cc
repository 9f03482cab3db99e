// SPDX-License-Identifier: Apache-2.0
// Dies, hangs or overwrites memory, in the configured method, while a file exists.
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "chimera/task/component.h"

using namespace chimera;

// Opening its object never ends, when the environment says so.
[[gnu::constructor]] static void hang_when_opened() {
  while (::getenv("CHIMERA_TEST_OPENING_HANGS") != nullptr) ::pause();
}

struct Crash {
  InConst<Text<16>> where{"where", initial = "cycle", doc = "the method that does it"};
  InConst<Text<16>> how{"how", initial = "segv",
                        doc =
                            "segv abort bus fpe ill stack exit kill hang block doze linger sleep vanish nan "
                            "scribble unplug"};
  Resource armed{"armed", shared, doc = "the file whose existence lets it happen"};
  Out<double> y{"y", "1", initial = 0.0, safety};

  void init() { act("init"); }
  void reinit() { act("reinit"); }
  void on(Cycle) { act("on"); }
  void cycle(Cycle c) {
    *y = static_cast<double>(c.count());
    act("cycle");
  }
  void off() { act("off"); }
  void kill() { act("kill"); }

 private:
  bool is(const char* way) const { return *how == way; }
  void act(const char* method) {
    if (!(*where == method) || ::access(armed.c_str(), F_OK) != 0) return;
    for (const auto& [way, number] : {std::pair{"segv", SIGSEGV}, std::pair{"abort", SIGABRT}, std::pair{"bus", SIGBUS},
                                      std::pair{"fpe", SIGFPE}, std::pair{"ill", SIGILL}, std::pair{"kill", SIGKILL}})
      if (is(way)) ::raise(number), ::pause();
    if (is("stack")) *y = overflow(1);
    if (is("exit")) ::_exit(42);
    if (is("unplug")) ::close_range(3, ~0U, 0);
    if (is("nan")) *y = std::nan("");
    if (is("block")) ::usleep(2'000);
    if (is("doze") || is("sleep") || is("hang") || is("vanish")) note_begin();
    if (is("doze")) ::usleep(20'000);
    while (is("linger") && ::access(armed.c_str(), F_OK) == 0) ::usleep(1'000);
    while (is("sleep")) ::pause();
    if (is("vanish")) ::syscall(SYS_exit, 0);  // the thread and nothing else
    if (is("scribble")) scribble("memfd:chimera-"), scribble("memfd:"), ::abort();
    while (is("hang")) (void)::access(armed.c_str(), F_OK);
  }
  // Writes the time of the first act into the file that permits it.
  void note_begin() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    std::FILE* file = std::fopen(armed.c_str(), "r+");
    if (file == nullptr) return;
    if (std::fgetc(file) == EOF)
      std::fprintf(file, "%lld\n", static_cast<long long>(now.tv_sec) * 1'000'000'000 + now.tv_nsec);
    std::fclose(file);
  }
  // Recurses deeper than any locked stack.
  double overflow(int depth) {
    volatile char page[4096];
    page[0] = static_cast<char>(depth);
    return depth < 1'000'000 ? overflow(depth + 1) + page[0] : 0;
  }
  // Overwrites every mapping of that name. The caller begins with the shared memory of the subsystem, because the
  // process dies when the data of its own objects is overwritten.
  static void scribble(const char* name) {
    std::FILE* maps = std::fopen("/proc/self/maps", "r");
    char line[512];
    constexpr int kWritable = PROT_READ | PROT_WRITE;
    while (maps != nullptr && std::fgets(line, sizeof line, maps) != nullptr) {
      unsigned long begin = 0, end = 0;
      char rights[5] = {};
      const bool is_memory = std::sscanf(line, "%lx-%lx %4s", &begin, &end, rights) == 3;
      const bool is_shared = std::strstr(line, name) != nullptr;
      if (!is_memory || !is_shared) continue;
      // Overwrites read-only mappings too: first by mprotect, then through the file.
      const bool may = rights[1] == 'w' || ::mprotect(reinterpret_cast<void*>(begin), end - begin, kWritable) == 0;
      if (!may) continue;
      for (unsigned long at = begin; at < end; at += 64) *reinterpret_cast<volatile unsigned long*>(at) = 0xdeadbeef;
    }
    if (maps != nullptr) std::fclose(maps);
  }
};
CHIMERA_COMPONENT(Crash, "t_crash", "Dies, hangs or scribbles on demand.", rate = 1000.0);
