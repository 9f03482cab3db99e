// SPDX-License-Identifier: Apache-2.0
// Why a signal was not carried out: a kind for programs, a reason and a remedy for people.
#pragma once

#include <cstdint>
#include <string>

namespace chimera::subsystem {

/// Names and meanings: docs/formats/control.md, error -32000.
enum class RefusalKind : std::uint8_t {
  kNone,       ///< it was carried out
  kState,      ///< the signal is not legal in the state of the task
  kSet,        ///< the tasks that would be ON are no legal set
  kFault,      ///< a method failed, or a task left ON by itself
  kEnded,      ///< the process of the task ended
  kResource,   ///< another task that is created has the resource of the task
  kNotYet,     ///< `on` answered that the device is not ready yet
  kNoAnswer,   ///< the real-time unit of the task does not report
  kOvertaken,  ///< another signal for the task was asked for meanwhile
  kOther,      ///< the real-time unit named no reason: the refusal of another task of the list has it
};
/// "state", "no-answer"; "" of kNone.
const char* refusal_kind_name(RefusalKind kind) noexcept;

/// Plain value. Context: setup.
struct SignalRefusal {
  RefusalKind kind = RefusalKind::kNone;
  std::string reason;  ///< "pi is in state ERROR, where on is not legal"; "" of kOther
  std::string remedy;  ///< "type `chimera clear pi`": what helps as things stand; "": nothing is known

  bool is_refused() const noexcept { return kind != RefusalKind::kNone; }
  /// Reason and remedy in one sentence, for a message.
  std::string text() const { return remedy.empty() ? reason : reason + "; " + remedy; }
  /// The refusal with `words` before its reason, if it has one.
  SignalRefusal behind(const std::string& words) const;
  /// Becomes `later` if nothing was refused so far, or without a reason: the first reason counts. False: unchanged.
  bool add(SignalRefusal later);
};

}  // namespace chimera::subsystem
