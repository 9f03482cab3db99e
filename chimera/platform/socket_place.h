// SPDX-License-Identifier: Apache-2.0
// The one listening socket of a subsystem, held by its keeper: docs/formats/control.md, "The socket".
#pragma once

#include <string>
#include <utility>

#include "chimera/base/result.h"

namespace chimera {

/// Removes the socket at its end, if it is still the one it made. Move-only. Context: setup.
class SocketPlace {
 public:
  /// Listens at FOLDER/SUBSYSTEM.sock; makes the folder (mode 0700, its parent must exist). A socket that nobody
  /// listens at any more is taken over. `for_others`: other users may knock, their rights are judged at the door
  /// (folder 0711 until the last such socket is gone, socket 0666).
  /// Refuses a folder that is a symbolic link, another user's, or writable for others; a
  /// subsystem of that name that runs; a path too long for a socket.
  static Result<SocketPlace> open(const std::string& folder, const std::string& subsystem, bool for_others);

  SocketPlace() noexcept = default;
  SocketPlace(SocketPlace&& other) noexcept
      : folder_(std::exchange(other.folder_, -1)), listening_(std::exchange(other.listening_, -1)),
        inode_(other.inode_), path_(std::move(other.path_)) {}
  SocketPlace& operator=(SocketPlace&& other) noexcept;
  ~SocketPlace();

  /// Listening; close-on-exec.
  int descriptor() const noexcept { return listening_; }
  const std::string& path() const noexcept { return path_; }

 private:
  int folder_ = -1, listening_ = -1;
  unsigned long inode_ = 0;
  std::string path_;
};

}  // namespace chimera
