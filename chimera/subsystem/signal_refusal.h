// SPDX-License-Identifier: Apache-2.0
// Reason why a signal was not carried out: a kind for programs, a reason and a remedy for people.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/ids.h"

namespace chimera::subsystem {

/// Names and meanings: docs/formats/control.md, error -32000.
enum class RefusalKind : std::uint8_t {
  kNone,       ///< the signal was carried out
  kState,      ///< the signal is not legal in the state of the task
  kSet,        ///< the tasks that would be ON are not a legal set
  kFault,      ///< a method failed, or a task left ON by itself
  kEnded,      ///< the process of the task ended
  kResource,   ///< another task that is created has the resource of the task
  kNotYet,     ///< `on` answered that the device is not ready yet
  kNoAnswer,   ///< the rtpu of the task does not report
  kOvertaken,  ///< another signal for the task came before the end of this one
  kOther,      ///< the rtpu gave no reason: the refusal of another task of the list has it
};
/// "state", "no-answer"; "" of kNone.
const char* refusal_kind_name(RefusalKind kind) noexcept;

/// Plain value. Context: setup.
struct SignalRefusal {
  RefusalKind kind = RefusalKind::kNone;
  std::string reason;  ///< "pi is in state ERROR, where on is not legal"; "" of kOther
  std::string remedy;  ///< "type `chimera clear pi`", for the present state; "": none is known
  std::vector<TaskId> tasks = {};  ///< of kSet: those whose `on` in one command makes a legal set; empty: none is known

  bool is_refused() const noexcept { return kind != RefusalKind::kNone; }
  /// Reason and remedy in one sentence, for a message.
  std::string text() const { return remedy.empty() ? reason : reason + "; " + remedy; }
  /// The refusal with `words` before its reason, if it has one.
  SignalRefusal behind(const std::string& words) const;
  /// Becomes `later` if there is no refusal so far, or one without a reason: the first reason counts. False if
  /// unchanged.
  bool add(SignalRefusal later);
};

}  // namespace chimera::subsystem
