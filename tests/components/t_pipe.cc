// SPDX-License-Identifier: Apache-2.0
// Its events are the bytes of a named pipe, which its resource port names.
#include <fcntl.h>
#include <unistd.h>

#include "chimera/task/component.h"

using namespace chimera;

struct Pipe {
  Resource pipe{"pipe", doc = "a named pipe"};
  Out<std::int64_t> bytes{"bytes", "1", initial = 0, doc = "bytes so far"};

  Outcome init() {
    descriptor_ = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);  // for writing too: then it has no end
    return descriptor_ >= 0 ? ok() : fault("the pipe cannot be opened");
  }
  int event_source() const { return descriptor_; }
  bool sync() {
    char byte = 0;
    return ::read(descriptor_, &byte, 1) == 1;
  }
  void cycle() { ++*bytes; }
  void kill() { ::close(descriptor_); }
  int descriptor_ = -1;
};
CHIMERA_COMPONENT(Pipe, "t_pipe", "Counts bytes of a pipe as events.", rate = 100.0);
