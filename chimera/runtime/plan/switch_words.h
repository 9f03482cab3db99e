// SPDX-License-Identifier: Apache-2.0
// The words of docs/formats/receipt.md for the end of a switch, and for the reason why it was not made.
#pragma once

#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/plan/switch_receipt.h"

namespace chimera {

/// "done" for kDone. Context: any; wait-free.
constexpr const char* end_word(SwitchEnd end) noexcept {
  switch (end) {
    case SwitchEnd::kDone: return "done";
    case SwitchEnd::kAborted: return "aborted";
    case SwitchEnd::kRefused: return "refused";
    case SwitchEnd::kNothingToDo: return "nothing-to-do";
  }
  return "?";
}

/// "in-error" for kInError. Context: any; wait-free.
constexpr const char* reason_word(NoSwitch why) noexcept {
  switch (why) {
    case NoSwitch::kNone: return "none";
    case NoSwitch::kUnknownSet: return "unknown-configuration";
    case NoSwitch::kNothingToDo: return "nothing-to-do";
    case NoSwitch::kInError: return "in-error";
    case NoSwitch::kNotCreated: return "not-created";
    case NoSwitch::kKeptOff: return "turned-off";
    case NoSwitch::kUnderWay: return "under-way";
    case NoSwitch::kNotSchedulable: return "not-schedulable";
    case NoSwitch::kOnFailed: return "on-failed";
    case NoSwitch::kStepTooLarge: return "step-too-large";
    case NoSwitch::kNoGap: return "no-gap";
    case NoSwitch::kNoValue: return "no-value";
    case NoSwitch::kNotSafe: return "not-safe";
    case NoSwitch::kDisturbed: return "disturbed";
    case NoSwitch::kFlagRaised: return "flag-raised";
    case NoSwitch::kRunEnded: return "run-ended";
    case NoSwitch::kLate: return "late";
    case NoSwitch::kMemberDied: return "member-died";
    case NoSwitch::kDamaged: return "damaged";
    case NoSwitch::kCancelled: return "cancelled";
    case NoSwitch::kBadConstant: return "bad-constant";
    case NoSwitch::kStepFailed: return "step-failed";
    case NoSwitch::kNotReady: return "not-ready";
    case NoSwitch::kNoAnswer: return "no-answer";
  }
  return "?";
}

}  // namespace chimera
