// SPDX-License-Identifier: Apache-2.0
// Runs the slow methods init and kill one after the other.
#include "chimera/rtpu/service_thread.h"

#include "chimera/platform/clock.h"
#include "chimera/platform/thread.h"
#include "chimera/runtime/executive/executive.h"

namespace chimera {

void ServiceThread::start(TaskSet& tasks) {
  thread_ = std::thread([this, &tasks] { run(tasks); });
}

void ServiceThread::stop() {
  stopping_ = true;
  Doorbell(word_).ring();
  if (thread_.joinable()) thread_.join();
}

void ServiceThread::ask(TaskId task) noexcept {
  asked_.push(task);
  Doorbell(word_).ring();
}

void ServiceThread::run(TaskSet& tasks) {
  number_ = this_thread();
  use_decimal_point();
  LinuxClock clock;
  ComputingClock job_clock(clock);
  const Doorbell bell(word_);
  while (!stopping_) {
    const std::uint32_t heard = bell.read();
    for (TaskId task; asked_.pop(task);) {
      tasks.slow().run(task, job_clock);
      served_.push(task);
      cycling_.ring();
    }
    if (!stopping_) (void)bell.wait_until(heard, kNever);
  }
}

}  // namespace chimera
