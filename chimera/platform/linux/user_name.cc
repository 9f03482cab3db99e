// SPDX-License-Identifier: Apache-2.0
// Looks a user up in /etc/passwd.
#include "chimera/platform/user_name.h"

#include <pwd.h>

#include <cstdio>
#include <memory>

namespace chimera {

std::string user_name(std::uint32_t user) {
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen("/etc/passwd", "re"));
  char text[1024];
  passwd entry{};
  for (passwd* found = nullptr; file && ::fgetpwent_r(file.get(), &entry, text, sizeof text, &found) == 0;)
    if (entry.pw_uid == user) return entry.pw_name;
  return std::to_string(user);
}

}  // namespace chimera
