// SPDX-License-Identifier: Apache-2.0
// Forks children whose standard streams lead nowhere.
#include "chimera/platform/forked_child.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "chimera/base/message.h"

namespace chimera {
namespace {

void be_quiet() noexcept {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere < 0) return;
  for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
  ::close(nowhere);
}

}  // namespace

Result<pid_t> fork_quietly(const std::string& folder, const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child < 0) return (Message() << "no process: " << std::strerror(errno)).error(ErrorCode::kSystem);
  if (child > 0) return child;
  be_quiet();
  if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(1);
  ::_exit(work());  // nothing of the parent's is ours to end
}

}  // namespace chimera
