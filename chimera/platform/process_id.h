// SPDX-License-Identifier: Apache-2.0
// The numbers by which the system knows processes, sessions and users.
#pragma once

#include <sys/types.h>

namespace chimera {

/// Of the calling process, of its parent, of its session. Context: any; wait-free.
pid_t own_process_id() noexcept;
pid_t parent_process_id() noexcept;
pid_t own_session() noexcept;
/// The session of process `pid`; -1 when there is no such process. Context: setup.
pid_t session_of(pid_t pid) noexcept;
/// The real user of the calling process. Context: any; wait-free.
uid_t own_user() noexcept;

}  // namespace chimera
