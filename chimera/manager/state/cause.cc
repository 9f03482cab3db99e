// SPDX-License-Identifier: Apache-2.0
// Writes why a process ended: signal, exit code, and the method that ran.
#include "chimera/manager/state/cause.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/process.h"
#include "chimera/rtpu/rtpu.h"
#include "chimera/runtime/task_word.h"
#include "chimera/task/signal.h"
#include "chimera/text/time_text.h"

namespace chimera::manager {

std::string running_text(const ApplicationSpec& spec, std::uint32_t running) {
  const TaskWord word = TaskWord::found(running);
  if (word.task().index >= spec.tasks.size()) return "";
  const std::string task(spec.tasks[word.task().index].name);
  if (word.what() == TaskWord::kOpening) return "the opening of the object of " + task;
  if (word.what() == TaskWord::kInBackground) return task + ".background";
  return word.has_method() ? task + "." + method_name(word.method()) : "";
}

std::string overuse_text(const TaskSpec& task, Nanoseconds used) {
  const bool has_budget = task.budget > Nanoseconds{};
  const Nanoseconds stated = has_budget ? task.budget : task.period;
  return "used " + time_text(used) + ", " + std::to_string(used / stated) + " x its " +
         (has_budget ? "budget of " : "period of ") + time_text(stated) +
         (has_budget ? ": raise budget, or say on_overrun: abort and heed expired()"
                     : ": lower its rate, or state a budget and on_overrun: abort");
}

std::string hung_text(const ApplicationSpec& spec, const BlockHead& left) {
  const std::string method = running_text(spec, left.hung);
  if (method.empty()) return "";
  if (left.hung_used.load() > 0)
    return method + " " + overuse_text(spec.tasks[TaskWord::found(left.hung).task().index], {left.hung_used.load()});
  const auto limit = static_cast<double>(left.hung_limit.load());
  const std::string why = limit > 0 ? formatted(" did not return within %.3g s", limit * 1e-9) : " ended its thread";
  return method + why;
}

std::string cause_text(const ApplicationSpec& spec, const KeeperMessage& ended, const BlockView& left,
                       const std::string& made) {
  if (const std::string hung = left.is_there() ? hung_text(spec, left.head()) : ""; !hung.empty() && ended.code != 0)
    return "was ended: " + hung;
  std::string text = "ended with status " + std::to_string(ended.code);
  if (ended.by_signal == 0 && ended.code == kDescriptorLost) text += " (its descriptors were closed)";
  if (ended.by_signal == 0 && ended.code == kThreadLost) text += " (a component ended one of its threads)";
  if (ended.by_signal == 0 && ended.code == kBoardLost) text += " (its board is silent or was restarted)";
  if (ended.by_signal != 0) text = "ended by " + std::string(signal_text(ended.code).view());
  if (!made.empty()) {
    text += " " + made;
  } else if (left.is_there() && left.head().phase != PeerPhase::kEnded) {
    const std::string running = running_text(spec, left.head().running);
    const std::string service = running_text(spec, left.head().serving);
    if (!running.empty() || !service.empty())
      text += " in " + running + (running.empty() || service.empty() ? "" : " or ") + service;
    else if (ended.by_signal == 0 && ended.code == 0)
      text += " without being told to end";
  } else if (!left.is_there()) {
    text += " before it was ready";
  }
  return text + (ended.core_dumped != 0 ? "; core dumped" : "");
}

}  // namespace chimera::manager
