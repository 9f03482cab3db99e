// SPDX-License-Identifier: Apache-2.0
// For tests: a process that has no room for more descriptors.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <vector>

namespace chimera {

/// While it lives, this process can open `room` more descriptors and no more.
class FewDescriptors {
 public:
  explicit FewDescriptors(int room) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    int highest = 63;  // poll() fails where its list is longer than the limit
    for (int fd = highest; fd < 4096; ++fd)
      if (::fcntl(fd, F_GETFD) >= 0) highest = fd;
    for (int fd = 0; (fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) <= highest;) fillers_.push_back(fd);
    ::close(highest + 1);  // the one that found no hole
    const rlimit few{static_cast<rlim_t>(highest) + 1 + static_cast<rlim_t>(room), before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;
  ~FewDescriptors() {
    ::setrlimit(RLIMIT_NOFILE, &before_);
    for (const int fd : fillers_) ::close(fd);
  }

 private:
  rlimit before_{};
  std::vector<int> fillers_;
};

}  // namespace chimera
