// SPDX-License-Identifier: Apache-2.0
// The answers about state variables: values, and why they are what they are.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "chimera/manager/manager_state.h"
#include "chimera/manager/why.h"

namespace chimera::manager {

/// A value as docs/formats/control.md has it: number, boolean, text, array or object. Context of all: setup.
nlohmann::json value_of(const ValueForm& form, std::span<const std::byte> bytes);
/// What is known about a value beside itself. Of one that was never written all there is to say.
nlohmann::json reading_head_json(const ManagerState& world, VariableId variable, const VariableReading& reading,
                                 Nanoseconds at);
/// One reading; its age is told at `at`.
nlohmann::json reading_json(const ManagerState& world, VariableId variable, Nanoseconds at);
/// {name: reading} of these variables.
nlohmann::json readings_json(const ManagerState& world, std::span<const VariableId> variables, Nanoseconds at);
/// Requires: not idle.
nlohmann::json why_json(const ManagerState& world, VariableId variable, Nanoseconds at);

}  // namespace chimera::manager
