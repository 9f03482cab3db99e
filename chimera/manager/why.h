// SPDX-License-Identifier: Apache-2.0
// Why does a variable have the value it has? Walks from it to everything it depends on and names the one to look at:
// the wrong, stale or missing ancestor from which the trouble starts.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/task/state_machine.h"

namespace chimera::manager {

/// In order of gravity; what is found first in this order is the verdict on a variable.
enum class VariableTrouble : std::uint8_t {
  kRtpuDead, kProducerMissing, kProducerError, kProducerOff, kNeverWritten, kNotFinite, kStale, kNone
};
/// "rtpu-dead" ... "ok", as in docs/formats/control.md.
const char* trouble_name(VariableTrouble trouble) noexcept;

/// What is known about a variable at one instant.
struct VariableFacts {
  std::string variable;
  std::string producer;              ///< a task, "operator", or "" when no task that could produce it was created
  std::string component, rtpu;       ///< of the producer; "" for the operator
  State state = State::kNotCreated;  ///< of the producer; ON for the operator
  bool is_rtpu_dead = false;
  std::string last_words;            ///< of the producer's fault or of its rtpu's death; may be empty
  Nanoseconds period;                ///< of the producer; 0: no rhythm, never stale
  Nanoseconds stale_after;           ///< older than this is stale; 0: three periods
  Nanoseconds published;
  Nanoseconds age;
  bool is_written = false;           ///< has been published at all, and is valid
  bool is_finite = true;
  bool waits_for_events = false;     ///< the producer stands behind a server, and none has come
  std::string timing;                ///< of the producer: "3 missed, 1 demoted"; "" when nothing failed in time
  std::string value;                 ///< for people
  std::vector<std::string> inputs;   ///< variables that the producer reads

  bool is_operators() const noexcept { return producer == "operator"; }
};
using FactsOf = std::function<VariableFacts(std::string_view variable)>;

struct WhyLink {
  std::uint32_t depth = 0;  ///< steps from the variable that was asked for
  VariableFacts facts;
  VariableTrouble trouble = VariableTrouble::kNone;
};

/// Every variable that the first one depends on, nearest first, each once; and one sentence.
struct Why {
  std::vector<WhyLink> chain;
  std::string verdict;
};

/// Context: setup; O(variables).
Why why(std::string_view variable, const FactsOf& facts_of);

}  // namespace chimera::manager
