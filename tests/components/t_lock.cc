// SPDX-License-Identifier: Apache-2.0
// A device that takes one user: init locks the file that its resource port names, and fails where another one has it.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "chimera/task/component.h"

using namespace chimera;

struct Lock {
  Resource device{"device", doc = "the file that is locked"};
  InConst<double> value{"value", "1", initial = 1.0, doc = "the published number"};
  InConst<int> late{"late", "1", initial = 0, range(0, 1000000), doc = "number of times that `on` answers not yet"};
  InConst<int> fails_at{"fails_at", "1", initial = 0, range(0, 1000000), doc = "the cycle that fails; 0: none"};
  Out<double> y{"y", "1", initial = 0.0};

  Outcome init() {
    descriptor_ = ::open(device.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor_ < 0) return fault("the device cannot be opened");
    return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 ? ok() : fault("the device has another user");
  }
  Outcome on() { return asked_++ < *late ? not_yet() : ok(); }
  Outcome cycle(Cycle c) {
    *y = *value;
    return *fails_at > 0 && c.count() + 1 == static_cast<unsigned>(*fails_at) ? fault("no current") : ok();
  }
  void off() { asked_ = 0; }
  void kill() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }
  ~Lock() { kill(); }
  int descriptor_ = -1;
  int asked_ = 0;
};
CHIMERA_COMPONENT(Lock, "t_lock", "Has a device that takes one user.", rate = 100.0);
