// SPDX-License-Identifier: Apache-2.0
// Where the sockets of running subsystems are: docs/formats/control.md, "The socket".
#pragma once

#include "chimera/base/fixed.h"

namespace chimera {

using SocketFolder = FixedString<200>;

/// $XDG_RUNTIME_DIR/chimera, else /run/user/UID/chimera if /run/user/UID exists, else /tmp/chimera-UID, UID being the
/// user of this process. Says nothing about whether it exists or is safe. Context: setup.
SocketFolder socket_folder() noexcept;

/// True when `path` is a folder (no symbolic link) of this user or of root, that nobody else may write to.
/// Context: setup.
bool is_safe_folder(const char* path) noexcept;

}  // namespace chimera
