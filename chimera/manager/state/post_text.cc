// SPDX-License-Identifier: Apache-2.0
// Writes the messages of rtpus as sentences of the event log.
#include "chimera/manager/state/post_text.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/manager/state/cause.h"
#include "chimera/runtime/hosted/refusal_text.h"
#include "chimera/runtime/refusal.h"
#include "chimera/text/time_text.h"

namespace chimera::manager {
namespace {

std::string sender(const ApplicationSpec& spec, const Post& post) {
  return post.from.index < spec.tasks.size() ? " sent by " + std::string(spec.tasks[post.from.index].name) : "";
}

std::string refusal(const ApplicationSpec& spec, const Post& post, const std::string& fault) {
  switch (static_cast<Refusal>(post.why)) {
    case Refusal::kState: return std::string("not legal in state ") + state_name(post.before);
    case Refusal::kIllegalSet:
      return "an input would have no running producer, or two";
    case Refusal::kFault: return fault;
    case Refusal::kNotYet: return "it is not ready yet";
    case Refusal::kRival: return "another task that is created has its resource";
    case Refusal::kKeptOff: return "an operator turned it OFF";
    case Refusal::kSwitch: return under_way_text(spec, static_cast<std::uint32_t>(post.detail));
    case Refusal::kNone: break;
  }
  return "another task of the list was refused";
}

std::string flag_text(const ApplicationSpec& spec, const Post& post) {
  const std::uint64_t word = post.detail;
  if (word == 0) return "the illegal-configuration flag is down";
  std::string text = "the illegal-configuration flag is up";
  if ((word & 1u) != 0) text += ": inputs without one running producer";
  if ((word & 2u) == 0) return text;
  if (post.from.index >= spec.tasks.size()) return text + ": raised by a task";
  text += ": raised by task '";
  return text + std::string(spec.tasks[post.from.index].name) + "'";
}

std::string duration_of(const Post& post) {
  return chimera::time_text(Nanoseconds{static_cast<std::int64_t>(post.detail)});
}

std::string missed_text(const ApplicationSpec& spec, const Post& post) {
  std::string text = "missed its deadline";
  if (post.from.index >= spec.tasks.size())
    return text + ": no task of its rtpu ran for " + duration_of(post) +
           ": the CPU was taken by the kernel, RT throttling or another process";
  const TaskSpec& culprit = spec.tasks[post.from.index];
  text += post.from == post.task ? ": it used " : ": " + std::string(culprit.name) + " used ";
  text += duration_of(post);
  if (culprit.budget == Nanoseconds{}) return text + " (no budget stated)";
  return text + " (budget " + chimera::time_text(culprit.budget) + ")";
}

}  // namespace

const char* event_kind(EventKind happening) noexcept {
  switch (happening) {
    case EventKind::kState:
      return "state";
    case EventKind::kFault:
      return "fault";
    case EventKind::kRefused:
      return "refused";
    case EventKind::kSignalled:
      return "signal";
    case EventKind::kFlag:
      return "flag";
    case EventKind::kMissed:
    case EventKind::kBlocked:
      return "blame";
    case EventKind::kHang:
      return "hang";
    case EventKind::kGaveWay:
      return "demoted";
    case EventKind::kNote:
      return "note";
    case EventKind::kTakeover:
      return "takeover";
    case EventKind::kStop:
      break;
  }
  return "stop";
}

std::string event_text(const ApplicationSpec& spec, const Post& post, const std::string& fault) {
  switch (post.happening) {
    case EventKind::kState:
      return std::string(state_name(post.before)) + " -> " + state_name(post.after);
    case EventKind::kFault:
    case EventKind::kNote:
      return fault;
    case EventKind::kRefused:
      return std::string(signal_name(post.signal)) + sender(spec, post) + ": " + refusal(spec, post, fault);
    case EventKind::kSignalled:
      return signal_name(post.signal) + sender(spec, post);
    case EventKind::kFlag:
      return flag_text(spec, post);
    case EventKind::kMissed:
      return missed_text(spec, post);
    case EventKind::kBlocked:
      return "missed its deadline: it waits in a system call (it used " + duration_of(post) + ")";
    case EventKind::kHang:
      if (post.detail == 0) return "its thread ended in a cycle: this rtpu ends";
      if (post.used > 0 && post.task.index < spec.tasks.size())
        return "this rtpu ends: its job " +
               overuse_text(spec.tasks[post.task.index], Nanoseconds{static_cast<std::int64_t>(post.used)});
      return "its job has not ended " + duration_of(post) + " after its release: this rtpu ends";
    case EventKind::kGaveWay:
      return "demoted below all other threads: the tasks of its rtpu used " + duration_of(post) +
             " lately, nearly all that the kernel leaves to real-time threads";
    case EventKind::kTakeover:
      if (post.from.index >= spec.tasks.size()) return "is ON in place of another task";
      return "is ON in place of " + std::string(spec.tasks[post.from.index].name) + ", " + duration_of(post) +
             " after its rtpu found that one lost";
    case EventKind::kStop:
      break;
  }
  return "stopped by its reaction: all tasks of this rtpu go OFF";
}

std::string tally(const char* what, const char* how, std::uint64_t more, std::uint64_t all) {
  const std::string first = counted(more, what) + " " + how;
  return more == all ? first : first + " (" + std::to_string(all) + " in all)";
}

}  // namespace chimera::manager
