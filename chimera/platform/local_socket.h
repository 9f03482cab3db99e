// SPDX-License-Identifier: Apache-2.0
// Stream sockets within this machine: connections to a path, and bytes that go through them without waiting.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// A connection to the socket at `path`, within `limit`; -1 with errno: ENAMETOOLONG for a path too long for a socket,
/// EAGAIN when its listener takes none in time. Waits in the queue of the socket, in turn. Context: setup; blocks.
OwnedDescriptor connect_to_path(const std::string& path, Nanoseconds limit);
/// Somebody listens at the socket at `path`. Context: setup; never blocks.
bool is_listened_at(const std::string& path);
/// The two paths lead to one file, which may be a socket. Context: setup.
bool are_one_file(const std::string& a, const std::string& b);

/// The next connection that waits at `listening`, non-blocking; -1 with errno. Context: setup; never blocks.
OwnedDescriptor accept_now(int listening) noexcept;
/// How many bytes came; 0 when the other end has closed, -1 with errno (EAGAIN: nothing yet). Context: setup; never
/// blocks.
std::int64_t receive_now(int socket, std::span<char> to) noexcept;
/// How many of `bytes` were taken; -1 with errno (EAGAIN: none can be now). Context: setup; never blocks.
std::int64_t send_now(int socket, std::string_view bytes) noexcept;
/// Bytes that were sent and that the other end has not read; -1 when that cannot be told. Context: setup.
int unread_by_other_end(int socket) noexcept;

/// Who made a connection.
struct SocketPeer {
  pid_t process = 0;
  uid_t user = 0;
  std::vector<gid_t> groups;  ///< that of the process last
};
/// None when the system does not tell. Context: setup.
std::optional<SocketPeer> peer_of(int socket);

}  // namespace chimera
