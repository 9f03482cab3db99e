// SPDX-License-Identifier: Apache-2.0
// The answers about state variables: values, and why they are what they are.
#pragma once

#include <span>
#include <string>

#include "chimera/manager/manager_state.h"
#include "chimera/manager/why.h"
#include "chimera/text/json.h"

namespace chimera::manager {

/// A value as docs/formats/control.md has it: number, boolean, text, array or object. Context of all: setup.
Json value_of(const ValueForm& form, std::span<const std::byte> bytes);
/// What is known about a value beside itself. Of one that was never written all there is to say.
Json reading_head_json(const ManagerState& world, VariableId variable, const VariableReading& reading, Nanoseconds at);
/// One reading; its age is told at `at`.
Json reading_json(const ManagerState& world, VariableId variable, Nanoseconds at);
/// {name: reading} of these variables.
Json readings_json(const ManagerState& world, std::span<const VariableId> variables, Nanoseconds at);
/// Requires: not idle.
Json why_json(const ManagerState& world, VariableId variable, Nanoseconds at);

}  // namespace chimera::manager
