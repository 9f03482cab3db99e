// SPDX-License-Identifier: Apache-2.0
// Lists the tasks that were not turned off when their rtpu ended.
#include "chimera/manager/state/unfinished.h"

#include "chimera/manager/state/cause.h"
#include "chimera/runtime/task_word.h"
#include "chimera/text/not_off.h"

namespace chimera::manager {
namespace {

bool is_of(std::uint32_t word, TaskId task) {
  const TaskWord found = TaskWord::found(word);
  return found.has_method() && found.task() == task && turns_off(found.method());
}

}  // namespace

std::vector<Unfinished> unfinished(const ManagerState& state, RtpuId rtpu, const BlockView& left,
                                   const std::string& cause) {
  std::vector<Unfinished> found;
  const BlockHead& head = left.head();
  if (head.phase == PeerPhase::kEnded) return found;
  const bool is_end = state.is_ending();
  const std::string name = state.name(rtpu);
  for (std::uint32_t t = 0; t < state.peers.n_tasks(); ++t) {
    const TaskId task(t);
    if (state.spec().tasks[t].rtpu != rtpu) continue;
    const bool is_culprit = is_of(head.hung, task) || is_of(head.running, task) || is_of(head.serving, task);
    const bool was_on = left.status(task).state == State::kOn;
    if (is_culprit && head.hung != 0)
      found.push_back({task, not_off_text(hung_text(state.spec(), head))});
    else if (is_culprit)
      found.push_back({task, not_off_text(name + " " + cause)});
    else if (is_end && was_on)
      found.push_back({task, not_off_text(name + " " + cause + " before this task was turned off")});
  }
  return found;
}

}  // namespace chimera::manager
