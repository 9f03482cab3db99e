// SPDX-License-Identifier: Apache-2.0
// Starts detached SCHED_OTHER threads with all signals blocked.
#include "chimera/platform/ordinary_thread.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>

#include <cstring>
#include <memory>

namespace chimera {
namespace {

void* run(void* given) {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are for the threads that wait for them
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

}  // namespace

bool start_ordinary_thread(std::function<void()> work) {
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return false;
  make_ordinary(attributes);
  auto given = std::make_unique<std::function<void()>>(std::move(work));
  pthread_t thread;
  const bool made = pthread_create(&thread, &attributes, &run, given.get()) == 0;
  if (made) (void)given.release();
  pthread_attr_destroy(&attributes);
  return made;
}

}  // namespace chimera
