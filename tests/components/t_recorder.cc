// SPDX-License-Identifier: Apache-2.0
// Writes down when each of its methods but cycle was called, one line each, for tests of orders.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "chimera/task/component.h"

using namespace chimera;

struct Recorder {
  InConst<Text<32>> label{"label", initial = "", doc = "the word at the start of its lines"};
  InConst<std::int64_t> slow{"slow", "ns", initial = 0, doc = "time that off takes"};
  In<double> x{"x", "1"};
  Out<double> y{"y", "1", initial = 0.0};

  void init() { note("init"); }
  void reinit() { note("reinit"); }
  void on(Cycle) { note("on"); }
  void cycle(Cycle) { *y = *x + 1; }
  void off(Cycle c) {
    note("off");
    if (*slow > 0) c.spend({*slow});
  }
  void kill() { note("kill"); }

 private:
  // One write of less than a page to a file opened for appending is never mixed with another.
  void note(const char* method) const {
    const char* file = std::getenv("CHIMERA_TEST_RECORD");
    if (file == nullptr) return;
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    char line[128];
    const int n = std::snprintf(line, sizeof line, "%s %s %lld\n", label->c_str(), method,
                                static_cast<long long>(now.tv_sec) * 1'000'000'000 + now.tv_nsec);
    const int fd = ::open(file, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0) return;
    if (::write(fd, line, static_cast<std::size_t>(n)) != n) ::perror("t_recorder");
    ::close(fd);
  }
};
CHIMERA_COMPONENT(Recorder, "t_recorder", "Writes down when its methods were called.", rate = 1000.0);
