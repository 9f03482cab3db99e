// SPDX-License-Identifier: Apache-2.0
// The toys of tests/conformance/toy.h as constant tables, and random sets of them in one image.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/executive/baked.h"

namespace chimera::baked_toys {

/// A signal to a task; an empty name: none is sent.
struct Sent {
  Signal signal = Signal::kOn;
  const char* target = "";
};

/// Script of a task.
struct Toy {
  std::int64_t spend_ns = 0;                    ///< by cycle
  std::span<const std::int32_t> sync_answers;   ///< of the next calls; CHIMERA_OK when none is left
  std::span<const std::int32_t> error_answers;
  std::span<const Sent> sends;                  ///< one a cycle
};

/// One random application.
struct Set {
  std::uint32_t seed = 0;
  const ApplicationSpec* spec = nullptr;
  const std::span<const chimera_component* const>* components = nullptr;
  const baked::Run* run = nullptr;
};

extern const std::span<const Toy> kToys;  ///< the in-const `me` of a task is a number in it
extern const std::span<const Set> kSets;

}  // namespace chimera::baked_toys
