// SPDX-License-Identifier: Apache-2.0
// Lists the descriptors and threads of this process from /proc.
#include "chimera/platform/open_resources.h"

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace chimera {

Descriptors open_descriptors() {
  Descriptors found;
  DIR* folder = ::opendir("/proc/self/fd");
  if (folder == nullptr) return found;
  const std::string own = std::to_string(::dirfd(folder));
  while (const dirent* entry = ::readdir(folder)) {
    if (entry->d_name[0] == '.' || own == entry->d_name) continue;
    char target[150];
    const ssize_t got = ::readlinkat(::dirfd(folder), entry->d_name, target, sizeof target);
    found.names.push_back(std::string(entry->d_name) + " -> " +
                          std::string(target, static_cast<std::size_t>(std::max<ssize_t>(got, 0))));
  }
  ::closedir(folder);
  return found;
}

std::uint32_t threads() {
  DIR* folder = ::opendir("/proc/self/task");
  if (folder == nullptr) return 0;
  std::uint32_t count = 0;
  while (const dirent* entry = ::readdir(folder)) count += entry->d_name[0] != '.' ? 1u : 0u;
  ::closedir(folder);
  return count;
}

void name_first_new(const Descriptors& before, const Descriptors& after, std::span<char> text) {
  for (const std::string& name : after.names) {
    if (std::ranges::find(before.names, name) != before.names.end()) continue;
    std::snprintf(text.data(), text.size(), "%s", name.c_str());
    return;
  }
}

}  // namespace chimera
