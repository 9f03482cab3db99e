// SPDX-License-Identifier: Apache-2.0
// The posts of an rtpu as kinds and sentences of the event log.
#pragma once

#include <cstdint>
#include <string>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/outbox.h"

namespace chimera::manager {

/// Kinds of docs/formats/control.md. Context of all functions: setup.
const char* event_kind(EventKind happening) noexcept;
/// `fault`: the last words of the task, "" if there are none.
std::string event_text(const ApplicationSpec& spec, const Post& post, const std::string& fault);
/// "1 deadline missed", "3 deadlines missed (17 in all)".
std::string tally(const char* what, const char* how, std::uint64_t more, std::uint64_t all);

}  // namespace chimera::manager
