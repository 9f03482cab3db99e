// SPDX-License-Identifier: Apache-2.0
// Commands that ask once and say the answer.
#pragma once

#include "chimera/shell/command.h"
#include "chimera/shell/session.h"

namespace chimera::shell {

/// How an answer is shown.
struct Look {
  std::size_t height = 24;  ///< lines of the screen, for `why`
};

/// Carries out status on off kill clear reinit spawn get set save profile why flag end events, without the options
/// that go on (--follow, --every) or write (--write). Context: setup; may block.
Said one_shot(Session& session, const Call& call, const Look& look);

}  // namespace chimera::shell
