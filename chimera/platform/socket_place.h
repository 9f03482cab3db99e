// SPDX-License-Identifier: Apache-2.0
// The folder of the sockets of running subsystems, and the listening socket of a subsystem, which its keeper holds:
// docs/formats/control.md, "The socket".
#pragma once

#include <string>
#include <utility>

#include "chimera/base/fixed.h"
#include "chimera/base/result.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

using SocketFolder = FixedString<200>;

/// $XDG_RUNTIME_DIR/chimera, otherwise /run/user/UID/chimera if /run/user/UID exists, otherwise /tmp/chimera-UID, with
/// the UID of this process. The folder may be missing or unsafe. Context: setup.
SocketFolder socket_folder() noexcept;

/// True if `path` is a folder (no symbolic link) of this user or of root, to which no other user may write.
/// Context: setup.
bool is_safe_folder(const char* path) noexcept;

/// The listening socket. Its end removes the socket, unless another file has taken its place. Move-only. Context:
/// setup.
class SocketPlace {
 public:
  /// Listens at FOLDER/SUBSYSTEM.sock; makes the folder (mode 0700, its parent must exist). Replaces a socket at which
  /// no process listens. `for_others`: other users may connect, and the control server checks their rights; the socket
  /// has mode 0666, the folder 0711 until the last such socket is gone.
  /// Refuses a folder that is a symbolic link, another user's, or writable for others; a subsystem of that name that
  /// runs, even if its socket was removed; a path too long for a socket.
  static Result<SocketPlace> open(const std::string& folder, const std::string& subsystem, bool for_others);

  SocketPlace() noexcept = default;
  SocketPlace(SocketPlace&& other) noexcept
      : folder_(std::exchange(other.folder_, -1)),
        listening_(std::exchange(other.listening_, -1)),
        claim_(std::move(other.claim_)),
        inode_(other.inode_),
        path_(std::move(other.path_)) {}
  SocketPlace& operator=(SocketPlace&& other) noexcept;
  ~SocketPlace();

  /// Listening; close-on-exec.
  int descriptor() const noexcept { return listening_; }
  const std::string& path() const noexcept { return path_; }

 private:
  int folder_ = -1, listening_ = -1;
  OwnedDescriptor claim_;  // of the name: claim_name(path)
  unsigned long inode_ = 0;
  std::string path_;
};

}  // namespace chimera
