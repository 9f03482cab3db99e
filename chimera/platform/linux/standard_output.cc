// SPDX-License-Identifier: Apache-2.0
// Occupies closed standard descriptors, and remembers the first error of writing to a standard stream.
#include "chimera/platform/standard_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

namespace chimera {
namespace {

constexpr std::array kReasons = {ENOSPC, EPIPE, EBADF, EFBIG, EDQUOT, EIO, EINVAL, EAGAIN};
constexpr int kNotKnown = 1000;  // a part was lost before anybody looked

struct Loss {
  int out = 0, err = 0;
  bool is_told = false;
} loss;

int* remembered(const std::FILE* stream) noexcept {
  return stream == stdout ? &loss.out : stream == stderr ? &loss.err : nullptr;
}

}  // namespace

void hold_standard_streams() noexcept {
  // The other direction, so that it fails as on what is closed. 0 first: a new descriptor is the lowest that is free.
  for (const int number : {0, 1, 2})
    if (::fcntl(number, F_GETFD) < 0) (void)::open("/dev/null", number == 0 ? O_WRONLY : O_RDONLY);
  std::signal(SIGXFSZ, SIG_IGN);
}

const char* why_lost_text(int why) noexcept {
  if (why == kNobodyReads) return "nobody reads it";
  const char* text = ::strerrordesc_np(why);
  return text == nullptr ? "the reason is not known" : text;
}

int flush_and_look(std::FILE* stream) noexcept {
  const int before = errno;  // of what was printed just now and found no room in the buffer
  int* known = remembered(stream);
  errno = 0;
  const bool flushed = std::fflush(stream) == 0;
  int why = flushed ? 0 : errno;
  if (flushed && std::ferror(stream) != 0) {
    const bool is_reason = std::find(kReasons.begin(), kReasons.end(), before) != kReasons.end();
    why = is_reason ? before : kNotKnown;
  }
  if (known == nullptr) return why;
  if (*known == 0) *known = why;
  return *known;
}

void loss_is_told() noexcept { loss.is_told = true; }

int report_lost_output(int code) noexcept {
  if (const int why = flush_and_look(stdout); why != 0) {
    if (!loss.is_told) std::fprintf(stderr, "chimera: standard output is lost (%s)\n", why_lost_text(why));
    code = std::max(code, 1);
  }
  return flush_and_look(stderr) == 0 ? code : std::max(code, 1);
}

}  // namespace chimera
