// SPDX-License-Identifier: Apache-2.0
// Asks Linux for the numbers of this process and of others.
#include "chimera/platform/process_id.h"

#include <unistd.h>

namespace chimera {

pid_t own_process_id() noexcept { return ::getpid(); }
pid_t parent_process_id() noexcept { return ::getppid(); }
pid_t own_session() noexcept { return ::getsid(0); }
pid_t session_of(pid_t pid) noexcept { return ::getsid(pid); }
uid_t own_user() noexcept { return ::getuid(); }

}  // namespace chimera
