// SPDX-License-Identifier: Apache-2.0
// The answers about state variables: their values, and the reasons for them.
#pragma once

#include <span>
#include <string>

#include "chimera/manager/answer/why.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// A value in the form of docs/formats/control.md: number, boolean, text, array or object. Context of all functions:
/// setup.
Json value_of(const ValueForm& form, std::span<const std::byte> bytes);
/// All that is known about a value except the value itself. For a variable that was never written this is the whole
/// reading.
Json reading_head_json(const ManagerState& state, VariableId variable, const VariableReading& reading, Nanoseconds at);
/// One reading, with its age at `at`.
Json reading_json(const ManagerState& state, VariableId variable, Nanoseconds at);
/// {name: reading} of these variables.
Json readings_json(const ManagerState& state, std::span<const VariableId> variables, Nanoseconds at);
/// Requires: not idle.
Json why_json(const ManagerState& state, VariableId variable, Nanoseconds at);

}  // namespace chimera::manager
