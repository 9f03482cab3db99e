// SPDX-License-Identifier: Apache-2.0
// Sockets within this machine: a Channel for short messages and descriptors between related processes, and stream
// connections to a path. No function waits but connect_to_path().
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

/// Channel::receive(): the message came with a descriptor, for which this process had no room (ulimit -n).
inline constexpr int kLostDescriptor = -2;

/// One end of a SOCK_SEQPACKET pair. Move-only; closes. Never blocks.
class Channel {
 public:
  enum class Got : std::uint8_t { kMessage, kNothing, kClosed };

  /// Two ends, both close-on-exec. Context: setup.
  static Result<std::pair<Channel, Channel>> pair() noexcept;
  Channel() noexcept = default;
  /// Owns `descriptor`, which this process inherited. Context: setup.
  explicit Channel(int descriptor) noexcept : descriptor_(descriptor) {}

  int descriptor() const noexcept { return descriptor_.fd; }
  bool is_open() const noexcept { return descriptor_.fd >= 0; }
  /// Sends `bytes` whole, with one descriptor (-1: none). False if the other end is gone or its buffer is full.
  [[nodiscard]] bool send(std::span<const std::byte> bytes, int passed = -1) const noexcept;
  /// Receives the next message, which must have bytes.size() bytes; a message of another length is from a stranger:
  /// kClosed. `passed` becomes the descriptor that came with the message (-1: none; or kLostDescriptor), close-on-exec;
  /// the caller closes `passed`.
  Got receive(std::span<std::byte> bytes, int& passed) const noexcept;

 private:
  OwnedDescriptor descriptor_;
};

/// A connection to the socket at `path`, within `limit`; -1 with errno: ENAMETOOLONG for a path too long for a socket,
/// EAGAIN if the listener does not accept in time. Waits its turn in the queue of the socket. Context: setup; blocks.
OwnedDescriptor connect_to_path(const std::string& path, Nanoseconds limit);
/// True if a process listens at the socket at `path`. Context: setup; never blocks.
bool is_listened_at(const std::string& path);
/// True if the two paths lead to one file, which may be a socket. Context: setup.
bool are_one_file(const std::string& a, const std::string& b);

/// The next connection that waits at `listening`, non-blocking; -1 with errno. Context: setup; never blocks.
OwnedDescriptor accept_now(int listening) noexcept;
/// Number of bytes received; 0 if the other end has closed, -1 with errno (EAGAIN: nothing yet). Context: setup; never
/// blocks.
std::int64_t receive_now(int socket, std::span<char> to) noexcept;
/// Number of `bytes` sent; -1 with errno (EAGAIN: no room now). Context: setup; never blocks.
std::int64_t send_now(int socket, std::string_view bytes) noexcept;
/// Number of sent bytes that the other end has not read; -1 if the system does not say. Context: setup.
int unread_by_other_end(int socket) noexcept;

/// Claims a name of at most 107 bytes on this machine (in one network namespace) until the descriptor is closed: an
/// abstract Unix socket, which no file stands for. -1 with errno, EADDRINUSE if another process holds the name.
/// Context: setup; never blocks.
OwnedDescriptor claim_name(std::string_view name) noexcept;
struct NameHolder {
  pid_t process = 0;  ///< 0: it does not answer
  uid_t user = 0;
};
/// The process that holds the name. Context: setup; never blocks.
NameHolder holder_of_name(std::string_view name) noexcept;

/// The process that made a connection.
struct SocketPeer {
  pid_t process = 0;
  uid_t user = 0;
  std::vector<gid_t> groups;  ///< the group of the process is the last
};
/// None if the system does not say. Context: setup.
std::optional<SocketPeer> peer_of(int socket);

}  // namespace chimera
