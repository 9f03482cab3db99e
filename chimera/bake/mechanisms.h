// SPDX-License-Identifier: Apache-2.0
// The parts of the runtime that an application needs (chimera/base/mechanisms.h), and the header that says so.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/bake/target.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/executive/baked.h"

namespace chimera::bake {

struct Mechanism {
  std::string_view name;  ///< "kSwitch"
  bool is_used = false;
};

/// Every constant of chimera/base/mechanisms.h, in its order, then those of firmware/: kSerial (the serial line),
/// kShell (commands on it), kLink (Linux on it), kWatchdog, kInterrupts (interrupts release jobs). What the methods of
/// a component send is not known before they run, so kSignals is always used. Context: setup.
std::vector<Mechanism> mechanisms(const ApplicationSpec& spec, const baked::Run& run, const Target& target);
/// The text of mechanisms.h. Context: setup.
std::string mechanisms_text(const std::vector<Mechanism>& mechanisms);

}  // namespace chimera::bake
