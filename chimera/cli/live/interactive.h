// SPDX-License-Identifier: Apache-2.0
// `chimera shell`: one command after the other, typed (with history and completion) or from a script.
#pragma once

#include <cstdio>
#include <istream>
#include <string>

#include "chimera/cli/live/session.h"

namespace chimera::cli {

/// Carries out every line of `script`; `name` is its name for messages. Stops at the first refusal, naming the line,
/// unless `keeps_going`; `quit` ends it. Returns the first exit code that was not kOk. Context of all: setup; blocks.
int run_script(Session& session, std::istream& script, const std::string& name, bool keeps_going, std::FILE* out,
               std::FILE* err);

/// The shell: from the file `script`, from standard input when that is "-" or no terminal, else typed. Returns its exit
/// code.
int interactive(const Surroundings& surroundings, const std::string& script, bool keeps_going);

}  // namespace chimera::cli
