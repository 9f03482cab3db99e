// SPDX-License-Identifier: Apache-2.0
// Breaks one rule of good components, the one that its constant says: what `chimera test` must find, each by its line.
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

enum Misdeed : std::int32_t {
  kNone, kNaN, kOutOfRange, kNeverWritten, kAllocates, kFrees, kSystemCall, kForgetful, kUnforgiving, kSaysNo,
  kPoisoned, kCrash, kHang, kOpen, kLeak, kThrows, kRefuses, kCallsInOn, kNeverSafe,
  kStaysSafe
};

// Differs from one process to the next.
double present_number() {
  static const auto number = static_cast<double>(::getpid());
  return number;
}

struct Misfit {
  In<double> x{"x", "1", doc = "Any number."};
  InConst<std::int32_t> misdeed{"misdeed", "1", initial = 0, range(0, 19), doc = "What it does wrong."};
  Out<double> y{"y", "1", range(-1e6, 1e6), doc = "x, as far as the misdeed lets it be."};
  Out<double> z{"z", "1", doc = "Written but for one misdeed."};
  Out<bool> calm{"calm", safe_state, initial = false, doc = "The flag is up, as far as the misdeed lets it say so."};

  Outcome init() {
    if (*misdeed == kRefuses) return fault("refuses on purpose");
    if (*misdeed == kOpen) descriptor_ = ::open("/dev/null", O_RDONLY);
    if (*misdeed == kLeak) leaked_ = std::malloc(100);
    return ok();
  }
  void on() {
    if (*misdeed == kCallsInOn) ::syscall(SYS_getppid);
    faulty_ = false;
    sum_ = 0;
  }
  Outcome cycle(Cycle c) {
    if (*misdeed == kThrows) throw std::runtime_error("thrown on purpose");
    if (*misdeed == kUnforgiving && is_spoilt_) return fault("does not forgive");
    if (*misdeed == kCrash && c.count() == 3) std::abort();
    if (*misdeed == kHang && c.count() == 3)
      for (;;) ::usleep(1000);
    if (*misdeed == kAllocates || *misdeed == kFrees) block_ = std::make_unique<double>(*x);
    if (*misdeed == kFrees) block_.reset();
    if (*misdeed == kSystemCall) ::syscall(SYS_getppid);
    *y = output(c);
    if (*misdeed != kNeverWritten) *z = 0;
    *calm = *misdeed == kNeverSafe ? false : c.illegal() || (*misdeed == kStaysSafe && *calm);
    return ok();
  }
  bool error() {
    faulty_ = is_spoilt_ = true;
    return false;
  }
  bool clear() const { return *misdeed != kSaysNo; }
  void kill() {
    if (descriptor_ >= 0) descriptor_ = -1;  // and forgets it
  }

 private:
  double output(Cycle c) {
    const bool late = c.count() == 7;
    if (*misdeed == kNaN && late) return std::nan("");
    if (*misdeed == kOutOfRange && late) return 2e6;
    if (*misdeed == kForgetful) return present_number();
    if (*misdeed != kPoisoned) return std::isfinite(*x) ? *x : 0;
    sum_ += *x;
    return std::isnan(sum_) ? sum_ : 0;
  }

  std::unique_ptr<double> block_;
  void* leaked_ = nullptr;
  double sum_ = 0;
  int descriptor_ = -1;
  bool faulty_ = false;
  static inline bool is_spoilt_ = false;  // survives even kill
};
CHIMERA_COMPONENT(Misfit, "t_misfit", "Breaks one rule of good components.", rate = 1000.0);

}  // namespace
