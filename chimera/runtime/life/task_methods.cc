// SPDX-License-Identifier: Apache-2.0
// Calls methods of components, and begins and ends their background.
#include "chimera/runtime/life/task_methods.h"

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/life/stale_inputs.h"
#include "chimera/runtime/making.h"
#include "chimera/runtime/task_word.h"
#include "chimera/task/background.h"
#include "chimera/task/event_source.h"

namespace chimera {

Answer TaskMethods::construct(Task& task, Nanoseconds now) {
  show_making(*words_.making, task.id.index, Making::kConstructs);
  const auto constructed = memories_[task.id.index].construct(task, now);
  show_made(*words_.making);
  if (mechanisms::kStale && constructed) StaleInputs::judge_cycles_of(task);
  if (constructed) return Answer::kOk;
  const char* const why = mechanisms::kVerified ? task.faults.last.text : constructed.error().message.c_str();
  record_fault(task, Method::kInit, why, now);
  return Answer::kFault;
}

Answer TaskMethods::call_at_edge(Task& task, Method method, Nanoseconds now) {
  words_.at_edge->store(TaskWord(task.id, method).word(), std::memory_order_relaxed);
  const Answer answer = run(task, method, now, runner_.threads);
  words_.at_edge->store(0, std::memory_order_relaxed);
  return answer;
}

Answer TaskMethods::call(Task& task, Method method, Nanoseconds now) { return run(task, method, now, nullptr); }

Answer TaskMethods::run(Task& task, Method method, Nanoseconds now, JobThreads* threads) {
  if (method == Method::kKill) task.descriptor = -1;
  if (mechanisms::kBackground && method == Method::kKill && !end_background(task, now)) return Answer::kFault;
  const Answer answer = threads != nullptr ? threads->call(task, method, now) : call_method(task, method, now);
  const bool is_safe = (method == Method::kOff || method == Method::kKill) && answer == Answer::kOk;
  if (mechanisms::kPeers && is_safe && safe_frames_ != nullptr) safe_frames_->take_back(task.id);
  if (method != Method::kInit || answer != Answer::kOk) return answer;
  if (mechanisms::kBackground && !begin_background(task, now)) return Answer::kFault;
  if constexpr (!mechanisms::kServers) return answer;
  if (const chimera_event_source source = event_source_of(*task.component)) task.descriptor = source(task.instance);
  return answer;
}

bool TaskMethods::begin_background(Task& task, Nanoseconds now) {
  task.background = background_of(*task.component);
  if (task.background == nullptr || runner_.writer == nullptr) return true;
  const std::uint32_t tag = TaskWord(task.id, TaskWord::kInBackground).word();
  if (runner_.writer->add(task.instance, task.background, tag)) return true;
  task.background = nullptr;
  record_fault(task, Method::kInit, "there is no thread for its background", now);
  return false;
}

bool TaskMethods::end_background(Task& task, Nanoseconds now) {
  if (task.background == nullptr) return true;
  if (runner_.writer == nullptr) {
    run_background(task, Method::kKill, now);
    task.background = nullptr;
    return true;
  }
  task.background = nullptr;
  chimera_fault fault{};
  const BackgroundThreads::End end = runner_.writer->remove(task.instance, fault);
  if (end != BackgroundThreads::End::kDone) record_fault(task, Method::kKill, fault.text, now);
  if (end != BackgroundThreads::End::kStalled) return true;
  memories_[task.id.index].abandon(task);
  return false;
}

}  // namespace chimera
