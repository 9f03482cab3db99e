// SPDX-License-Identifier: Apache-2.0
// The SCHED_OTHER thread of a real-time unit that runs init and kill.
#pragma once

#include <atomic>
#include <thread>

#include "chimera/platform/wake.h"
#include "chimera/rtpu/task_queue.h"
#include "chimera/runtime/service.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// Started and stopped by the main thread; asked by the thread that cycles.
class ServiceThread final : public Service {
 public:
  /// `bell` rings when a task was served. Context: setup.
  ServiceThread(std::size_t n_tasks, Doorbell bell) : asked_(n_tasks), served_(n_tasks), cycling_(bell) {}
  ServiceThread(const ServiceThread&) = delete;
  ServiceThread& operator=(const ServiceThread&) = delete;
  ~ServiceThread() { stop(); }

  void start(TaskSet& tasks);
  /// Ends the thread after what it is doing. May block as long as that takes.
  void stop();

  void ask(TaskId task) noexcept override;
  bool take_served(TaskId& task) noexcept override { return served_.pop(task); }

 private:
  void run(TaskSet& tasks);

  TaskQueue asked_, served_;
  Doorbell cycling_;
  std::atomic<std::uint32_t> word_{0};  // a bell: the ring pairs with Doorbell::read()
  std::atomic<bool> stopping_{false};   // by stop(), which rings afterwards: seen by the thread after the bell
  std::thread thread_;
};

}  // namespace chimera
