// SPDX-License-Identifier: Apache-2.0
// The key `sequence` of a description: steps through its configurations. docs/formats/sequence.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/description/condition_text.h"
#include "chimera/description/node.h"
#include "chimera/description/report.h"
#include "chimera/text/json.h"

namespace chimera {

struct Draft;

/// The name of the task that runs a sequence, and of its component.
inline constexpr const char* kSequenceTask = "sequence";
inline constexpr std::size_t kMaxSteps = 16;

struct DraftStep {
  Place at;
  Word name;           ///< as written, else that of the configuration
  Word configuration;  ///< of `switch`; empty if it could not be read
  std::optional<DraftCondition> until;
  std::optional<Word> otherwise;  ///< of `else`: a step or "stop"
  Nanoseconds wait;               ///< of `for`; 0: none
  Nanoseconds within;             ///< written or default
  bool confirm = false;
  bool reentry = false;
};

struct DraftSequence {
  Place at;
  std::vector<DraftStep> steps;
  bool repeat = false;
  bool has_keys = false;  ///< the list of steps stands under the key `steps`
  Node written;           ///< this list, as far as it is one

  /// The step whose condition input number `input` of the task has. Requires: there is one.
  const DraftStep& step_of_input(std::size_t input) const noexcept;
  /// "step 2 'grip'".
  std::string say(const DraftStep& step) const;
};

/// Reads the value under the key `key`. Without faults in it, the task `sequence` joins the tasks, the configurations
/// and the operator variables of the draft. Call it behind the reading of these. Context: setup.
void read_sequence(const Word& key, const Node& node, Draft& draft, Report& report);

/// docs/formats/web.md, "The outline". Context: setup.
Json sequence_json(const std::optional<DraftSequence>& sequence);

}  // namespace chimera
