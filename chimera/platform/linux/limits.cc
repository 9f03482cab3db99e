// SPDX-License-Identifier: Apache-2.0
// Compares resource limits of this process with the least that it needs.
#include "chimera/platform/limits.h"

#include <sys/resource.h>

#include "chimera/base/message.h"

namespace chimera {
namespace {

Result<void> at_least(int resource, std::uint64_t least, const char* what, const char* way_back) noexcept {
  rlimit limit{};
  if (::getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0 || limit.rlim_cur >= least) return {};
  return (Message() << what << " is limited to " << (limit.rlim_cur >> 10) << " KiB, expected at least "
                    << (least >> 10) << " KiB: " << way_back)
      .error(ErrorCode::kRefused);
}

}  // namespace

Result<void> may_run_here() noexcept {
  return at_least(RLIMIT_STACK, kLeastStack, "the stack", "ulimit -s 8192, or LimitSTACK= of the service");
}

Result<void> may_share_memory_here() noexcept {
  return at_least(RLIMIT_FSIZE, kLeastMemoryFile, "the file size (shared memory counts as a file)",
                  "ulimit -f unlimited, or LimitFSIZE= of the service");
}

}  // namespace chimera
