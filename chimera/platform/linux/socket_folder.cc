// SPDX-License-Identifier: Apache-2.0
// Finds the folder of the sockets and judges who may write to it.
#include "chimera/platform/socket_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "chimera/base/message.h"

namespace chimera {

SocketFolder socket_folder() noexcept {
  const char* runtime = ::secure_getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && runtime[0] == '/') return (Message() << runtime << "/chimera").view();
  const Message given = Message() << "/run/user/" << ::geteuid();
  struct stat status {};
  if (::stat(SocketFolder(given.view()).c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
      status.st_uid == ::geteuid())
    return (Message() << given.view() << "/chimera").view();
  return (Message() << "/tmp/chimera-" << ::geteuid()).view();
}

bool is_safe_folder(const char* path) noexcept {
  struct stat status {};
  return ::lstat(path, &status) == 0 && S_ISDIR(status.st_mode) &&
         (status.st_uid == ::geteuid() || status.st_uid == 0) && (status.st_mode & 022u) == 0;
}

}  // namespace chimera
