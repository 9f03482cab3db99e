// SPDX-License-Identifier: Apache-2.0
// Explains the value of a variable. It walks to all variables on which the value depends, and names the one to check:
// the wrong, stale or missing ancestor where the trouble starts.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/task/state_machine.h"

namespace chimera::manager {

/// In order of gravity: the first trouble that applies is the verdict on a variable.
enum class VariableTrouble : std::uint8_t {
  kRtpuDead, kProducerMissing, kProducerError, kProducerOff, kNeverWritten, kNotFinite, kStale, kNone
};
/// "rtpu-dead" ... "ok", as in docs/formats/control.md.
const char* trouble_name(VariableTrouble trouble) noexcept;

/// Facts about a variable at one instant.
struct VariableFacts {
  std::string variable;
  std::string producer;              ///< a task, "operator", or "" if no task that could produce it was created
  std::string component, rtpu;       ///< of the producer; "" for the operator
  TaskId task;                       ///< the producer; invalid: no task
  State state = State::kNotCreated;  ///< of the producer; ON for the operator
  bool is_rtpu_dead = false;
  std::string last_words;            ///< of the producer's fault or of its rtpu's death; may be empty
  Nanoseconds period;                ///< of the producer; 0: no rhythm, never stale
  Nanoseconds stale_after;           ///< older than this is stale; 0: three periods
  Nanoseconds published;
  Nanoseconds age;
  bool is_written = false;           ///< published at least once, and valid
  bool is_finite = true;
  bool waits_for_events = false;     ///< events release the producer, and none has come
  std::string timing;                ///< of the producer: "3 missed, 1 demoted"; "" if none was late
  std::string value;                 ///< for people
  std::vector<std::string> inputs;   ///< variables that the producer reads

  bool is_operators() const noexcept { return producer == "operator"; }
};
using FactsOf = std::function<VariableFacts(std::string_view variable)>;

struct WhyLink {
  std::uint32_t depth = 0;  ///< steps from the variable of the question
  VariableFacts facts;
  VariableTrouble trouble = VariableTrouble::kNone;
};

/// Every variable on which the first one depends, nearest first, each once; and one sentence.
struct Why {
  std::vector<WhyLink> chain;
  std::string verdict;
};

/// Context: setup; O(variables).
Why why(std::string_view variable, const FactsOf& facts_of);

}  // namespace chimera::manager
