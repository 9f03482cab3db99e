// SPDX-License-Identifier: Apache-2.0
// Processes of a trial, and waiting for what they say.
#pragma once

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <ctime>

namespace chimera {

inline void nap(long microseconds) {
  const timespec span{0, microseconds * 1000};
  ::nanosleep(&span, nullptr);
}

inline double seconds_now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

/// A process that runs `body` and ends with the caller at the latest; negative: there is none.
template <class Body>
pid_t start_forked(Body body) {
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid != 0) return pid;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  body();
  ::_exit(0);
}

/// False: it did not come true within 60 s.
template <class Condition>
bool wait_for(Condition condition) {
  const double end = seconds_now() + 60;
  while (!condition()) {
    if (seconds_now() > end) return false;
    nap(20);
  }
  return true;
}

}  // namespace chimera
