// SPDX-License-Identifier: Apache-2.0
// Finds the folder of the sockets; makes and removes the listening socket of a subsystem under the lock of the folder.
#include "chimera/platform/socket_place.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "chimera/base/message.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/local_socket.h"

namespace chimera {
namespace {

Error failed(const std::string& path, const char* call) { return system_error(Message(path), call); }

Error refusal(const std::string& text, const std::string& where) {
  return Message(text).error(ErrorCode::kRefused, where);
}

/// Opens the folder; refuses a folder that another user may write to.
Result<OwnedDescriptor> open_folder(const std::string& path) {
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) return failed(path, "mkdir");
  OwnedDescriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (folder.fd < 0 && errno != ENOTDIR && errno != ELOOP) return failed(path, "open");
  if (folder.fd < 0) return refusal("the folder of the sockets is no folder, or a symbolic link: remove it", path);
  struct stat status {};
  if (::fstat(folder.fd, &status) != 0) return failed(path, "fstat");
  if (status.st_uid != ::geteuid())
    return refusal("the folder of the sockets is another user's: set XDG_RUNTIME_DIR to a folder of yours", path);
  if ((status.st_mode & 022u) != 0)
    return refusal("others may write to the folder of the sockets: run 'chmod 0700 " + path + "'", path);
  return folder;
}

/// Lets other users pass the folder. A folder that others may list too, such as the folder of the machine's services,
/// stays as it is. Called under the lock of the folder.
Result<void> let_others_pass(int folder, const std::string& path) {
  struct stat status {};
  if (::fstat(folder, &status) != 0) return failed(path, "fstat");
  if ((status.st_mode & 011u) != 011u && ::fchmod(folder, 0711) != 0) return failed(path, "fchmod");
  return {};
}

/// True if a socket in the folder is open to other users.
bool has_open_socket(const std::string& path) {
  DIR* entries = ::opendir(path.c_str());
  if (entries == nullptr) return true;  // not known: the folder stays as it is
  bool found = false;
  while (const dirent* entry = found ? nullptr : ::readdir(entries)) {
    struct stat status {};
    const bool is_seen = ::fstatat(::dirfd(entries), entry->d_name, &status, AT_SYMLINK_NOFOLLOW) == 0;
    found = is_seen && S_ISSOCK(status.st_mode) && (status.st_mode & 022u) != 0;
  }
  ::closedir(entries);
  return found;
}

Result<sockaddr_un> address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path)
    return refusal("the path of the socket is longer than " + std::to_string(sizeof address.sun_path - 1) +
                       " bytes: set XDG_RUNTIME_DIR to a shorter one, or give the subsystem a shorter name",
                   path);
  std::memcpy(address.sun_path, path.c_str(), path.size());
  return address;
}

const sockaddr* plain(const sockaddr_un& address) noexcept { return reinterpret_cast<const sockaddr*>(&address); }

/// Removes the socket of a dead keeper; refuses if a process listens there. Called under the lock of the folder.
Result<void> clear_way(const sockaddr_un& address, const std::string& subsystem) {
  const OwnedDescriptor asking(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (asking.fd < 0) return failed(address.sun_path, "socket");
  if (::connect(asking.fd, plain(address), sizeof address) == 0 || errno == EAGAIN) {
    ucred keeper{};
    socklen_t size = sizeof keeper;
    ::getsockopt(asking.fd, SOL_SOCKET, SO_PEERCRED, &keeper, &size);
    return refusal("a subsystem '" + subsystem + "' runs already" +
                       (keeper.pid > 0 ? " (process " + std::to_string(keeper.pid) + ")" : "") +
                       ": end it, or give this one another name",
                   address.sun_path);
  }
  if (errno == ENOENT) return {};
  if (errno != ECONNREFUSED) return failed(address.sun_path, "connect");
  if (::unlink(address.sun_path) != 0) return failed(address.sun_path, "unlink");
  return {};
}

/// Claims the name of the socket, which outlives the file. A process of another user that holds the name is no
/// subsystem, because only this user may make sockets in the folder: then there is no claim.
Result<OwnedDescriptor> claim(const std::string& path, const std::string& subsystem) {
  OwnedDescriptor claimed = claim_name(path);
  if (claimed.fd >= 0) return claimed;
  if (errno != EADDRINUSE) return failed(path, "bind");
  const NameHolder holder = holder_of_name(path);
  if (holder.process == 0 || holder.user != ::geteuid()) return claimed;
  const std::string process = std::to_string(holder.process);
  return refusal("a subsystem '" + subsystem + "' runs already (process " + process +
                     "), and its socket was removed: end it by 'kill -INT " + process +
                     "', or give this one another name",
                 path);
}

}  // namespace

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

Result<SocketPlace> SocketPlace::open(const std::string& path, const std::string& subsystem, bool for_others) {
  auto folder = open_folder(path);
  if (!folder) return folder.error();
  SocketPlace place;
  place.path_ = path + "/" + subsystem + ".sock";
  const auto address = address_of(place.path_);
  if (!address) return address.error();
  if (::flock(folder->fd, LOCK_EX) != 0) return failed(path, "flock");
  if (for_others)
    if (const auto passable = let_others_pass(folder->fd, path); !passable) return passable.error();
  if (auto clear = clear_way(*address, subsystem); !clear) return clear.error();
  auto claimed = claim(place.path_, subsystem);
  if (!claimed) return claimed.error();
  OwnedDescriptor listening(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (listening.fd < 0) return failed(place.path_, "socket");
  struct stat status {};
  // Between bind and chmod other users cannot pass the folder, unless it is open to them; then the server checks roles.
  if (::bind(listening.fd, plain(*address), sizeof *address) != 0) return failed(place.path_, "bind");
  if (::chmod(address->sun_path, for_others ? 0666 : 0600) != 0) return failed(place.path_, "chmod");
  if (::stat(address->sun_path, &status) != 0) return failed(place.path_, "stat");
  if (::listen(listening.fd, 64) != 0) return failed(place.path_, "listen");
  ::flock(folder->fd, LOCK_UN);
  place.inode_ = status.st_ino;
  place.folder_ = folder->release();
  place.listening_ = listening.release();
  place.claim_ = *std::move(claimed);
  return place;
}

SocketPlace& SocketPlace::operator=(SocketPlace&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(listening_, other.listening_);
  std::swap(claim_, other.claim_);
  std::swap(inode_, other.inode_);
  std::swap(path_, other.path_);
  return *this;
}

SocketPlace::~SocketPlace() {
  if (listening_ < 0) return;
  ::flock(folder_, LOCK_EX);
  struct stat status {};
  if (::lstat(path_.c_str(), &status) == 0 && status.st_ino == inode_) ::unlink(path_.c_str());
  // After the last socket that is open to other users, the folder is closed to them again.
  struct stat folder {};
  if (::fstat(folder_, &folder) == 0 && (folder.st_mode & 0777u) == 0711u &&
      !has_open_socket(path_.substr(0, path_.rfind('/'))))
    ::fchmod(folder_, 0700);
  ::close(listening_);
  ::close(folder_);
}

}  // namespace chimera
