// SPDX-License-Identifier: Apache-2.0
// Messages of components with a device. Each message names the device and the remedy.
#pragma once

#include <grp.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

#include "chimera/base/time.h"

namespace chimera::library {

/// Text for error number `error` of opening `path`, with the remedy. Context: setup; may block.
inline std::string open_refusal(const std::string& path, int error) {
  const std::string what = path + ": " + std::strerror(error) + ": ";
  if (error == ENOENT || error == ENODEV || error == ENXIO)
    return what + "plug the device in, or name another under `resources`";
  if (error != EACCES && error != EPERM) return what + "check the path, and end a process that has it open";
  struct stat about {};
  const group* owner = ::stat(path.c_str(), &about) == 0 ? ::getgrgid(about.st_gid) : nullptr;
  const std::string name = owner != nullptr && about.st_gid != 0 ? owner->gr_name : "dialout or input";
  return what + "add the user to the group " + name + " and log in again";
}

/// Fault text for a lost device. init composes it, so that a cycle need not.
class LostSentence {
 public:
  /// Context: setup; wait-free.
  void set(std::string_view device, const char* what) {
    const std::size_t most = 60;  // the end of a long path identifies the device better than its start
    const std::string_view tail = device.size() > most ? device.substr(device.size() - most) : device;
    std::snprintf(text_, sizeof text_, "%s%.*s %s: bring it back, then `clear` and `on`",
                  tail.size() < device.size() ? "..." : "", static_cast<int>(tail.size()), tail.data(), what);
  }
  /// Context: any; wait-free.
  const char* text() const noexcept { return text_; }

 private:
  char text_[160] = "";
};

}  // namespace chimera::library
