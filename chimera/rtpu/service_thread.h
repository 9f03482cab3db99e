// SPDX-License-Identifier: Apache-2.0
// The SCHED_OTHER thread of an rtpu that runs init and kill.
#pragma once

#include <atomic>
#include <thread>

#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/rtpu/task_queue.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/service.h"

namespace chimera {

/// The main thread starts and stops it; the cycling thread requests methods.
class ServiceThread final : public Service {
 public:
  /// `bell` rings when a method has ended. Context: setup.
  ServiceThread(std::size_t n_tasks, Doorbell bell) : asked_(n_tasks), served_(n_tasks), cycling_(bell) {}
  ServiceThread(const ServiceThread&) = delete;
  ServiceThread& operator=(const ServiceThread&) = delete;
  ~ServiceThread() { stop(); }

  void start(TaskSet& tasks);
  /// Ends the thread after the present method. May block until that method returns.
  void stop();

  /// True if a component ended the thread. The main thread; one system call.
  bool is_gone() const noexcept {
    const pid_t number = number_;
    return number != 0 && used_by(number) == kNever;
  }

  void ask(TaskId task) noexcept override;
  bool take_served(TaskId& task) noexcept override { return served_.pop(task); }

 private:
  void run(TaskSet& tasks);

  TaskQueue asked_, served_;
  Doorbell cycling_;
  std::atomic<std::uint32_t> word_{0};  // a bell: the ring pairs with Doorbell::read()
  std::atomic<bool> stopping_{false};   // stop() stores it and rings the bell: the thread sees it after the bell
  std::atomic<pid_t> number_{0};        // of the thread; 0: it has not begun
  std::thread thread_;
};

}  // namespace chimera
